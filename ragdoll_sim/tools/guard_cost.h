// What the step guard costs where it has nothing to do, and where it acts.
#pragma once

#include <string>
#include <vector>

namespace ragdoll::lab {

struct GuardCost {
  std::string scene, method;
  double plain = 0;    ///< [s] CPU per step without the guard, median
  double guarded = 0;  ///< [s] with it, median
  double ratio = 0;    ///< guarded by plain, median of the rounds
  int acted = 0;       ///< steps of one run in which the guard changed something
};

/// Shipped scenes by every method, with and without the guard in turn, `rounds` times: the same
/// steps of the same motion stand beside each other, so that what else the machine does hits both
/// alike. Then, per method, a chain that carries 100 kg (`guarded`) against the same chain without
/// (`plain`), and so by the default the matrix's chains of a mass ratio against those of 1:1.
std::vector<GuardCost> guardCosts(int rounds);

std::string toTable(const std::vector<GuardCost>& costs);
std::string toMarkdown(const std::vector<GuardCost>& costs);

}  // namespace ragdoll::lab
