// Laws of joint limits in motion: they hold under a strong poke, push back from any backward bend,
// keep momentum. Soft limits: soft_limits_test.cpp.
#include "ragdoll_sim/core/limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/plane_limits.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

Scene humanScene(const std::string& model, const std::string& more = "") {
  return parseScene("ragdolls: [{model: " + model + "}]\nsolver: {preset: thesis}\n" + more);
}

class HumanModel : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Models, HumanModel,
                         testing::Values("human", "human_lumped", "human_thesis"));

TEST_P(HumanModel, StandsWithinItsLimits) {
  const Model model = buildModel(humanScene(GetParam()));
  EXPECT_LT(limitViolation(model, model.start_position, 0), rad(1e-3));
  for (const std::string& warning : model.warnings)
    EXPECT_EQ(warning.find("joint"), std::string::npos) << warning;
}

TEST_P(HumanModel, IsWellConditioned) {
  const Model model = buildModel(humanScene(GetParam()));
  EXPECT_LE(model.systems[0].direct.condition, 100);
}

/// [rad] of the worst joint over a poke of 0.2 s at a limb, weightless, and a second more.
double worstAfterPoke(const std::string& model, Method method, double step, const std::string& body,
                      const Vec3& force) {
  Scene scene = humanScene(model, "gravity: [0, 0, 0]\n");
  scene.solver.method = method;
  scene.solver.step = step;
  PokeSpec poke;
  poke.body = body;
  poke.force = force;
  poke.duration = 0.2;
  scene.pokes = {poke};
  World world(scene);
  double worst = 0;
  for (int i = 0; i < 1.2 / step; ++i) {
    world.steps(1);
    worst = std::max(worst, maxLimitViolation(world.model, world.state));
  }
  return worst;
}

TEST_P(HumanModel, HoldsUnderAPokeOf400Newton) {
  for (const auto& [method, step, most] :
       {std::tuple(Method::kJakobsen, 1.0 / 60, 14.0),
        std::tuple(Method::kJakobsen, 1.0 / 240, 4.0), std::tuple(Method::kShake, 1.0 / 60, 2.0),
        std::tuple(Method::kShake, 1.0 / 120, 2.0)})
    for (const std::string body : {"left_foot", "right_hand", "head", "left_knee"})
      for (const Vec3& force :
           {Vec3(400, 0, 0), Vec3(-400, 0, 0), Vec3(0, 400, 0), Vec3(0, 0, 400)})
        EXPECT_LT(deg(worstAfterPoke(GetParam(), method, step, body, force)), most)
            << body << " " << force.transpose() << " at " << step << " s";
}

struct Loss {
  double momentum, angular;  ///< relative, in two seconds
};

/// A foot and a hand thrown against the limits of knee, hip and elbow, weightless.
Loss lossOf(const std::string& model, Method method, double step, bool with_joints) {
  Scene scene = humanScene(model, "gravity: [0, 0, 0]\n");
  scene.solver.method = method;
  scene.solver.step = step;
  if (!with_joints) removeJoints(scene);
  World world(scene);
  world.state.v.col(world.model.skeletons[0].particle("left_foot")) = Vec3(20, 0, 0);
  world.state.v.col(world.model.skeletons[0].particle("right_hand")) = Vec3(-15, 5, 0);
  const Vec3 p = momentum(world.model, world.state), l = angularMomentum(world.model, world.state);
  world.steps(static_cast<int>(2 / step));
  return {(momentum(world.model, world.state) - p).norm() / p.norm(),
          (angularMomentum(world.model, world.state) - l).norm() / l.norm()};
}

TEST_P(HumanModel, KeepsMomentumWhereNothingPullsAtIt) {
  for (const Method method : {Method::kJakobsen, Method::kShake})
    for (const double step : {1.0 / 60, 1.0 / 960})
      EXPECT_LT(lossOf(GetParam(), method, step, true).momentum, 1e-10);
}

TEST_P(HumanModel, LosesLittleAngularMomentumUnderTheDirectMethod) {
  // Sticks alone keep it; a limit's push turns with the step, which is an error of first order.
  EXPECT_LT(lossOf(GetParam(), Method::kShake, 1.0 / 120, false).angular, 1e-8);
  EXPECT_LT(lossOf(GetParam(), Method::kShake, 1.0 / 120, true).angular, 0.02);
  EXPECT_LT(lossOf(GetParam(), Method::kShake, 1.0 / 960, true).angular, 0.004);
}

TEST_P(HumanModel, LosesNoMoreAngularMomentumThanItsSticksDo) {
  // The relaxation loses some, to first order, as each sweep turns the levers of the last.
  for (const double step : {1.0 / 60, 1.0 / 240, 1.0 / 960})
    EXPECT_LT(lossOf(GetParam(), Method::kJakobsen, step, true).angular,
              1.1 * lossOf(GetParam(), Method::kJakobsen, step, false).angular);
  EXPECT_LT(lossOf(GetParam(), Method::kJakobsen, 1.0 / 960, true).angular, 0.1);
}

