// One body's tree at one pose (tree.h): what StickSolver answers, without sticks.
#pragma once

#include <vector>

#include "core/linear/tree.h"
#include "core/linear/tree_matrix.h"
#include "core/linear/tree_motion.h"

namespace ragdoll {

/// L^-T J^T of a row, where L^T L = H: its entries at `index`, a link's own coordinates and their
/// ancestors. The product of two rows' z is what one's unit impulse moves along the other.
struct TreeRow {
  std::vector<int> index;  ///< ascending
  std::vector<double> z;
};

class TreeSolver {
 public:
  /// t: is a tree, and stays where it is.
  void resize(const Tree& t);

  /// Directions, H and its factors. x: 3 x n, columns.
  void setPose(const double* x);

  /// [1/kg] out (3 x n) = T H^-1 T^T force: how a force on `count` particles (three values each)
  /// moves all of them. particle, force: as of StickSolver::answer.
  void answer(const int* particle, const double* force, int count, double* out);

  /// z of a row with a gradient (three values) at each of `count` particles.
  void row(const int* particle, const double* gradient, int count, TreeRow& row);

  /// From free_dx (3 x n) to the dx along the lengths with T^T M (free_dx - dx) = 0: SHAKE
  /// [Ryckaert1977]. Newton with H, starting at the last call's coordinates times `guess`. Returns
  /// the iterations; -1: a link would turn by more than 90 degrees, dx is of no use.
  int freeMotion(const double* free_dx, double guess, double* dx);

  /// x1 (3 x n) at the pose plus what freeMotion found; lengths are exact.
  void positions(double* x1) const;

  /// x <- the same pose with exact lengths: each link laid anew along its direction. Leaves the
  /// pose; setPose comes next.
  void restoreLengths(double* x);

  /// Of H scaled to a unit diagonal, at the pose: largest by smallest eigenvalue.
  double condition() const;

 private:
  const Tree* tree_ = nullptr;
  tree::Work<double> work_;
  std::vector<double> memory_, x_, q_, y_, dx_, moved_, diagonal_, rows_;
  std::vector<int> depth_, identity_;
};

}  // namespace ragdoll
