// The runs that the golden list holds.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "golden_run.h"

namespace ragdoll::golden {

struct Case {
  std::string group;  ///< "shipped"
  std::string name;   ///< unique: "shipped: fall, balanced"
  std::function<Outcome()> run;
};

/// Runs for so long; `script`, if there is one, is called before each step.
using Script = std::function<void(Run&)>;
Outcome outcomeOf(const Scene& scene, double seconds, const Script& script = {});

/// Every shipped scene by every preset, rk with a tolerance, jakobsen by every integrator.
void addShipped(std::vector<Case>& cases);

/// Random scenes, random piles, and the matrix of extremes in short.
void addExtremes(std::vector<Case>& cases);

/// Pins, pokes and obstacles that move, sleep, islands, limits, bad starts.
void addScripted(std::vector<Case>& cases);

std::vector<Case> allCases();

}  // namespace ragdoll::golden