/// The arm's elbow, bent to the back by an angle at the start, everything else at rest.
double bendAfter(double start_deg, int steps) {
  SkeletonSpec s = limbs();
  s.joints = {cone("shoulder", "trunk", "upper_arm", Vec3(0.6, -0.6, -0.5), 100),
              hinge("elbow", "upper_arm", "forearm", -Vec3::UnitY(), 0, 145),
              hinge("wrist", "forearm", "palm", -Vec3::UnitY(), -60, 70)};
  World world(weightless(s));
  const Skeleton& k = world.model.skeletons[0];
  const int elbow = k.particle("elbow"), hand = k.particle("hand"), finger = k.particle("finger");
  const Vec3 d(std::sin(rad(start_deg)), 0, -std::cos(rad(start_deg)));
  world.state.x.col(hand) = world.x(elbow) + 0.25 * d;
  world.state.x.col(finger) = world.x(elbow) + 0.4 * d;
  world.steps(steps);
  return limitViolation(world.model, world.state.x, 0);
}

TEST(Elbow, IsPushedBackFromAnyBackwardBend) {
  for (const double angle : {-1e-6, -0.01, -1.0, -10.0, -45.0, -85.0}) {
    if (angle > -20) {  // else the step guard opens it at 5 rad/s, so that nothing is shot out
      EXPECT_LT(bendAfter(angle, 1), 0.5 * rad(-angle)) << angle;
    }
    EXPECT_LT(bendAfter(angle, 20), 0.02 * rad(-angle)) << angle;
  }
}

TEST(Planes, RememberTheLastAllowedDirectionInTheState) {
  Scene scene = humanScene("human_thesis");
  scene.ragdolls[0].pose.position.z() = 1.5;
  scene.ragdolls[0].angular_velocity = Vec3(2, 3, 1);
  World world(scene);
  world.steps(40);
  World other(scene);
  other.state = world.state;
  world.steps(40);
  other.steps(40);
  EXPECT_EQ(hash(world.state), hash(other.state));
  EXPECT_EQ(world.state.allowed, other.state.allowed);
  EXPECT_EQ(world.state.allowed.cols(), 11);
}

/// What a joint of human_thesis allows of a child bone that hangs down, bent by `bend` degrees
/// towards `to` and that plane turned by `turn` to the left.
bool thesisAllows(const std::string& joint, const Vec3& to, double bend, double turn) {
  static const Model model = buildModel(humanScene("human_thesis"));
  const Skeleton& s = model.skeletons[0];
  const Vec3 aside(0, 1, 0);
  const Vec3 towards = std::cos(rad(turn)) * to + std::sin(rad(turn)) * aside;
  for (const PlaneLimit& limit : s.plane_limits)
    if (limit.joint == s.joint(joint))
      return isAllowed(limit, std::sin(rad(bend)) * towards + std::cos(rad(bend)) * Vec3(0, 0, -1));
  throw std::invalid_argument(joint);
}

TEST(ThesisBody, KneesAndElbowsBendOneWayOnly) {
  const Vec3 ahead = Vec3::UnitX(), back = -ahead;
  for (double bend = 15; bend <= 125; bend += 5) {
    for (const char* knee : {"left_knee", "right_knee"}) {
      for (const double turn : {-44.0, 0.0, 44.0})
        EXPECT_TRUE(thesisAllows(knee, back, bend, turn)) << bend << " " << turn;
      for (const double turn : {-46.0, 46.0, 90.0, -90.0, 180.0})
        EXPECT_FALSE(thesisAllows(knee, back, bend, turn)) << bend << " " << turn;
    }
    for (const auto& [elbow, out] : {std::pair("left_elbow", 1), std::pair("right_elbow", -1)}) {
      EXPECT_TRUE(thesisAllows(elbow, ahead, bend, 0)) << bend;
      for (const double turn : {-56.0, 61.0, 90.0, -90.0, 180.0})
        EXPECT_FALSE(thesisAllows(elbow, ahead, bend, out * turn)) << bend << " " << turn;
    }
  }
}

TEST(ThesisBody, FallsAndTumblesUnderTheDirectSolverToo) {
  for (const std::string name : {"stairs", "between_objects", "weightless"}) {
    Scene scene = loadScene(name);
    scene.ragdolls[0].skeleton = humanScene("human_thesis").ragdolls[0].skeleton;
    scene.pokes.clear();
    scene.solver.method = Method::kShake;
    World world(scene);
    const auto energy = [&] {
      return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
    };
    const double start = energy();
    for (int i = 0; i < 360; ++i) {
      world.steps(1);
      ASSERT_TRUE(world.state.x.allFinite()) << name << ", step " << i;
      ASSERT_LT(energy(), start + 1e-2) << name << ", step " << i;
      ASSERT_LT(maxStickError(world.model, world.state), 1e-3) << name << ", step " << i;
      EXPECT_LT(limitViolation(world.model, world.state.x, 0), rad(2)) << name << ", step " << i;
    }
    if (name == "weightless") {
      EXPECT_GT(energy(), 0.5 * start) << "stopped in the air";
    }
  }
}

}  // namespace
}  // namespace ragdoll
