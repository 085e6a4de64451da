#include "core/limits/limit_projection.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/start_state.h"
#include "support/limit_rows.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(LimitProjection, BringsALimbBackAndLeavesTheCentreOfMass) {
  const OneJoint neck(cone("neck", "trunk", "head", Vec3::UnitZ(), 40), "a", "head");
  State state = startState(neck.model);
  state.x = neck.posed(bent(180 - 50));
  EXPECT_NEAR(limitViolation(neck.model, state.x, 0), rad(10), 1e-12);
  const Vec3 before = centreOfMass(neck.model, state, 0);
  LimitProjection projection;
  projection.prepare(neck.model, state, state.x, 1.0 / 60);
  ASSERT_FALSE(projection.empty());
  for (int sweep = 0; sweep < 20; ++sweep) projection.sweep(neck.model, state.x);
  EXPECT_LT(limitViolation(neck.model, state.x, 0), 1e-6);
  EXPECT_LT((centreOfMass(neck.model, state, 0) - before).norm(), 1e-12);
}

TEST(LimitProjection, LeavesWhatIsAllowed) {
  const OneJoint neck(cone("neck", "trunk", "head", Vec3::UnitZ(), 40), "a", "head");
  State state = startState(neck.model);
  state.x = neck.posed(bent(180 - 35));
  const Points before = state.x;
  LimitProjection projection;
  projection.prepare(neck.model, state, state.x, 1.0 / 60);
  for (int sweep = 0; sweep < 20; ++sweep) projection.sweep(neck.model, state.x);
  EXPECT_EQ(state.x, before);
}

}  // namespace
}  // namespace ragdoll
