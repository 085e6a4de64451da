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

struct FastLimit {
  bool turn = false;  ///< Limit::Kind::kTurn
  CarriedDirection reference, child, normal;
  double sin_angle = 0, cos_angle = 1;
  double scale = 1;                    ///< [rad] per unit of its cosine, at the border
  double compliance = 0, damping = 0;  ///< [rad/(N m)], [N m s/rad]
  int joint = 0;
  std::vector<int> index;  ///< coordinates of its row, ascending, with all their ancestors
};

/// A particle, or a stick between two particles of one link (attach among them).
struct Feature {
  int a = 0, b = -1;          ///< particles; b: -1 of a particle
  int link = -1;              ///< -1: the root particle itself
  int at[2] = {-1, -1};       ///< points of the link that a and b are; -1: its attach
  double radius[2] = {0, 0};  ///< [m]
  std::vector<int> index;     ///< as FastLimit::index
};

struct FastBody {
  std::string why_not;  ///< why it is not for the fast method; empty: it is
  Tree tree;
  std::vector<int> depth, identity;  ///< per coordinate: number of ancestors; itself
  std::vector<FastLimit> limits;     ///< of the skeleton, in its order
  std::vector<Feature> features;     ///< named particles, then sticks
  int particles = 0;                 ///< of the features
  int longest_row = 0;
};

}  // namespace ragdoll::fast
