#include "tuning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "other_start.h"
#include "quantity.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

using ::testing::HasSubstr;

/// Two rods in a row that swing from one end: what they do depends on how they begin.
Scene rodsThatSwing() {
  return parseScene(
      "ragdolls: [{name: r, model: {particles: {a: {position: [0, 0, 0], mass: 1}, "
      "b: {position: [1, 0, 0], mass: 1}, c: {position: [1, 0, 1], mass: 1}}, "
      "sticks: [[a, b], [b, c]]}}]\npins: [r/a]\n");
}

TEST(OtherStart, HasOtherVelocitiesAndNothingElse) {
  const Scene scene = rodsThatSwing();
  const Model own = buildModel(scene), other = buildModel(withOtherStart(scene, 1));
  const State a = startState(own), b = startState(other);
  EXPECT_EQ(a.x, b.x);
  EXPECT_GT((a.v - b.v).norm(), 0.05);
  EXPECT_LT((scene.ragdolls[0].velocity - withOtherStart(scene, 1).ragdolls[0].velocity).norm(), 1);
  EXPECT_EQ(b.v, startState(buildModel(withOtherStart(scene, 1))).v);
  EXPECT_NE(b.v, startState(buildModel(withOtherStart(scene, 2))).v);
}

/// What is asked for is kept by the same scene from starts that were not measured.
TEST(Tuning, KeepsItsWordFromStartsThatItHasNotSeen) {
  const Scene scene = rodsThatSwing();
  const Model model = buildModel(scene);
  SurveyOptions options;
  options.dearest = 0.002;
  options = completed(model, options);
  int kept = 0, all = 0;
  for (const double error : {3e-2, 3e-3, 3e-4, 3e-5}) {
    const Target target{error, 0};
    Progress progress;
    const Choice choice =
        tune(model, target, options, otherStarts(scene, 3, target, options, progress), progress);
    ASSERT_TRUE(choice.met) << error;
    EXPECT_LE(choice.measurement.expected, error);
    EXPECT_GT(choice.measurement.others, 0);
    EXPECT_DOUBLE_EQ(choice.measurement.expected,
                     3 * std::max(choice.measurement.error, choice.measurement.others));
    EXPECT_THAT(toText(choice, target, "rods"),
                HasSubstr("below " + lengthText(error) + " is expected from any"));
    for (unsigned seed = 101; seed <= 105; ++seed, ++all) {
      const Model other = buildModel(withOtherStart(scene, seed));
      const Reference reference = makeReference(
          other, options.horizon, options.window, [](double) {}, 1e-2 * error);
      kept += errorAgainst(other, choice.measurement.configuration.solver, reference) <= error;
    }
  }
  EXPECT_GE(kept, 0.95 * all);
}

}  // namespace
}  // namespace ragdoll::lab
