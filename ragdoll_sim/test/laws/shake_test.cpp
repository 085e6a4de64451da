// Laws of the direct method: second order, symplectic, reversible; exact inertia; contacts by the
// cone.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/gravity.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

/// The shipped human, without its joints' limits, so that the motion is smooth.
Scene smoothHuman(const std::string& text, Method method, double step) {
  Scene scene = parseScene(text, "test");
  removeJoints(scene);
  scene.solver.method = method;
  scene.solver.step = step;
  return scene;
}

constexpr char kTumble[] =
    "gravity: [0, 0, 0]\n"
    "ragdolls: [{name: ragdoll, model: human, angular_velocity: [1, 2, 3]}]\n";

Points positionsAfter(const Scene& scene, double seconds) {
  World world(scene);
  world.steps(static_cast<int>(std::lround(seconds / scene.solver.step)));
  return world.state.x;
}

double rms(const Points& a, const Points& b) {
  return std::sqrt((a - b).squaredNorm() / static_cast<double>(a.cols()));
}

/// Least-squares slope of log error over log step.
double fittedOrder(Method method, const std::vector<double>& steps) {
  const Points reference = positionsAfter(smoothHuman(kTumble, Method::kRk, 1.0 / 1024), 0.5);
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const double h : steps) {
    const double x = std::log(h);
    const double y = std::log(rms(positionsAfter(smoothHuman(kTumble, method, h), 0.5), reference));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double n = static_cast<double>(steps.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(Order, RungeKuttaIsFifth) {
  const Points reference = positionsAfter(smoothHuman(kTumble, Method::kRk, 1.0 / 1024), 0.5);
  const double coarse =
      rms(positionsAfter(smoothHuman(kTumble, Method::kRk, 1.0 / 64), 0.5), reference);
  const double fine =
      rms(positionsAfter(smoothHuman(kTumble, Method::kRk, 1.0 / 128), 0.5), reference);
  EXPECT_NEAR(std::log2(coarse / fine), 5, 0.6);
  // Two independent methods agree.
  EXPECT_LT(rms(positionsAfter(smoothHuman(kTumble, Method::kShake, 1.0 / 8192), 0.5), reference),
            1e-5);
}

TEST(Order, ShakeIsSecondAndJakobsenFirst) {
  EXPECT_NEAR(fittedOrder(Method::kShake, {1.0 / 128, 1.0 / 256, 1.0 / 512, 1.0 / 1024}), 2, 0.1);
  EXPECT_NEAR(fittedOrder(Method::kJakobsen, {1.0 / 1024, 1.0 / 2048, 1.0 / 4096}), 1, 0.15);
}

// Leapfrog does not keep E = 1/2 v M v but E + h^2/24 a M a, of which a M a h^2/8 is what the
// velocities in the middle of the steps before and after have more than those between them. So E
// swings, by what the accelerations on the way say: the law is in what is kept, which no rounding
// of a chaotic motion changes.

/// A minute at 120 Hz, looked at every step.
void expectKeptForAMinute(const std::string& text) {
  World world(smoothHuman(text, Method::kShake, 1.0 / 120));
  const double h = world.model.solver.step, start = kineticEnergy(world.model, world.state);
  const Vec3 spin = angularMomentum(world.model, world.state);
  const Vec3 drift = momentum(world.model, world.state);
  double lowest = INFINITY, highest = 0, swing = 0, before = 0, at = start, worst = 0;
  for (int i = 0; i < 7200; ++i) {
    const Points x = world.state.x;
    world.steps(1);
    State middle = world.state;
    middle.v = (world.state.x - x) / h;
    const double half = kineticEnergy(world.model, middle);
    if (i > 0) {
      const double correction = ((before + half) / 2 - at) / 3;
      swing = std::max(swing, correction);
      worst = std::max(worst, std::abs(at - start));
      lowest = std::min(lowest, at + correction);
      highest = std::max(highest, at + correction);
    }
    before = half;
    at = kineticEnergy(world.model, world.state);
  }
  const double next_order = swing / 20;  // h^2 smaller: 1/50 to 1/125 in fifty such minutes
  EXPECT_LT(highest - lowest, next_order);
  EXPECT_LT(worst, swing + next_order);
  EXPECT_LT((angularMomentum(world.model, world.state) - spin).norm() / spin.norm(), 1e-10);
  EXPECT_LT((momentum(world.model, world.state) - drift).norm(), 1e-10);
  EXPECT_LT(maxStickError(world.model, world.state), 1e-9);
}

TEST(Conservation, AMinuteOfTheShippedTumblingAt120Hz) {
  expectKeptForAMinute(
      "gravity: [0, 0, 0]\n"
      "ragdolls: [{name: ragdoll, model: human, angular_velocity: [1.5, 2, 0.6]}]\n");
}

TEST(Conservation, AMinuteOfFasterTumblingAt120Hz) { expectKeptForAMinute(kTumble); }

TEST(Conservation, RunsBackwardsToWhereItCameFrom) {
  World world(smoothHuman(kTumble, Method::kShake, 1.0 / 240));
  const Points start = world.state.x;
  world.steps(240);
  EXPECT_GT(rms(world.state.x, start), 0.1);
  world.state.v = -world.state.v;
  world.steps(240);
  EXPECT_LT(rms(world.state.x, start), 1e-7);
}

/// A rod hung by one end, 1 m, centre of mass and gyration as given (of its length).
Scene rodPendulum(Method method, double com, double gyration, double step) {
  SkeletonSpec body = oneStick(0, 0);
  body.segments[0].mass = 2;
  body.segments[0].com = com;
  body.segments[0].gyration = gyration;
  Scene scene = sceneOf(body);
  scene.pins = {pinOf("a")};
  scene.solver.method = method;
  scene.solver.step = step;
  return scene;
}

/// Period of small swings from the times at which x of the free end passes zero.
double swingPeriod(Scene scene, double angle) {
  scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(M_PI / 2 - angle, Vec3::UnitY()));
  World world(scene);
  std::vector<double> crossings;
  double before = world.x(1).x();
  while (crossings.size() < 5) {
    world.steps(1);
    const double now = world.x(1).x();
    if (before > 0 && now <= 0)
      crossings.push_back(world.state.time - scene.solver.step * now / (now - before));
    before = now;
  }
  return (crossings[4] - crossings[0]) / 4;
}

/// Of small swings of a rod, the centre of mass and the radius of gyration in parts of 1 m.
double exactPeriod(double com, double gyration, double angle) {
  return 2 * M_PI * std::sqrt((com * com + gyration * gyration) / (kG * com)) *
         (1 + angle * angle / 16);
}

TEST(Inertia, CompoundPendulumHasItsPeriod) {
  constexpr double kCom = 0.43, kGyration = 0.28, kAngle = 0.01;
  const double exact = exactPeriod(kCom, kGyration, kAngle);
  const auto error = [&](Method method, double step) {
    return std::abs(swingPeriod(rodPendulum(method, kCom, kGyration, step), kAngle) / exact - 1);
  };
  EXPECT_LT(error(Method::kShake, 1e-3), 1e-6);
  EXPECT_LT(error(Method::kRk, 1e-3), 1e-9);
  EXPECT_LT(error(Method::kJakobsen, 1e-4), 1e-6);  // 5e-6 at 1e-3
}

/// A uniform rod: the formula's period is sqrt(2 / 3) of a thread's of its length with all the mass
/// at the free end, which is what two equal masses at its ends make of it.
TEST(Inertia, LumpedMassesSwingTwentyTwoPercentTooSlowly) {
  constexpr double kAngle = 0.01;
  const double uniform = exactPeriod(0.5, std::sqrt(1.0 / 12), kAngle);
  const double too_slow = std::sqrt(1.5);
  EXPECT_NEAR(too_slow, 1.2247, 1e-4);
  for (const Method method : {Method::kShake, Method::kRk, Method::kJakobsen}) {
    Scene scene = rodPendulum(method, 0.5, std::sqrt(1.0 / 12), 1e-4);
    EXPECT_NEAR(swingPeriod(scene, kAngle) / uniform, 1, 1e-6);
    scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(oneStick(1, 1));
    EXPECT_NEAR(swingPeriod(scene, kAngle) / uniform, too_slow, 1e-6);
  }
}

class ShakeSliding : public testing::TestWithParam<double> {};

TEST_P(ShakeSliding, StopsWithinAThousandthAtSixtyHertzInEveryDirection) {
  constexpr double kSpeed = 2, kMu = 0.5;
  const Vec3 direction(std::cos(rad(GetParam())), std::sin(rad(GetParam())), 0);
  for (const SkeletonSpec& body : {oneParticle(3, 0.1), oneStick(1, 2, 0.1)}) {
    Scene scene = sceneOf(body, Vec3(0, 0, 0.1));
    scene.ragdolls[0].velocity = kSpeed * direction;
    scene.obstacles = {floorPlane(kMu)};
    scene.solver.method = Method::kShake;
    World world(scene);
    world.steps(60);
    const Vec3 way = centreOfMass(world.model, world.state, 0) -
                     centreOfMass(world.model, startState(world.model), 0);
    const double exact = kSpeed * kSpeed / (2 * kMu * kG);
    EXPECT_NEAR(way.norm() / exact, 1, 1e-3);
    EXPECT_LT(std::abs(way.cross(direction).norm()) / exact, rad(0.1));
    EXPECT_LT(world.state.v.norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Directions, ShakeSliding, testing::Values(0.0, 31.0, 45.0));

TEST(ShakeBounce, ParticleRisesToRestitutionSquaredWithinAPercentAtSixtyHertz) {
  for (const double e : {0.5, 0.8, 1.0}) {
    Scene scene = sceneOf(oneParticle(1, 0.05), Vec3(0, 0, 1.05));
    scene.obstacles = {floorPlane(0, e)};
    scene.solver.method = Method::kShake;
    World world(scene);
    double top = 0;
    for (int i = 0; i < 28 + static_cast<int>(27 * e) + 3; ++i) {
      world.steps(1);
      if (world.state.time < std::sqrt(2 / kG)) continue;
      // Highest point of the present parabola, so that the sampling does not matter.
      const double v = world.v(0).z();
      top = world.x(0).z() - 0.05 + v * v / (2 * kG);
    }
    EXPECT_NEAR(top / (e * e), 1, 0.01) << "restitution " << e;
  }
}

/// A rod falls without turning and strikes the floor with its lower end. The impulse J along the
/// normal at the distance d beside the centre of mass turns the end's speed round: with 1/m + d^2/I
/// the end's inverse mass, J = (1 + e) v / (1/m + d^2/I); then u = J/m - v, omega = J d / I.
class RodBounce : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(RodBounce, RisesAndTurnsByTheImpulseAtItsEndAtSixtyHertz) {
  constexpr double kRadius = 0.05, kHeight = 1, kMass = 2;
  const double tilt = rad(std::get<0>(GetParam())), e = std::get<1>(GetParam());
  for (const double gyration : {0.5, 1 / std::sqrt(12.0)}) {  // masses at the ends, uniform rod
    SkeletonSpec body = oneStick(0, 0, kRadius);
    body.segments[0].mass = kMass;
    body.segments[0].gyration = gyration;
    Scene scene = sceneOf(body, Vec3(0, 0, kHeight + kRadius));
    scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(-tilt, Vec3::UnitY()));
    scene.obstacles = {floorPlane(0, e)};
    scene.solver.method = Method::kShake;
    World world(scene);
    const double start = centreOfMass(world.model, world.state, 0).z();
    world.steps(static_cast<int>(std::ceil(std::sqrt(2 * kHeight / kG) * 60)) + 1);

    const double v = std::sqrt(2 * kG * kHeight), d = 0.5 * std::cos(tilt);
    const double I = kMass * gyration * gyration;
    const double J = (1 + e) * v / (1 / kMass + d * d / I);
    const double exact = std::pow(J / kMass - v, 2) / (2 * kG);  // [m] from where it struck
    const Vec3 u = momentum(world.model, world.state) / kMass;
    const double top = centreOfMass(world.model, world.state, 0).z() + u.z() * u.z() / (2 * kG);
    EXPECT_NEAR((top - (start - kHeight)) / exact, 1, 1e-6) << "gyration " << gyration;
    const Vec3 arm = world.x(1) - world.x(0);
    const Vec3 omega = arm.cross(world.v(1) - world.v(0)) / arm.squaredNorm();
    EXPECT_NEAR(omega.y() / (J * d / I), 1, 1e-6) << "gyration " << gyration;
    EXPECT_LT(u.head<2>().norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(TiltsAndRestitutions, RodBounce,
                         testing::Combine(testing::Values(60.0, 75.0, 85.0),
                                          testing::Values(0.7, 0.9, 1.0)));

TEST(ShakeContact, EnergyOfAFallNeverRisesAndTheBodyComesToRest) {
  Scene scene = parseScene(
      "ragdolls: [{name: ragdoll, model: human, position: [0, 0, 1.5], rpy_deg: [20, 30, 0]}]\n"
      "obstacles: [{type: plane, point: [0, 0, 0], normal: [0, 0, 1], friction: 0.5}]\n",
      "test");
  scene.solver.method = Method::kShake;
  scene.solver.step = 1.0 / 120;
  World world(scene);
  const auto energy = [&world] {
    return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
  };
  const double start = energy();
  for (int i = 0; i < 600; ++i) {
    world.steps(1);
    ASSERT_LT(energy(), start + 1e-2) << "step " << i;
    ASSERT_LT(maxStickError(world.model, world.state), 1e-3);
    ASSERT_LT(maxPenetration(world.model, world.state), 1e-3);
    ASSERT_LT(maxLimitViolation(world.model, world.state), rad(2));
  }
  EXPECT_LT(world.state.v.colwise().norm().maxCoeff(), 1e-3);
}

TEST(ShakeContact, NothingTunnelsThroughAThinBox) {
  for (const double speed : {3.0, 30.0, 1000.0}) {
    Scene scene = sceneOf(oneStick(1, 1, 0.02), Vec3(-0.5, 0, 3));
    scene.ragdolls[0].velocity = Vec3(0, 0, -speed);
    ObstacleSpec box;
    box.type = ObstacleSpec::Type::kBox;
    box.size = Vec3(0.2, 4, 0.2);
    scene.obstacles = {box};
    scene.solver.method = Method::kShake;
    World world(scene);
    world.steps(90);
    EXPECT_GT(0.5 * (world.x(0).z() + world.x(1).z()), 0.119) << speed << " m/s";
  }
}

}  // namespace
}  // namespace ragdoll
