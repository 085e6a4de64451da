// A skeleton that is a tree, in tangent coordinates: constants, built once at load.
//
// A body of rods and rigid groups whose links hang on each other in a tree closes no loops: its
// motions are what its links do, and no stick is left to solve for. Coordinates at a pose:
//   root particle  3 for its shift; none where a pin holds it
//   kPointer       2: a rod (or points in line) turns; sines along two directions square to it
//   kTurn          3: a rigid group hung on one particle turns; the vector axis times sine
//   kFold          1: a group that shares two particles turns about their line; the sine
// A pointer's direction is the world's, not its parent's: what turns a parent only shifts a rod.
// So link j's motion is felt by an ancestor as its momentum alone, H = T^T M T has entries between
// a coordinate and its ancestors only, and elimination from the leaves to the root fills nothing
// [Featherstone2008, sec. 6.5, 8.3]. Masses, first and second moments of everything that hangs on
// a link are constants in its frame (composite bodies, [Featherstone2008, sec. 6.2]).
//
// No Eigen: units compiled for other instruction sets include this. docs/fast.md#tree.
#pragma once

#include <string>
#include <vector>

namespace ragdoll {

struct TreePoint {
  int particle = 0;
  double at[3] = {0, 0, 0};  ///< [m] from `attach` in the link's frame; pointer: at[0] along it
};

struct TreeLink {
  enum class Kind { kPointer, kTurn, kFold };
  Kind kind = Kind::kPointer;
  int root = 0;     ///< of Tree::roots
  int attach = 0;   ///< the particle that it turns about
  int parent = -1;  ///< the link that places `attach` (kFold: whose turn it shares); -1: root
  int at = -1;      ///< the point of `parent` that `attach` is; -1: its own `attach`
  int first = 0;    ///< coordinate
  int points_begin = 0, points_end = 0;  ///< that it places
  /// Frame: first axis towards base[0]; kTurn, kFold: base[1] in the plane of the first two.
  int base[2] = {0, 0};
  double base_reach = 0;  ///< [m] from attach to base[0]
  double base_side = 0;   ///< [m] of base[1] along the second axis
  double base_along = 0;  ///< [m] of base[1] along the first axis
  // Of itself and of what hangs on it by single particles, about `attach`, in its frame.
  double mass = 0;                        ///< [kg] folds on it included
  double moment[3] = {0, 0, 0};           ///< [kg m]
  double second[6] = {0, 0, 0, 0, 0, 0};  ///< [kg m^2] xx yy zz xy xz yz

  int coordinates() const { return kind == Kind::kPointer ? 2 : kind == Kind::kTurn ? 3 : 1; }
};

struct TreeRoot {
  int particle = 0;
  bool pinned = false;
  int first = 0;    ///< coordinate of its shift along x, then y, z; none if pinned
  double mass = 0;  ///< [kg] of all that hangs on it
};

struct Tree {
  struct Mass {
    int row = 0, column = 0;
    double value = 0;  ///< [kg]
  };

  std::string why_not;          ///< what makes it no tree; empty: it is one
  int particles = 0, size = 0;  ///< size: coordinates
  std::vector<TreeRoot> roots;
  std::vector<TreeLink> links;    ///< parents first
  std::vector<TreePoint> points;  ///< of the links
  std::vector<int> owner;         ///< per particle: the link that places it, -1: a root
  std::vector<int> owner_point;   ///< per particle: which point of it, -1: a root
  std::vector<int> root_of;       ///< per particle: of `roots`
  /// Ancestors of coordinate k, ascending, are chain[chain_begin[k]] ... chain[chain_begin[k + 1]
  /// - 1]. An ancestor has a smaller number, and what is eliminated first the largest.
  std::vector<int> chain, chain_begin;
  std::vector<Mass> masses;     ///< the mass matrix without its zeros, rows ascending
  std::vector<int> mass_begin;  ///< per particle and one more: its row of `masses`
  std::vector<double> mass;     ///< [kg] per particle: row sums, what gravity pulls at

  bool isTree() const { return why_not.empty(); }
};

}  // namespace ragdoll
