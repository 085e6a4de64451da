// One configuration on one scene, measured: what it costs and how wrong it is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "families.h"
#include "ragdoll_sim/core/model.h"
#include "reference.h"

namespace ragdoll::lab {

struct Configuration {
  std::string family;  ///< "shake", or a preset's name
  bool is_preset = false;
  SolverSpec solver;
};

struct Measurement {
  Configuration configuration;
  double cost = 0;    ///< [s] of CPU time per simulated second, median
  double ratio = 0;   ///< cost by that of preset thesis measured at the same time, median
  double error = 0;   ///< [m] RMS over particles at the end of a window, mean over those that count
  double others = 0;  ///< [m] the largest such error of other starts
  double expected = 0;         ///< [m] of any start (tuning.h)
  double energy_drift = 0;     ///< [J] over a window, against the reference, mean over windows
  double energy_rise = 0;      ///< [J] largest rise above start plus work in one run
  double stretch = 0;          ///< relative, largest in one run
  double penetration = 0;      ///< [m] largest in one run
  double limit_violation = 0;  ///< [rad] largest in one run
  bool finite = true;
  bool best = false;  ///< on the Pareto front
};

/// [m] As Measurement::error; infinite where the numbers leave the finite ones.
double errorAgainst(const Model& model, const SolverSpec& solver, const Reference& reference);

/// Error and energy drift against the reference; stretch and the like of one run to `horizon`.
Measurement measureAccuracy(const Model& model, const Configuration& configuration,
                            const Reference& reference, double horizon);

/// Fills cost and ratio of all. Every repetition is measured right after one of preset thesis, so
/// that what else the machine does meets both; dear ones are repeated less often.
void measureCosts(const Model& model, double horizon, std::vector<Measurement>& all,
                  const std::function<void(double)>& report);

/// The same for one.
void measureCost(const Model& model, double horizon, Measurement& one);

/// [s] of CPU time of this process.
double cpuTime();

double median(std::vector<double> values);

/// Marks the Pareto front. Errors below the reference's uncertainty count as that.
void markBest(double uncertainty, std::vector<Measurement>& all);

}  // namespace ragdoll::lab
