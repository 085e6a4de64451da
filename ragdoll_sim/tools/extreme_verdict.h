// Runs one extreme by one method and judges it by its laws.
#pragma once

#include <string>
#include <vector>

#include "extreme_tests.h"
#include "ragdoll_sim/io/summary.h"

namespace ragdoll::lab {

/// The matrix's columns.
struct ExtremeMethod {
  std::string name;
  SolverSpec solver;
  bool is_default = false;
};

/// jakobsen as preset thesis, fast as preset fast, shake as the default, rk as preset reference.
std::vector<ExtremeMethod> extremeMethods();

struct Verdict {
  bool tested = true;
  std::vector<std::string> broken;  ///< laws, each with its figure; empty: all kept
  double stick_error = 0;           ///< relative, largest from `joined` on
  double energy_rise = 0;           ///< largest (see Laws), of the energy in play
  double depth = 0;                 ///< [m] largest from `joined` on
  double speed = 0;                 ///< [m/s] largest of any particle
  double drift = 0;                 ///< [m] of the centre of mass in the second half
  double rest = -1;                 ///< [s] after which nothing moved; < 0: still moving
  double step_time = 0;             ///< [s] mean
  GuardCounts guard;

  bool kept() const { return broken.empty(); }
};

Verdict judge(const Extreme& extreme, const ExtremeMethod& method);

}  // namespace ragdoll::lab
