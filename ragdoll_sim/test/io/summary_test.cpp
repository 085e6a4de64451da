// What a run did, in numbers, as JSON.
#include "ragdoll_sim/io/summary.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

TEST(Summary, SaysWhetherTheRunLeftTheFiniteNumbers) {
  Model model = buildModel(parseScene(
      "solver: {preset: thesis}\nragdolls: [{model: {particles: {p: {position: [0, 0, 0], mass: "
      "2}}}}]\n"));
  const auto summaryOf = [&] {
    WatchedRun run(model);
    for (int i = 0; i < 600; ++i) run.step();
    return run.summary();
  };
  EXPECT_TRUE(summaryOf().finite);
  model.gravity.z() = -1e308;  // a scene that says so is refused
  const Summary overflown = summaryOf();
  EXPECT_FALSE(overflown.finite);
  EXPECT_NO_THROW(nlohmann::json::parse(toJson(overflown)));
}

}  // namespace
}  // namespace ragdoll
