// One body's sticks at one pose, solved directly: J W J^T lambda = rhs with J W J^T = G o (D^T D).
//
// An impulse lambda moves the body by D diag(lambda) (B W), and its stick vectors by
// D diag(lambda) G. The inverse costs s^3 multiply-adds on padded rows; no ordering, no fill, one
// path for lumped masses, segment inertia and rigid groups (docs/equations.md#dense-rows).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/linear/stick_kernels.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// A DirectSystem laid out in padded rows. Built once per system.
struct StickRows {
  /// M: [kg] of the skeleton.
  StickRows(const DirectSystem& system, const Eigen::MatrixXd& M);

  int n, s;                         ///< particles, sticks
  int width;                        ///< padded s
  int columns;                      ///< padded n
  PaddedRows BT;                    ///< n x width
  PaddedRows G;                     ///< s x width
  PaddedRows BW;                    ///< s x columns
  PaddedRows absolute_G;            ///< s x width
  PaddedRows M;                     ///< [kg] n x columns, the mass matrix
  Eigen::VectorXd mass;             ///< [kg] n, its row sums: what gravity pulls at
  int coordinates;                  ///< padded 3 n
  PaddedRows spread_W;              ///< n x coordinates: each value of W three times
  PaddedRows WBT;                   ///< n x width
  PaddedRows spread_BW;             ///< s x coordinates: each value of BW three times
  double shortest = 0;              ///< [m] of the sticks
  double largest_row = 0;           ///< [1/kg] largest row sum of absolute_G
  Eigen::VectorXd length2;          ///< [m^2] width, zero beyond the last stick
  Eigen::VectorXd inverse_length2;  ///< [1/m^2] likewise
  double scale = 1;  ///< mean length of sticks by that of a human, at most 1: of tolerances
};

/// The sticks of one body at one pose.
class StickSolver {
 public:
  void resize(const StickRows& rows);
  /// Forgets the pose.
  void forget() { valid_ = has_across_ = false; }

  /// D = X B^T and (G o (D^T D))^-1. x: first particle's coordinates. Does nothing if it holds that
  /// very pose already.
  void setPose(const StickRows& rows, const double* x);

  /// Coordinates of the pose, 3 n.
  const double* pose() const { return pose_.data(); }
  const double* D() const { return D_.data(); }
  /// (J W J^T)^-1, s rows of width.
  const double* inverse() const { return inverse_.data(); }

  /// [1/kg] out (coordinates) = (W - W J^T (J W J^T)^-1 J W) force: how a force on `count`
  /// particles (three values each) moves all of them with the sticks answering. Returns how far it
  /// would move what it acts on without them.
  double answer(const StickRows& rows, const int* particle, const double* force, int count,
                double* out);

  /// Answers to unit forces along x, y and z, three rows of coordinates for each particle; only
  /// those asked for are there. Worked out once per pose.
  const double* mobility(const StickRows& rows, const int* particle, int count);

  /// lambda <- (J W J^T)^-1 lambda; width values.
  void solve(const StickRows& rows, double* lambda) {
    kernels::multiply(inverse_.data(), lambda, rows.s, rows.width, solved_.data());
    std::copy(solved_.data(), solved_.data() + rows.width, lambda);
  }

  /// Moves stick vectors D1 (3 rows of width) as the impulses lambda move the body.
  void moveSticks(const StickRows& rows, const double* lambda, double* D1) const {
    kernels::addImpulses(D_.data(), lambda, rows.s, rows.width, rows.G.data(), rows.width, D1);
  }

  /// Moves x (3 x n, columns) by scale D diag(lambda) (B W).
  void move(const StickRows& rows, const double* lambda, double scale, double* x);

  /// Removes from velocities v (3 x n, columns) what would stretch the sticks.
  void projectVelocities(const StickRows& rows, double* v);

 private:
  /// across_ at this pose.
  void findAcross(const StickRows& rows);

  PaddedRows D_, inverse_, moved_, rates_;
  Points pulls_;                  ///< 3 x s: on the sticks, by unit forces along x, y and z
  PaddedRows mobility_, across_;  ///< across: J W
  std::vector<std::uint8_t> has_mobility_;  ///< of the particles
  Eigen::VectorXd solved_, work_, lambda_, pose_;
  bool valid_ = false, has_across_ = false;
};

}  // namespace ragdoll
