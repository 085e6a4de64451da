// A soft limit is a spring and a damper that only push: a lever of 1 kg m^2 on a hinge against the
// formulas of the damped oscillator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kLimitStiffness = 200;  ///< [N m/rad]
constexpr double kWeakGravity = 1;   ///< [m/s^2] weak, so that the lever stays level to 2e-2 rad
constexpr double kLeverStep = 1e-4;  ///< [s]

/// A rod of 1 m, 1 kg at its end, hinged on three pinned particles; level, the limit at its level.
SkeletonSpec lever(double stiffness, double damping) {
  SkeletonSpec s;
  s.particles = {particle("a", {0, 0, 0}), particle("b", {0, 1, 0}), particle("c", {-1, 0, 0}),
                 particle("tip", {1, 0, 0})};
  connect(s, {"a", "b", "c"});
  s.sticks.push_back(stick("a", "tip"));
  s.segments = {group("base", {"a", "b", "c"}), bone("rod", "a", "tip")};
  JointSpec j = hinge("j", "base", "rod", Vec3::UnitY(), -30, 0);
  j.stiffness = stiffness;
  j.damping = damping;
  s.joints = {j};
  return s;
}

class SoftLimit : public testing::TestWithParam<Method> {
 protected:
  Scene scene(double stiffness, double damping, double step = kLeverStep) const {
    Scene scene = sceneOf(lever(stiffness, damping));
    for (const char* name : {"a", "b", "c"}) {
      scene.pins.push_back(pinOf(name));
    }
    scene.gravity = Vec3(0, 0, -kWeakGravity);
    scene.solver.method = GetParam();
    scene.solver.step = step;
    scene.solver.sleep = false;
    return scene;
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, SoftLimit,
                         testing::Values(Method::kJakobsen, Method::kShake, Method::kRk));

double sag(const World& world) { return std::atan2(-world.x(3).z(), world.x(3).x()); }

/// [rad] of I a'' + d a' + k a = m g l, all of the lever, from rest at 0.
double oscillator(double damping, double t) {
  const double rate = damping / 2, square = kLimitStiffness - rate * rate;
  const double w = std::sqrt(std::abs(square));
  const double co = square > 0 ? std::cos(w * t) : std::cosh(w * t);
  const double si = square > 0 ? std::sin(w * t) : std::sinh(w * t);
  return kWeakGravity / kLimitStiffness * (1 - std::exp(-rate * t) * (co + rate / w * si));
}

/// Largest distance from the formula over 1.5 s, of the angle of rest.
double worstError(const Scene& scene, double damping) {
  World world(scene);
  double worst = 0;
  for (int i = 1; i <= 1.5 / scene.solver.step; ++i) {
    world.steps(1);
    worst = std::max(worst, std::abs(sag(world) - oscillator(damping, world.state.time)));
  }
  return worst * kLimitStiffness / kWeakGravity;
}

TEST_P(SoftLimit, SwingsUndampedDecaysUnderdampedCreepsOverdamped) {
  const double most = GetParam() == Method::kJakobsen ? 2e-2 : 3e-3;
  for (const double damping : {0.0, 4.0, 20.0, 60.0, 500.0})
    EXPECT_LT(worstError(scene(kLimitStiffness, damping), damping), most)
        << damping << " N m s/rad";
}

TEST_P(SoftLimit, IsOfSecondOrderByTheDirectMethods) {
  const double order = GetParam() == Method::kJakobsen ? 1 : 2;
  const double coarse = worstError(scene(kLimitStiffness, 4, 5e-3), 4),
               fine = worstError(scene(kLimitStiffness, 4, 2.5e-3), 4);
  EXPECT_NEAR(std::log2(coarse / fine), order, 0.15) << "finer: the formula is of a level lever";
}

TEST_P(SoftLimit, ThrowsBackByTheFormulaAndNeverPulls) {
  const double tolerance = GetParam() == Method::kJakobsen ? 3e-3 : 2e-4;
  for (const double damping : {0.0, 4.0, 20.0}) {
    Scene free = scene(kLimitStiffness, damping);
    free.gravity.setZero();
    World world(free);
    world.state.v.col(3) = Vec3(0, 0, -0.1);
    world.steps(6000);
    // The torque ends where the acceleration does, tan(w t) = 2 rate w / (rate^2 - w^2); by then
    // the speed has decayed as the envelope has.
    const double rate = damping / 2, w = std::sqrt(kLimitStiffness - rate * rate);
    const double end = std::atan2(2 * rate * w, rate * rate - w * w) / w;
    EXPECT_NEAR(world.v(3).norm() / 0.1, std::exp(-rate * end), tolerance);
    EXPECT_LT(sag(world), 0) << "has left the limit";
  }
}

TEST_P(SoftLimit, ComesToRestWhereItsTorqueIsTheWeights) {
  for (const double step : {1.0 / 60, 1.0 / 1000})
    for (const auto& [stiffness, damping] : {std::pair(200.0, 20.0), std::pair(1e5, 1e3)}) {
      Scene heavy = scene(stiffness, damping, step);
      heavy.gravity = Vec3(0, 0, -9.81);
      World world(heavy);
      world.steps(static_cast<int>(10 / step));
      EXPECT_LT(world.v(3).norm(), 1e-6);
      EXPECT_NEAR(sag(world) * stiffness, 9.81 * std::cos(sag(world)), 2e-3) << step;
    }
}

TEST_P(SoftLimit, OfInfiniteStiffnessIsHard) {
  World world(scene(std::numeric_limits<double>::infinity(), 0, 1e-3));
  world.steps(1000);
  EXPECT_LT(std::abs(sag(world)), 1e-4);
}

/// [J] in the springs of all limits.
double storedEnergy(const World& world) {
  double sum = 0;
  for (const Limit& limit : world.model.skeletons[0].limits) {
    const double value = std::min(0.0, limitValue(limit, world.state.x.data()));
    sum += value * value / (2 * limit.compliance);
  }
  return sum;
}

/// The human with all its limits soft, a foot and a hand thrown, weightless.
Scene softHuman(Method method, double damping) {
  Scene scene = parseScene("gravity: [0, 0, 0]\nragdolls: [{model: human}]\n");
  SkeletonSpec soft = *scene.ragdolls[0].skeleton;
  for (JointSpec& j : soft.joints) {
    j.stiffness = 300;
    j.damping = damping;
  }
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(soft);
  scene.solver.method = method;
  scene.solver.step = 1.0 / 480;
  return scene;
}

TEST_P(SoftLimit, OfAHumanKeepMomentumAndGainNoEnergy) {
  for (const double damping : {0.0, 5.0}) {
    World world(softHuman(GetParam(), damping));
    const Skeleton& s = world.model.skeletons[0];
    world.state.v.col(s.particle("left_foot")) = Vec3(6, 0, 0);
    world.state.v.col(s.particle("right_hand")) = Vec3(-5, 2, 0);
    world.steps(1);  // the throw has become a motion that the sticks allow
    const auto energy = [&] {
      return kineticEnergy(world.model, world.state) + storedEnergy(world);
    };
    const Vec3 p = momentum(world.model, world.state);
    const double start = energy();
    double stored = 0, highest = 0;
    for (int i = 0; i < 2 * 480; ++i) {
      world.steps(1);
      stored = std::max(stored, storedEnergy(world));
      highest = std::max(highest, energy() / start);
    }
    EXPECT_GT(stored, 0.05 * start) << "the limits were reached";
    EXPECT_LT(highest, 1 + 1e-6);
    if (damping > 0) {
      EXPECT_LT(energy(), 0.7 * start);
    } else if (GetParam() != Method::kJakobsen) {
      EXPECT_GT(energy(), 0.9 * start);
    }
    EXPECT_LT((momentum(world.model, world.state) - p).norm() / p.norm(), 1e-9);
  }
}

}  // namespace
}  // namespace ragdoll
