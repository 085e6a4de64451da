#include <cstdio>

#include "comparisons.h"
#include "support/double_pendulum.h"
#include "timing.h"

namespace ragdoll::peers {
namespace {

using namespace test::double_pendulum;

constexpr int kRates[] = {60, 240, 1000};  ///< [Hz] of everyone
constexpr int kMoreRates[] = {30,   120,  480,
                              2000, 4000, 8000};  ///< of ours, to compare at equal cost
constexpr int kLagrangianSteps = 65536;  ///< sure to 1e-12 m (test/laws/double_pendulum_test.cpp)
constexpr int kRounds = 9;
constexpr int kWarmSteps = 5;           ///< in which memory grows; not timed
constexpr int kTip = 2;                 ///< particle
constexpr double kShortestTime = 2e-3;  ///< [s] a round lasts at least

struct Entry {
  const Engine* engine;
  bool ours, shown;
  int rate;                   ///< [Hz]
  double error = 0;           ///< [m]
  std::vector<double> times;  ///< [s] of one step, a round each
  double perStep() const { return median(times); }
  double cost() const { return rate * perStep(); }  ///< [s] per simulated second
};

std::unique_ptr<Simulation> make(const Entry& entry) {
  return entry.engine->make(pendulum(Method::kShake, 1.0 / entry.rate), 1.0 / entry.rate, true,
                            true);
}

double tipError(const Entry& entry, const Vec3& exact) {
  const auto simulation = make(entry);
  for (int i = 0; i < entry.rate; ++i) simulation->step();
  simulation->settle();
  return (simulation->particle(kTip) - exact).norm();
}

/// [s] of CPU time of one step.
double time(const Entry& entry) {
  double sum = 0;
  int steps = 0;
  while (sum < kShortestTime) {
    const auto simulation = make(entry);
    int i = 0;
    while (i < std::min(kWarmSteps, entry.rate)) simulation->step(), ++i;
    const double begin = cpuTime();
    for (; i < entry.rate; ++i) simulation->step();
    sum += cpuTime() - begin;
    steps += entry.rate - kWarmSteps;
  }
  return sum / steps;
}

/// The most accurate of ours that costs no more than `peer`; nullptr if there is none.
const Entry* bestAtCost(const std::vector<Entry>& entries, const Entry& peer) {
  const Entry* best = nullptr;
  for (const Entry& entry : entries)
    if (entry.ours && entry.cost() <= peer.cost() && (best == nullptr || entry.error < best->error))
      best = &entry;
  return best;
}

}  // namespace

void comparePendulum(const std::vector<Engine>& engines) {
  const std::size_t ours = ragdollEngines().size();
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < engines.size(); ++i) {
    for (const int rate : kRates) entries.push_back({&engines[i], i < ours, true, rate, 0, {}});
    if (i < ours)
      for (const int rate : kMoreRates) entries.push_back({&engines[i], true, false, rate, 0, {}});
  }
  const Vec3 exact = tipByLagrangian(kLagrangianSteps);
  for (Entry& entry : entries) entry.error = tipError(entry, exact);
  for (int round = 0; round < kRounds; ++round)
    for (Entry& entry : entries) entry.times.push_back(time(entry));

  std::printf(
      "### Double pendulum\n\n| engine | numbers | step | error [mm] | us / step | "
      "us / simulated s | ours at no more cost: error [mm] |\n|---|---|---|---|---|---|---|\n");
  for (const Entry& entry : entries) {
    if (!entry.shown) continue;
    std::printf("| %s | %s | 1/%d s | %s | %s | %s | ", entry.engine->name.c_str(),
                entry.engine->numbers.c_str(), entry.rate, number(1e3 * entry.error).c_str(),
                number(1e6 * entry.perStep()).c_str(), number(1e6 * entry.cost()).c_str());
    const Entry* best = entry.ours ? nullptr : bestAtCost(entries, entry);
    if (best != nullptr)
      std::printf("%s 1/%d s: %s |\n", best->engine->name.c_str(), best->rate,
                  number(1e3 * best->error).c_str());
    else
      std::printf("%s |\n", entry.ours ? "" : "none is as cheap");
  }
  std::printf("\n");
}

}  // namespace ragdoll::peers
