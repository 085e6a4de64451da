#include "ragdoll_sim/world/crowd.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "particles.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

using test::kStep;
using test::particles;

TEST(InParallel, DoesEachPartOnce) {
  for (const int threads : {1, 3, 0}) {
    std::atomic<int> done[10] = {};
    inParallel(threads, 10, [&](int i) { ++done[i]; });
    for (const auto& times : done) EXPECT_EQ(times, 1);
  }
}

TEST(InParallel, PassesAnErrorOnWhenAllHaveEnded) {
  std::atomic<int> done{0};
  EXPECT_THROW(inParallel(3, 10,
                          [&](int i) {
                            ++done;
                            if (i == 4) throw std::runtime_error("4");
                          }),
               std::runtime_error);
  EXPECT_GE(done, 5);
}

TEST(Crowd, SharesABatchWhereOnlyBodiesDiffer) {
  Scene here = particles(1), there = here, other = here;
  there.ragdolls[0].pose.position.y() = 3;
  other.gravity = Vec3(0, 0, -1);
  Crowd crowd({here, other, there}, 2);
  EXPECT_EQ(crowd.size(), 3);
  EXPECT_EQ(crowd.batches(), 2);
  EXPECT_EQ(&crowd.batch(0), &crowd.batch(2));
  EXPECT_NE(crowd.member(0), crowd.member(2));
}

TEST(Crowd, RefusesStepsOfSeveralLengths) {
  Scene here = particles(1), other = here;
  other.solver.step = 2 * kStep;
  EXPECT_THROW(Crowd({here, other}), Error);
}

TEST(Crowd, RefusesMoreThreadsThanThereMayBe) {
  for (const int threads : {-1, 257})
    EXPECT_THROW(Crowd({particles(1)}, threads), Error) << threads;
}

}  // namespace
}  // namespace ragdoll
