// A body of the fast method: a tree (tree.h), its limits and what of it touches, as plain numbers
// for units of any instruction set. Built once for each system. No Eigen.
#pragma once

#include <string>
#include <vector>

#include "core/linear/tree.h"

namespace ragdoll::fast {

/// A unit vector that links carry (limit.h): fixed in a link, then swung by bones.
struct LinkVector {
  int link = 0;
  double c[3] = {1, 0, 0};  ///< in the link's frame; pointer: c[0], 1 or -1, along it
};

struct CarriedDirection {
  struct Swing {
    LinkVector bone;             ///< where it points
    double axis[3] = {1, 0, 0};  ///< where it points when nothing is swung, in the base's frame
  };
  LinkVector base;
  int swings = 0;
  Swing swing[2];
};

/// Where a row of the Jacobian is not zero, and how it is eliminated: z[i] is what stands there
/// less L's entries times the z of coordinates below, over the pivot.
struct RowShape {
  struct Term {
    int at = 0;     ///< entry of Work::H
    int below = 0;  ///< of `index`
  };
  std::vector<int> index;  ///< coordinates, ascending, with all their ancestors
  std::vector<Term> terms;
  std::vector<int> terms_begin;  ///< per entry of `index` and one more
  /// Where one coordinate has all the others as ancestors: per entry, where its row of L begins,
  /// which has as many entries as stand before it.
  std::vector<int> chain;

  int size() const { return static_cast<int>(index.size()); }
};

struct FastLimit {
  bool turn = false;  ///< Limit::Kind::kTurn, kWedge
  CarriedDirection reference, child, normal;
  double sin_angle = 0, cos_angle = 1;
  double scale = 1;                    ///< [rad] per unit of its cosine, at the border
  double compliance = 0, damping = 0;  ///< [rad/(N m)], [N m s/rad]
  int joint = 0;
  int group = 0;  ///< limits that follow each other with the same child, base and swings
  RowShape row;
};

/// A particle, or a stick between two particles of one link (attach among them).
struct Feature {
  int a = 0, b = -1;  ///< particles; b: -1 of a particle
  int stick = -1;     ///< of the skeleton
  int link = -1;      ///< -1: the root particle itself
  static constexpr int kOnAxis = -2;
  /// Points of the link that a and b are; -1: its attach; kOnAxis: a fold's axis ends there.
  int at[2] = {-1, -1};
  double radius[2] = {0, 0};  ///< [m]
  RowShape row;
};

struct FastBody {
  std::string why_not;  ///< why it is not for the fast method; empty: it is
  Tree tree;
  std::vector<int> depth;         ///< per coordinate: number of ancestors
  std::vector<FastLimit> limits;  ///< of the skeleton, in its order
  std::vector<Feature> features;  ///< named particles, then sticks
  int particles = 0;              ///< of the features
  int longest_row = 0;
};

}  // namespace ragdoll::fast
