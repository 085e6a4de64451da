#include <cmath>
#include <cstdio>
#include <iterator>

#include "comparisons.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "timing.h"

namespace ragdoll::peers {
namespace {

constexpr int kBodies[] = {1, 10, 100, 1000};
constexpr int kRate = 60;  ///< [Hz]
constexpr double kSeconds = 1.2;
constexpr double kWarm = 0.1, kFlight = 0.4;  ///< [s] between them: in the air
constexpr double kImpact = 0.6;               ///< [s] from then on: on the floor
constexpr double kSpacing = 2.5;              ///< [m] so that nobody meets
constexpr int kFalls = 900;                   ///< of bodies; so many rounds, but
constexpr int kFewest = 3, kMost = 9;

struct Cost {
  std::vector<double> flight, contact;  ///< [s] of one step of one body, a round each
};

Scene crowd(int bodies) {
  Scene scene = parseScene(
      "ragdolls: [{name: r, model: human, position: [0, 0, 2.2], rpy_deg: [20, 25, 0]}]\n"
      "obstacles: [{type: plane, friction: 0.5}]\n",
      "peers");
  const RagdollSpec one = scene.ragdolls[0];
  const int side = static_cast<int>(std::ceil(std::sqrt(bodies)));
  scene.ragdolls.clear();
  for (int i = 0; i < bodies; ++i) {
    scene.ragdolls.push_back(one);
    scene.ragdolls.back().name += std::to_string(i);
    scene.ragdolls.back().pose.position += kSpacing * Vec3(i % side, i / side, 0);
  }
  return scene;
}

/// Ours has all in one world; the others have a world for each body, which spares them the search
/// for pairs.
void fall(const Engine& engine, bool ours, int bodies, Cost& cost) {
  std::vector<std::unique_ptr<Simulation>> worlds;
  for (int i = 0; i < (ours ? 1 : bodies); ++i)
    worlds.push_back(engine.make(crowd(ours ? bodies : 1), 1.0 / kRate, true, false));
  double flight = 0, contact = 0;
  int flying = 0, lying = 0;
  for (int i = 1; i <= static_cast<int>(kSeconds * kRate); ++i) {
    const double at = 1.0 * i / kRate, begin = cpuTime();
    for (const auto& world : worlds) world->step();
    const double spent = (cpuTime() - begin) / bodies;
    if (at > kWarm && at <= kFlight) flight += spent, ++flying;
    if (at > kImpact) contact += spent, ++lying;
  }
  cost.flight.push_back(flight / flying);
  cost.contact.push_back(contact / lying);
}

}  // namespace

void compareCrowd(const std::vector<Engine>& engines) {
  const std::size_t ours = ragdollEngines().size(), sizes = std::size(kBodies);
  std::vector<Cost> costs(engines.size() * sizes);
  for (std::size_t n = 0; n < sizes; ++n) {
    const int rounds = std::max(kFewest, std::min(kMost, kFalls / kBodies[n]));
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < engines.size(); ++i)
        fall(engines[i], i < ours, kBodies[n], costs[i * sizes + n]);
  }
  std::printf("### Crowd\n\n| engine |");
  for (const int bodies : kBodies) std::printf(" %d |", bodies);
  std::printf("\n|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < engines.size(); ++i) {
    std::printf("| %s |", engines[i].name.c_str());
    for (std::size_t n = 0; n < sizes; ++n) {
      const Cost& cost = costs[i * sizes + n];
      std::printf(" %s, %s |", number(1e6 * median(cost.flight)).c_str(),
                  number(1e6 * median(cost.contact)).c_str());
    }
    std::printf("\n");
  }
  std::printf("\n");
}

}  // namespace ragdoll::peers
