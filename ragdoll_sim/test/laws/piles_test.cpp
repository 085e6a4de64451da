// Bodies that fall onto each other, from random poses: they keep what single bodies keep, and the
// pile comes to rest and sleeps.
#include "support/fall_laws.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kPileSeconds = 10;  ///< until a pile must sleep

class Piles : public testing::TestWithParam<int> {};

TEST_P(Piles, OfRandomPosesComeToRestAndSleep) {
  const int bodies = GetParam(), piles = samples(60 / bodies / bodies);
  std::mt19937 random(2007);
  FallRecord record;
  for (int pile = 0; pile < piles; ++pile)
    addFall(randomPile(bodies, random), kPileSeconds, record);
  tell(record);
  expectBodiesHold(record);
  EXPECT_LT(record.overlap_mm, kOverlap);
  EXPECT_LT(record.step_rise, kStepRise);
  EXPECT_GE(record.sleeping, 95 * piles / 100);
  EXPECT_GE(record.resting, 95 * piles / 100);
}

INSTANTIATE_TEST_SUITE_P(Bodies, Piles, testing::Values(2, 3),
                         [](const auto& info) { return std::to_string(info.param); });

}  // namespace
}  // namespace ragdoll
