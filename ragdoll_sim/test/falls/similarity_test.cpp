// Bodies of other sizes obey the laws of similarity: with lengths s, masses s^3 and times sqrt(s),
// gravity and geometry are the same, so a scaled body's motion is the body's own, scaled.
#include <gtest/gtest.h>

#include <cmath>

#include "human.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/falls/fall.h"
#include "ragdoll_sim/world/batch.h"

namespace ragdoll::falls {
namespace {

/// A body pushed at the shoulder, far from any floor.
Scene thrown(const std::shared_ptr<const SkeletonSpec>& model, double scale, double step) {
  Fall fall;
  fall.kind = "push";
  fall.start = "standing";
  fall.scale = scale;
  fall.push_body = "left_shoulder";
  fall.push = scale * scale * scale * Vec3(250, 120, 0);
  fall.push_duration = 0.2 * std::sqrt(scale);
  Scene scene = fallScene(fall, model, step).scene;
  scene.solver.joint_damping /= std::sqrt(scale);
  scene.obstacles.clear();
  scene.self_collision = false;
  return scene;
}

class Similarity : public testing::TestWithParam<double> {};

TEST_P(Similarity, AScaledBodyMovesAlikeInScaledTime) {
  const double s = GetParam(), h = 1.0 / 400;
  const auto model = human();
  Batch small({thrown(model, 1, h)}), large({thrown(scaledModel(*model, s), s, h * std::sqrt(s))});
  const Vec3 start = small.positions(0).col(0), start_s = large.positions(0).col(0);
  for (int i = 0; i < 240; ++i) {
    small.advance();
    large.advance();
  }
  const Points a = small.positions(0).colwise() - start, b = large.positions(0).colwise() - start_s;
  EXPECT_GT(a.colwise().norm().maxCoeff(), 1.0);  // it has gone somewhere
  EXPECT_LT((b - s * a).cwiseAbs().maxCoeff(), 2e-3 * s);
}

TEST_P(Similarity, LengthsMassesAndInertiasScale) {
  const double s = GetParam();
  const auto model = human();
  Scene one = thrown(model, 1, 1.0 / 200), other = thrown(scaledModel(*model, s), s, 1.0 / 200);
  const Model a = buildModel(one), b = buildModel(other);
  const Skeleton &p = a.skeletons[0], &q = b.skeletons[0];
  EXPECT_NEAR(q.M.sum(), s * s * s * p.M.sum(), 1e-9 * q.M.sum());
  ASSERT_EQ(p.sticks.size(), q.sticks.size());
  for (std::size_t i = 0; i < p.sticks.size(); ++i)
    EXPECT_NEAR(q.sticks[i].length, s * p.sticks[i].length, 1e-9);
  // About the body's own centre, of all its mass: sum of M_ij x_i . x_j.
  const auto spread = [](const Skeleton& k) {
    const Eigen::VectorXd weight = k.M.rowwise().sum();
    const Vec3 centre = k.rest * weight / weight.sum();
    const Points x = k.rest.colwise() - centre;
    return (x * k.M * x.transpose()).trace();
  };
  EXPECT_NEAR(spread(q), std::pow(s, 5) * spread(p), 1e-6 * spread(q));
}

INSTANTIATE_TEST_SUITE_P(Sizes, Similarity, testing::Values(0.85, 1.13));

}  // namespace
}  // namespace ragdoll::falls
