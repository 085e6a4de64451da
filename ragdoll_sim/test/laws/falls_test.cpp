// What a user sees over many falls with the default solver: joints hold, sticks hold, nothing sinks
// in, energy never rises, and bodies come to rest. And what relaxation keeps of it at the setting
// from which on it keeps the joints and comes to rest (docs/trade.md#random-falls).
#include "support/fall_laws.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr int kFalls = samples(100);  ///< of each scene
constexpr double kFallSeconds = 10;   ///< until a body must be at rest

class Falls : public testing::TestWithParam<std::string> {};

TEST_P(Falls, HoldTheBodyTogetherAndEndAtRest) {
  std::mt19937 random(2007);
  FallRecord record;
  for (int fall = 0; fall < kFalls; ++fall)
    addFall(randomFall(GetParam(), random), kFallSeconds, record);
  tell(record);
  expectBodiesHold(record);
  EXPECT_LT(record.stick_mm, 2);
  EXPECT_GT(record.resting, 95 * kFalls / 100);
}

TEST_P(Falls, WithLimbsThatTouchKeepTheSame) {
  constexpr int kSelfFalls = samples(25);
  std::mt19937 random(2007);
  FallRecord record;
  for (int fall = 0; fall < kSelfFalls; ++fall) {
    Scene scene = randomFall(GetParam(), random);
    scene.self_collision = true;
    addFall(scene, kFallSeconds, record);
  }
  tell(record);
  expectBodiesHold(record);
  EXPECT_LT(record.stick_mm, 2);
  EXPECT_LT(record.overlap_mm, kOverlap);
  EXPECT_LT(record.step_rise, kStepRise);
  EXPECT_GT(record.resting, 95 * kSelfFalls / 100);
}

TEST_P(Falls, LieStillWithoutSleep) {
  constexpr int kAwakeFalls = samples(25);
  std::mt19937 random(2007);
  int still = 0;
  double worst = 0;  // [m/s]
  for (int fall = 0; fall < kAwakeFalls; ++fall) {
    Scene scene = randomFall(GetParam(), random);
    scene.solver.sleep = false;
    World world(scene);
    const int second = static_cast<int>(std::lround(1 / world.model.solver.step));
    world.steps(2 * static_cast<int>(kFallSeconds) * second);
    double jitter = 0;
    for (int i = 0; i < second; ++i) {
      world.steps(1);
      jitter = std::max(jitter, world.state.v.colwise().norm().maxCoeff());
    }
    still += jitter < 1e-3;
    worst = std::max(worst, jitter);
  }
  RecordProperty("still", still);
  RecordProperty("worst_mm_s", std::to_string(1e3 * worst));
  EXPECT_GT(still, 95 * kAwakeFalls / 100);
}

TEST_P(Falls, OfRelaxationAt240HzAnd40SweepsKeepJointsAndEndAtRest) {
  constexpr int kRelaxedFalls = samples(25);
  std::mt19937 random(2007);
  FallRecord record;
  int deep = 0;  // falls in which something sank in by more than 10 mm
  for (int fall = 0; fall < kRelaxedFalls; ++fall) {
    Scene scene = randomFall(GetParam(), random);
    scene.solver.method = Method::kJakobsen;
    scene.solver.step = 1.0 / 240;
    scene.solver.sweeps = 40;
    const double before = record.penetration_mm;
    record.penetration_mm = 0;
    addFall(scene, kFallSeconds, record);
    deep += record.penetration_mm > 10;
    record.penetration_mm = std::max(record.penetration_mm, before);
  }
  tell(record);
  EXPECT_LT(record.limit_deg, 2);
  EXPECT_LT(record.stretch, 0.05);
  EXPECT_LT(record.penetration_mm, 15);
  EXPECT_LE(deep, kRelaxedFalls / 25);  // of 400 between objects 6
  EXPECT_LT(record.rise, 1e-2);
  EXPECT_GE(record.resting, 95 * kRelaxedFalls / 100);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Falls, testing::Values("stairs", "between_objects"));

}  // namespace
}  // namespace ragdoll
