#include "core/fast/lane_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/fast/lane_bodies.h"
#include "ragdoll_sim/core/limits.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;
using Vector = tree::V3<double>;

Vector random3(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

TEST(LaneLimits, ASwingTurnsOneDirectionIntoAnother) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const Vector a = tree::unit(random3(random)), u = tree::unit(random3(random)),
                 v = random3(random), w = random3(random);
    const Vector there = fast::swungBy(a, u, a) - u;
    EXPECT_NEAR(dot(there, there), 0, 1e-24);
    EXPECT_NEAR(dot(fast::swungBy(a, u, v), fast::swungBy(a, u, w)), dot(v, w), 1e-13);
    const Vector axis = cross(a, u);  // what it turns about stays
    EXPECT_NEAR(dot(fast::swungBy(a, u, axis), axis), dot(axis, axis), 1e-13);
  }
}

template <bool moved>
double valueOf(const LaneBodies& one, const OneLane& w, const fast::FastLimit& limit) {
  fast::SeenChild<double> seen;
  return fast::limitValue<moved>(one.body, w, limit, seen);
}

/// Limbs with every kind of joint, with small random coordinates.
struct Limbs : LaneBodies {
  OneLane& w;

  explicit Limbs(unsigned seed, SkeletonSpec skeleton = jointedLimbs())
      : LaneBodies(sceneOf(std::move(skeleton))), w(rows()) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-0.3, 0.3);
    for (int k = 0; k < body.tree.size; ++k) w.q[k] = unit(random);
    fast::setPose(body, w);
  }
  Points pose() const {
    return bodies[0].x + Eigen::Map<const Points>(w.dx, 3, body.tree.particles);
  }
};

/// The cosine of the angle from the reference, less that of the border, in radians at the border;
/// of the same sign as the angle for all kinds.
TEST(LaneLimits, AreTheCosinesOfTheirAngles) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Limbs one(seed);
    const std::vector<Limit>& limits = one.model.skeletons[0].limits;
    ASSERT_EQ(one.body.limits.size(), limits.size());
    const Points x = one.pose();
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const double angle = limitValue(limits[i], x.data());
      const double value = valueOf<true>(one, one.w, one.body.limits[i]);
      EXPECT_EQ(value < 0, angle < 0) << i;
      if (limits[i].kind != Limit::Kind::kWithin) continue;
      const double border = limits[i].angle, least = std::max(std::sin(border), fast::kLeastSine);
      EXPECT_NEAR(value, (std::cos(border - angle) - std::cos(border)) / least, 1e-13) << i;
    }
  }
}

/// At the start's pose, along every coordinate, by differences.
TEST(LaneLimits, HaveTheirDerivativesAsRows) {
  Limbs one(1);
  OneLane& w = one.w;
  for (const fast::FastLimit& limit : one.body.limits) {
    std::fill_n(w.q, one.body.tree.size, 0.0);
    std::fill_n(w.row, one.body.tree.size, 0.0);
    fast::setGradient(one.body, w, limit);
    for (int k = 0; k < one.body.tree.size; ++k) {
      const auto valueAt = [&](double q) {
        w.q[k] = q;
        fast::setPose(one.body, w);
        return valueOf<true>(one, w, limit);
      };
      const double e = 1e-4, slope = (valueAt(e) - valueAt(-e)) / (2 * e);
      w.q[k] = 0;
      EXPECT_NEAR(w.row[k], slope, 1e-7) << "coordinate " << k;
    }
  }
}

/// A neck, in the plane y z, that stands 10 degrees beyond its cone, or as far from its middle as
/// is said.
struct BentNeck : LaneBodies {
  BentNeck(double stiffness, double damping, double bend_deg = 40)
      : LaneBodies(sceneOf(neckOf(stiffness, damping))) {
    const Eigen::AngleAxisd bend(rad(bend_deg), Vec3::UnitX());
    Points& x = bodies[0].x;
    x.col(kHead) = x.col(kBase) + bend * (x.col(kHead) - x.col(kBase));
  }
  static SkeletonSpec neckOf(double stiffness, double damping) {
    SkeletonSpec s = limbs();
    const Vec3 bone = s.particles[kHead].position - s.particles[kBase].position;
    JointSpec neck = cone("neck", "trunk", "head", bone.normalized(), 30);
    neck.stiffness = stiffness;
    neck.damping = damping;
    s.joints = {neck};
    return s;
  }
  static constexpr int kBase = 0, kHead = 6;
};

/// From where it is near, two degrees, to where it takes part, one.
TEST(LaneLimits, WaitUntilTheyAreNear) {
  const auto rows = [](double bend_deg, int& awake) {
    BentNeck one(std::numeric_limits<double>::infinity(), 0, bend_deg);
    const OneLane& w = one.rows();
    awake = w.limit_count > 0 && w.limits[0].inverse > 0;
    return w.limit_count;
  };
  int awake = 0;
  EXPECT_EQ(rows(26, awake), 0);
  EXPECT_EQ(rows(28, awake), 1);
  EXPECT_FALSE(awake);
  EXPECT_EQ(rows(29.5, awake), 1);
  EXPECT_TRUE(awake);
}

TEST(LaneLimits, ASweepTurnsBackWhatIsAllowed) {
  BentNeck one(std::numeric_limits<double>::infinity(), 0);
  OneLane& w = one.rows();
  ASSERT_EQ(w.limit_count, 1);
  const double violated = valueOf<false>(one, w, one.body.limits[0]);
  EXPECT_NEAR(violated, (std::cos(rad(40)) - std::cos(rad(30))) / std::sin(rad(30)), 1e-13);
  fast::measureLimits(one.body, w);
  fast::sweepLimits(w);
  EXPECT_GT(w.limits[0].press, 0);
  tree::solveDown(one.body.tree, w.tree, w.y);
  std::copy_n(w.y, one.body.tree.size, w.q);
  fast::setPose(one.body, w);
  const double left = valueOf<true>(one, w, one.body.limits[0]);
  EXPECT_NEAR(left / violated, 1 - fast::kRecovery, 0.01);
}

/// docs/equations.md#soft: backward Euler's spring and damper, as LimitRow has them.
TEST(LaneLimits, OfSpringsAreSoft) {
  const double stiffness = 40, damping = 0.5;
  BentNeck one(stiffness, damping);
  OneLane& w = one.rows();
  ASSERT_EQ(w.limit_count, 1);
  LimitRow soft;
  soft.compliance = 1 / stiffness;
  soft.damping = damping;
  soft.start = valueOf<false>(one, w, one.body.limits[0]);
  const LimitRow::Softness expected = soft.eulerSoftness(one.step.h);
  EXPECT_NEAR(w.limits[0].compliance, expected.compliance / 0.5, 1e-12 * expected.compliance);
  EXPECT_NEAR(w.limits[0].allowed, -expected.offset, 1e-15);
}

}  // namespace
}  // namespace ragdoll
