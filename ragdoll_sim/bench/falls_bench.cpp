// What each setting keeps of a body over 100 random falls in a scene (docs/trade.md): the worst of
// all steps. Look at the counters.
#include <benchmark/benchmark.h>

#include "support/falls.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr int kFalls = 100;
constexpr double kSeconds = 10;

struct Setting {
  const char* name;
  Method method;
  double rate;  ///< [Hz]
  int sweeps;
};

constexpr Setting kSettings[] = {
    {"default", Method::kShake, 0, 0},
    {"jakobsen_60Hz_10_sweeps", Method::kJakobsen, 60, 10},
    {"jakobsen_120Hz_40_sweeps", Method::kJakobsen, 120, 40},
    {"jakobsen_240Hz_40_sweeps", Method::kJakobsen, 240, 40},
    {"jakobsen_480Hz_40_sweeps", Method::kJakobsen, 480, 40},
    {"jakobsen_480Hz_160_sweeps", Method::kJakobsen, 480, 160},
};

void fall(benchmark::State& bench, const Setting& setting, const std::string& place) {
  FallRecord record;
  for (auto _ : bench) {
    std::mt19937 random(2007);
    for (int i = 0; i < kFalls; ++i) {
      Scene scene = randomFall(place, random);
      if (setting.rate > 0) {
        scene.solver.method = setting.method;
        scene.solver.step = 1 / setting.rate;
        scene.solver.sweeps = setting.sweeps;
      }
      addFall(scene, kSeconds, record);
    }
  }
  bench.counters["limit_deg"] = record.limit_deg;
  bench.counters["stretch_percent"] = 100 * record.stretch;
  bench.counters["penetration_mm"] = record.penetration_mm;
  bench.counters["resting_percent"] = 100.0 * record.resting / record.falls;
}

const bool kRegistered = [] {
  for (const std::string place : {"stairs", "between_objects"})
    for (const Setting& setting : kSettings)
      benchmark::RegisterBenchmark(
          ("falls/" + place + "/" + setting.name).c_str(),
          [&setting, place](benchmark::State& b) { fall(b, setting, place); })
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace ragdoll
