#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/snapshot.h"
#include "ragdoll_sim/core/start_state.h"
#include "support/error_of.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// What checkFits says of a moment of one stick on a floor after one thing in it is changed.
std::string refusal(const std::function<void(Moment&)>& change) {
  Scene scene = sceneOf(oneStick());
  scene.obstacles.push_back(floorPlane());
  scene.pins.push_back(pinOf("ragdoll/a"));
  const Model model = buildModel(scene);
  Moment moment{startState(model), {}, model.pins, model.gravity, model.solver};
  change(moment);
  return errorOf([&] { checkFits(model, moment); });
}

TEST(SnapshotChecks, TakeWhatAStepMakes) {
  EXPECT_EQ(refusal([](Moment&) {}), "");
}

TEST(SnapshotChecks, NameWhatNoStepMakes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    std::function<void(Moment&)> change;
    const char* says;
  } cases[] = {
      {[](Moment& m) { m.state.x.resize(3, 5); }, "sizes"},
      {[](Moment& m) { m.state.obstacles.clear(); }, "sizes"},
      {[](Moment& m) { m.state.v(0, 0) = 1e160; }, "no run comes to"},
      {[=](Moment& m) { m.state.time = nan; }, "not finite"},
      {[](Moment& m) { m.state.obstacles[0].orientation.coeffs() *= 2; }, "obstacle"},
      {[](Moment& m) { m.state.impulses.resize(1), m.state.impulses[0].ragdoll = 7; },
       "out of range"},
      {[](Moment& m) { m.pins[0].particle = 9; }, "a pin of a particle out of range"},
      {[](Moment& m) { m.pins.push_back(m.pins[0]); }, "pinned twice"},
      {[](Moment& m) { m.pokes.resize(1); }, "a poke of a particle out of range"},
      {[=](Moment& m) { m.gravity.z() = nan; }, "gravity"},
      {[](Moment& m) { m.solver.preset = "best"; }, "solver"},
      {[](Moment& m) { m.solver.threads = -1; }, "solver"},
  };
  for (const auto& wrong : cases)
    EXPECT_NE(refusal(wrong.change).find(wrong.says), std::string::npos)
        << wrong.says << ": " << refusal(wrong.change);
}

}  // namespace
}  // namespace ragdoll
