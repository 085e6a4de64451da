// What one body's SHAKE step works with. Private to the core.
#pragma once

#include <cstdint>
#include <vector>

#include "core/direct/runge_kutta.h"
#include "core/limits/limit_angles.h"
#include "core/linear/schur.h"
#include "core/linear/stick_solver.h"
#include "core/mechanics/energy_gain.h"

namespace ragdoll {

/// Values in State::multipliers of one body.
inline int multiplierCount(const StickRows& rows) { return 2 * rows.s + 1; }

/// Sticks at the step's start and end, limits and rows; kept from step to step so that what is
/// known of the end serves at the next start.
struct ShakeBody {
  StickSolver start, end;
  LimitAngles angles;
  Schur schur;
};

/// Of an implicit step, so that not each allocates it anew (shake_implicit.cpp).
struct ImplicitScratch {
  Points free, dx, unbalanced, step;
  Eigen::MatrixXd D0, D, impulses, DB, tangent, sides, solved, pulled, system, turn;
  Eigen::VectorXd lambda, stretch, change;
};

/// Scratch shared by all bodies.
struct ShakeScratch {
  Points dx, acceleration, saved_x, saved_v, stay;
  EnergyScratch energy;
  std::vector<double> saved_multipliers;
  PaddedRows D1;
  Eigen::VectorXd lambda, residual, correction, b, p;
  Eigen::VectorXd lengths2, inverse_lengths2;       ///< of sticks that are being joined
  Eigen::VectorXd total;                            ///< impulses so far
  std::vector<Contact> contacts, touching, missed;  ///< near; touching at the step's end
  std::vector<int> passed;  ///< obstacles that moving pins drag the body through
  std::vector<LimitRow> limits, touching_limits;
  std::vector<int> contact_row, limit_row;  ///< first row of each in the Schur complement, or -1
  int own_rows = 0;                         ///< of them; contacts with other bodies come after
  enum Role : std::uint8_t { kIfNear, kForced, kArriving, kArrived };
  /// Of each: among the rows if near, in any case, not before its time is known, at that time.
  std::vector<std::uint8_t> contact_role, limit_role;
  Points free_dx;  ///< before contacts and limits
  Eigen::VectorXd free_lambda;
  std::vector<LimitRow::Softness> softness;  ///< of the limits
  std::vector<double> warm;                  ///< impulses at which the velocity stage starts
  std::vector<Press> presses, saved_presses;  ///< of the last motion
  Points v1;
  RungeKuttaScratch stages;
  ImplicitScratch implicit;
};

}  // namespace ragdoll
