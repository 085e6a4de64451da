#include "core/direct/edges.h"

#include <gtest/gtest.h>

#include "core/direct/candidates.h"
#include "core/direct/motion.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kStep = 1.0 / 120;

/// As a share of a step, of a ball of radius 0.05 that moves so, without gravity, beside a box of 1
/// x 1 x 0.5 m about the origin.
double timeOver(const Vec3& at, const Vec3& velocity) {
  Scene scene = weightless(oneParticle(1, 0.05), velocity);
  scene.ragdolls[0].pose.position = at;
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(1, 1, 0.5);
  scene.obstacles = {box};
  scene.solver.step = kStep;
  DirectIsland one(scene);
  save(one.island);
  freeMotion(one.body(), one.h);
  findCandidates(one.island, one.h);
  return timeOfEdge(one.island, one.h) / one.h;
}

TEST(Edges, AreMetWhereTheCentreLeavesTheFace) {
  const double top = 0.3;
  const double v = 3, h = kStep;
  EXPECT_NEAR(timeOver({0.5 - 0.3 * v * h, 0, top}, {v, 0, 0}), 0.3, 1e-12);
  EXPECT_NEAR(timeOver({0, -0.5 + 0.7 * v * h, top}, {0, -v, 0}), 0.7, 1e-12);
  EXPECT_NEAR(timeOver({0.5 - 0.6 * v * h, 0.5 - 0.2 * v * h, top}, {v, v, 0}), 0.2, 1e-12);
}

TEST(Edges, AreNotMetOnTheFaceNorByWhatTouchesNothing) {
  const double top = 0.3;
  EXPECT_GT(timeOver({0, 0, top}, {3, 0, 0}), 1);
  EXPECT_GT(timeOver({0.5, 0, top}, {3, 0, 0}), 1);  // it is there
  EXPECT_GT(timeOver({0.49, 0, top + 1e-3}, {3, 0, 0}), 1);
}

}  // namespace
}  // namespace ragdoll
