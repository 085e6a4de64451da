// Contact that gives way is a spring and a damper that only push: a ball on a spring floor against
// the formulas of the oscillator, a falling human against itself at finer steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/contacts.h"
#include "support/error_of.h"
#include "support/gravity.h"
#include "support/peak_force.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kBallRadius = 0.1;

struct Floor {
  double stiffness = 1000, damping = 0, friction = 0;
};

/// A ball of 1 kg whose surface is `gap` above a spring floor, and its contacts.
class BallOnASpring {
 public:
  BallOnASpring(const Floor& floor, double gap, const Vec3& velocity, double step,
                Method method = Method::kShake, double gravity = kG)
      : model_(build(floor, gap, velocity, step, method, gravity)), contacts(model_) {
    inputs_ = startInputs(model_);
    state = startState(model_);
    contacts.begin(state);
    workspace_.keepContacts(&contacts.log());
  }

  void steps(long n) {
    for (long i = 0; i < n; ++i) {
      contacts.begin(state);
      step(model_, inputs_, workspace_, state);
      contacts.end(model_, inputs_, state);
    }
  }
  void run(double seconds) { steps(std::lround(seconds / model_.solver.step)); }
  double depth() const { return kBallRadius - state.x(2, 0); }
  /// [J] with the spring's.
  double energy(double stiffness) const {
    const double d = std::max(0.0, depth());
    return kineticEnergy(model_, state) + potentialEnergy(model_, state) + 0.5 * stiffness * d * d;
  }
  /// [N] largest since the last call.
  double peak() {
    double most = 0;
    for (const Touch& t : contacts.take().touches) most = std::max(most, t.peak_force);
    return most;
  }

 private:
  static Model build(const Floor& floor, double gap, const Vec3& velocity, double step,
                     Method method, double gravity) {
    Scene scene = sceneOf(oneParticle(1, kBallRadius), Vec3(0, 0, kBallRadius + gap));
    scene.ragdolls[0].velocity = velocity;
    scene.gravity = Vec3(0, 0, -gravity);
    ObstacleSpec plane = floorPlane(floor.friction, 1);  // no spring has a restitution
    plane.contact = {floor.stiffness, floor.damping};
    scene.obstacles.push_back(plane);
    scene.solver.method = method;
    scene.solver.step = step;
    scene.solver.sleep = false;
    return buildModel(scene);
  }

  Model model_;
  Inputs inputs_;
  Workspace workspace_;

 public:
  State state;
  Contacts contacts;
};

class CompliantContact : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, CompliantContact, testing::Values(Method::kShake, Method::kRk));

TEST_P(CompliantContact, ABallOnASpringFloorOscillatesByTheFormula) {
  const double k = 400, w = std::sqrt(k), sag = kG / k;
  BallOnASpring ball({k}, 0, Vec3::Zero(), 1e-4, GetParam());
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    ball.steps(1);
    worst = std::max(worst, std::abs(ball.depth() - sag * (1 - std::cos(w * ball.state.time))));
  }
  EXPECT_LT(worst, 1e-4 * sag);
}

TEST_P(CompliantContact, ABallComesToRestAtItsWeightOverTheStiffness) {
  for (const double hz : {60, 120, 1000})
    for (const double k : {500.0, 2e4, 1e6}) {
      BallOnASpring ball({k, std::sqrt(k)}, 0.05, Vec3::Zero(), 1 / hz, GetParam());
      ball.run(10);
      EXPECT_NEAR(ball.depth() * k, kG, 1e-6) << k << " N/m at " << hz << " Hz";
      EXPECT_LT(ball.state.v.norm(), 1e-8);
    }
}

/// v sqrt(m k) of an impact without gravity; the contact lasts pi sqrt(m / k), here 20 ms and more.
TEST_P(CompliantContact, ThePeakForceOfAnImpactIsByTheFormulaAt120Hz) {
  for (const double lasts : {0.02, 0.035, 0.1})
    for (int i = 0; i < 10; ++i) {
      const double k = std::pow(M_PI / lasts, 2), v = 2;
      BallOnASpring ball({k}, 0.03 + 0.0017 * i, Vec3(0, 0, -v), 1.0 / 120, GetParam(), 0);
      ball.run(1);
      EXPECT_NEAR(ball.peak() / (v * std::sqrt(k)), 1, 0.01) << lasts << " s, " << i;
    }
}

TEST_P(CompliantContact, ThePeakForceOfStifferImpactsIsByTheFormulaAsTheStepShrinks) {
  for (const double k : {1e5, 1e7, 1e9}) {
    const double lasts = M_PI / std::sqrt(k), v = 3;
    BallOnASpring ball({k}, 0.37 * lasts * v, Vec3(0, 0, -v), lasts / 20, GetParam(), 0);
    ball.steps(60);
    EXPECT_NEAR(ball.peak() / (v * std::sqrt(k)), 1, 0.005) << k << " N/m";
  }
}

/// A damper that presses with the spring moves the peak towards the start of the impact, within a
/// step.
TEST_P(CompliantContact, ThePeakForceOfADampedImpactIsByTheFormulaAt120Hz) {
  for (const double lasts : {0.02, 0.035, 0.1})
    for (const double ratio : {0.1, 0.3, 0.6})
      for (int i = 0; i < 10; ++i) {
        const double w = M_PI / lasts, a = ratio * w / std::sqrt(1 - ratio * ratio), v = 2;
        const double k = w * w + a * a;
        double exact = 0;  // of k y + 2 a y', y = v / w exp(-a t) sin(w t)
        for (double t = 0; t < lasts; t += 1e-4 * lasts)
          exact = std::max(exact,
                           v * std::exp(-a * t) *
                               (2 * a * std::cos(w * t) + (k - 2 * a * a) / w * std::sin(w * t)));
        BallOnASpring ball({k, 2 * a}, 0.03 + 0.0017 * i, Vec3(0, 0, -v), 1.0 / 120, GetParam(), 0);
        ball.run(1);
        EXPECT_NEAR(ball.peak() / exact, 1, 0.03) << lasts << " s, " << ratio << ", " << i;
      }
}

/// Friction is part of the force, at its peak as in the mean of a step.
TEST_P(CompliantContact, ThePeakForceOfASlidingImpactHasItsFriction) {
  const double k = 5000, v = 2, mu = 0.5;
  for (const double hz : {120, 1000, 4000}) {
    BallOnASpring ball({k, 0, mu}, 0.03, Vec3(3 * v, 0, -v), 1 / hz, GetParam(), 0);
    ball.run(0.2);
    EXPECT_NEAR(ball.peak() / (v * std::sqrt(k) * std::hypot(1, mu)), 1, 0.01) << hz;
  }
}

/// With gravity the spring swings about the depth at which it carries the weight.
TEST_P(CompliantContact, ThePeakForceOfAFallHasTheWeightInIt) {
  const double k = 5000, v = std::sqrt(2 * kG * 0.3);
  BallOnASpring ball({k}, 0.3, Vec3::Zero(), 1.0 / 120, GetParam());
  ball.run(0.5);
  EXPECT_NEAR(ball.peak() / (kG + std::hypot(kG, v * std::sqrt(k))), 1, 0.01);
}

TEST_P(CompliantContact, EnergyNeverRises) {
  for (const double hz : {60, 120, 480})
    for (const double k : {200.0, 3e3, 1e5, 1e8})
      for (const double damping : {0.0, 0.05, 1.0, 50.0}) {
        BallOnASpring ball({k, damping * std::sqrt(k), 0.5}, 0.2, Vec3(1, 0, 0), 1 / hz,
                           GetParam());
        double last = ball.energy(k);
        const double start = last;
        for (int i = 0; i < 2 * hz; ++i) {
          ball.steps(1);
          const double now = ball.energy(k);
          ASSERT_LT(now - last, 1e-9 * start) << k << " N/m, " << damping << ", " << hz << " Hz";
          last = now;
        }
      }
}

/// Errors at steps that shrink to a sixteenth, of a ball that meets a damped spring floor off any
/// whole step, at `until` [s].
void expectSecondOrderOfABall(Method method, double until, const Vec3* exact) {
  const Floor floor{900, 6};
  const auto run = [&](double hz) {
    BallOnASpring ball(floor, 0.0731, Vec3(0, 0, -0.611), 1 / hz, method);
    ball.run(until);
    return Vec3(ball.depth(), ball.state.v(2, 0) / std::sqrt(floor.stiffness), 0);
  };
  const Vec3 reference = exact ? *exact : run(64000);
  const double coarse = (run(250) - reference).norm(), fine = (run(4000) - reference).norm();
  EXPECT_GT(std::log2(coarse / fine) / 4, 1.85);
  EXPECT_LT((run(16000) - reference).norm(), 0.1 * fine);
}

TEST_P(CompliantContact, ABallThatMeetsTheFloorOffAWholeStepIsOfSecondOrder) {
  const double v = std::sqrt(0.611 * 0.611 + 2 * kG * 0.0731), sag = kG / 900;
  const double t = 0.12 - (v - 0.611) / kG;  // since the touch; it presses all along
  const double rate = 3, w = std::sqrt(900 - rate * rate), b = (v - rate * sag) / w;
  const double co = std::cos(w * t), si = std::sin(w * t), decay = std::exp(-rate * t);
  const double depth = sag + decay * (-sag * co + b * si);
  const double sinking = decay * ((rate * sag + b * w) * co + (w * sag - rate * b) * si);
  const Vec3 exact(depth, -sinking / 30, 0);
  expectSecondOrderOfABall(GetParam(), 0.12, &exact);
  expectSecondOrderOfABall(GetParam(), 0.44, nullptr);  // it has left and come again
}

/// Friction is at most mu times the spring's force: a ball slides to a stop over v^2 / (2 mu g).
TEST_P(CompliantContact, FrictionIsOfTheSpringsForce) {
  const double mu = 0.4, k = 2e4, v = 2;
  for (const double hz : {120, 480}) {
    BallOnASpring ball({k, 60, mu}, -kG / k, Vec3(v, 0, 0), 1 / hz, GetParam());
    for (int i = 0; i < hz; ++i) {
      ball.steps(1);
      for (const Touch& t : ball.contacts.take().touches) {
        const Vec3 f = t.contact.impulse;
        ASSERT_LT(std::hypot(f.x(), f.y()), mu * f.z() * (1 + 1e-6));
      }
    }
    EXPECT_NEAR(ball.state.x(0, 0), v * v / (2 * mu * kG), 1e-4) << hz << " Hz";
  }
}

/// Down a slope, on a spring and a damper that press all the way: mu times the normal impulse,
/// which is the change of the normal velocity less gravity's.
TEST_P(CompliantContact, ABallSlidesDownASpringFloorByTheFormula) {
  constexpr double kSlope = 50 * M_PI / 180, kMu = 0.3, kTime = 0.2, kBegin = 1;
  constexpr double kStiffness = 2500, kDamping = 10, kIn = -0.05;
  const double pull = kG * std::cos(kSlope), rest = -pull / kStiffness;
  const double a = kDamping / 2, w = std::sqrt(kStiffness - a * a);
  const double c = -rest, d = (kIn + a * c) / w, decay = std::exp(-a * kTime);
  const double gap = rest + decay * (c * std::cos(w * kTime) + d * std::sin(w * kTime));
  const double along = kBegin * kTime + kG * std::sin(kSlope) * kTime * kTime / 2 -
                       kMu * (gap - kIn * kTime + pull * kTime * kTime / 2);
  const auto error = [&](double step) {
    const Vec3 normal(std::sin(kSlope), 0, std::cos(kSlope)), down(normal.z(), 0, -normal.x());
    Scene scene = sceneOf(oneParticle(1, kBallRadius), kBallRadius * normal);
    scene.ragdolls[0].velocity = kIn * normal + kBegin * down;
    scene.gravity = Vec3(0, 0, -kG);
    ObstacleSpec plane = floorPlane(kMu);
    plane.normal = normal;
    plane.contact = {kStiffness, kDamping};
    scene.obstacles.push_back(plane);
    scene.solver.method = GetParam();
    scene.solver.step = step;
    World world(scene);
    world.steps(static_cast<int>(std::lround(kTime / step)));
    return (world.x(0) - (kBallRadius + gap) * normal - along * down).norm();
  };
  EXPECT_LT(error(1e-3), 5e-6);
  EXPECT_NEAR(std::log2(error(1e-3) / error(5e-4)), 2, 0.1);
}

/// A soft sphere met beside its middle turns the direction of the push on the way; against the
/// motion in the plane, integrated apart.
TEST_P(CompliantContact, ABallOffTheMiddleOfASoftSphereIsOfSecondOrder) {
  constexpr double kStiffness = 4000, kSphere = 0.3, kTime = 0.5;
  Eigen::Vector4d z(0.12, 1, 0, -3);  // x, z and velocities
  const auto rate = [](const Eigen::Vector4d& at) {
    const double far = at.head<2>().norm(), depth = std::max(0.0, kSphere + kBallRadius - far);
    Eigen::Vector4d out;
    out << at.tail<2>(), kStiffness * depth / far * at.head<2>();
    return out;
  };
  constexpr int kParts = 100000;
  const double h = kTime / kParts;
  for (int i = 0; i < kParts; ++i) {
    const Eigen::Vector4d k1 = rate(z), k2 = rate(z + h / 2 * k1), k3 = rate(z + h / 2 * k2),
                          k4 = rate(z + h * k3);
    z += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  const auto error = [&](double step) {
    Scene scene = sceneOf(oneParticle(1, kBallRadius), Vec3(0.12, 0, 1));
    scene.ragdolls[0].velocity = Vec3(0, 0, -3);
    scene.gravity.setZero();
    ObstacleSpec sphere;
    sphere.type = ObstacleSpec::Type::kSphere;
    sphere.radius = kSphere;
    sphere.friction = 0;
    sphere.contact = {kStiffness, 0};
    scene.obstacles.push_back(sphere);
    scene.solver.method = GetParam();
    scene.solver.step = step;
    World world(scene);
    world.steps(static_cast<int>(std::lround(kTime / step)));
    return std::hypot(world.x(0).x() - z[0], world.x(0).z() - z[1]);
  };
  EXPECT_LT(error(1e-3), 5e-4);
  EXPECT_LT(error(2.5e-4), 5e-5);
}

/// A stick that meets a soft capsule crosswise, off the middle of both, turns on it and leaves:
/// nothing takes its energy.
TEST_P(CompliantContact, AStickLeavesASoftCapsuleWithItsEnergy) {
  Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdolls:
  - position: [0.13, 0.07, 0.6]
    rpy_deg: [0, 20, 15]
    velocity: [0.2, 0.1, -2]
    model:
      particles: {a: {position: [-0.5, 0, 0], radius: 0.05}, b: {position: [0.5, 0, 0], radius: 0.05}}
      sticks: [[a, b]]
      segments: {ab: {from: a, to: b, mass: 3, gyration: 0.289}}
obstacles:
  - {type: capsule, from: [0, -1, 0.2], to: [0.1, 1, 0.25], radius: 0.1, friction: 0, stiffness: 6000}
)");
  scene.solver.method = GetParam();
  scene.solver.step = 1e-3;
  World world(scene);
  const double before = kineticEnergy(world.model, world.state);
  world.steps(500);
  EXPECT_GT(world.v(0).z() + world.v(1).z(), 0) << "it is thrown back";
  EXPECT_NEAR(kineticEnergy(world.model, world.state) / before, 1, 1e-5);
}

/// Sticks thrown at what is soft, as they come: where the deepest place passes from a stick onto
/// its end no spring is added to that which is there (40 % of the energy came of it), and energy is
/// that of all springs, not of those that a motion knew (up to 144 % at 120 Hz).
TEST(CompliantContactOfASmallBody, SticksThrownAtSoftThingsGainNothing) {
  const std::string things[] = {"type: capsule, from: [0, -1, -0.1], to: [0, 1, -0.1], radius: 0.1",
                                "type: sphere, position: [0, 0, -0.2], radius: 0.2",
                                "type: box, position: [0, 0, -0.2], size: [0.3, 3, 0.4]"};
  std::mt19937 random(1);
  const auto upTo = [&](double most) {
    return std::to_string(std::uniform_real_distribution<double>(-most, most)(random));
  };
  for (int i = 0; i < 90; ++i) {
    Scene scene =
        parseScene("gravity: [0, 0, 0]\nragdolls:\n  - contact: compliant\n    position: [" +
                   upTo(0.4) + ", " + upTo(0.2) + ", 0.45]\n    rpy_deg: [0, " + upTo(60) + ", " +
                   upTo(60) + "]\n    velocity: [" + upTo(0.5) + ", " + upTo(0.5) +
                   ", -2]\n    angular_velocity: [" + upTo(3) + ", " + upTo(3) + ", " + upTo(3) +
                   "]\n    model: {particles: {a: {position: [-0.2, 0, 0], radius: 0.05}, b: "
                   "{position: [0.2, 0, 0], "
                   "radius: 0.05}}, sticks: [[a, b]], segments: {ab: {from: a, to: b, mass: 1, "
                   "gyration: 0.289, contact: "
                   "{stiffness: 20000}}}}\nobstacles: [{" +
                   things[i % 3] + ", friction: 0, stiffness: 20000}]\n");
    for (const double hz : {120, 1000}) {
      scene.solver.method = Method::kShake;
      scene.solver.step = 1 / hz;
      World world(scene);
      const double before = kineticEnergy(world.model, world.state);
      world.steps(static_cast<int>(0.8 * hz));
      const double gain = kineticEnergy(world.model, world.state) / before - 1;
      EXPECT_LT(gain, 1e-9) << things[i % 3] << " " << i << " " << hz;
      if (hz > 500 && i % 3 < 2) {
        EXPECT_GT(gain, -1e-3) << things[i % 3] << " " << i;
      }
    }
  }
}

TEST(CompliantContactOfABody, SpringsAreInSeriesAndDampersLikewise) {
  const char* text =
      "ragdolls: [{contact: compliant, position: [0, 0, 0.1], model: {particles: {p: {position: "
      "[0, 0, 0], "
      "mass: 1, radius: 0.1}, q: {position: [0, 0, 1], mass: 1}}, sticks: [[q, p]], segments: "
      "{leg: "
      "{from: q, to: p, contact: {stiffness: 3000, damping: 90}}}}}]\n"
      "obstacles: [{type: plane, stiffness: 1500, damping: 45}]\n"
      "solver: {method: shake, step: 0.001, sleep: false}\n";
  World world(parseScene(text));
  world.steps(5000);
  EXPECT_NEAR(0.1 - world.x(0).z(), 2 * kG / 1000, 1e-6);
}

/// A bar of 2 kg that falls across a ball, at 2 m/s: [m] its height, and the peak force [N].
std::pair<double, double> fallAcrossABall(const std::string& region, const std::string& surface) {
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\nragdolls: [{contact: " +
      std::string(region.empty() ? "rigid" : "compliant") +
      ", position: [0, 0, 0.1537], velocity: [0, 0, -2], model: {particles: {a: {position: [-0.2, "
      "0, 0], radius: 0.1}, "
      "b: {position: [0.2, 0, 0], radius: 0.1}}, sticks: [[a, b]], segments: {bar: {from: a, to: "
      "b, mass: 2, "
      "gyration: 0.289" +
      (region.empty() ? "" : ", contact: {" + region + "}") +
      "}}}}]\nobstacles: [{type: sphere, position: [0, 0, -0.2], radius: 0.2, friction: 0" +
      (surface.empty() ? "" : ", " + surface) +
      "}]\nsolver: {method: shake, step: 0.001, sleep: false}\n");
  World world(scene);
  const double peak = peakForce(world);
  return {world.x(0).z(), peak};
}

/// 1/20000 = 1/30000 + 1/60000, 1/60 = 1/90 + 1/180. The peak of k y + d y' is 337.539 N.
TEST(CompliantContactOfABody, AnImpactOnTwoSpringsAndDampersIsThatOnTheirSeries) {
  const auto two =
      fallAcrossABall("stiffness: 60000, damping: 180", "stiffness: 30000, damping: 90");
  const auto one = fallAcrossABall("", "stiffness: 20000, damping: 60");
  EXPECT_NEAR(two.first, one.first, 1e-12);
  EXPECT_NEAR(two.second, one.second, 1e-6);
  EXPECT_NEAR(one.second / 337.5386, 1, 5e-4);
  const auto undamped = fallAcrossABall("stiffness: 60000, damping: 180", "stiffness: 30000");
  EXPECT_NEAR(undamped.second / (2 * std::sqrt(2 * 20000.0)), 1, 1e-9) << "one has no damper";
  const auto region = fallAcrossABall("stiffness: 20000, damping: 60", "");
  EXPECT_NEAR(region.first, one.first, 1e-12) << "on what is rigid";
}

/// [N] on the head of a human dropped flat from 30 cm, and the most that energy rose.
struct HumanDrop {
  double head = 0, rise = 0;
};

HumanDrop dropHuman(double hz, const std::string& floor, const std::string& rpy = "0, 88, 0") {
  Scene scene = parseScene(
      "ragdolls: [{model: human, contact: compliant, position: [0, 0, 0.55], rpy_deg: [" + rpy +
      "]}]\nobstacles: [{" + floor + "}]\n");
  scene.solver.method = Method::kShake;
  scene.solver.step = 1 / hz;
  scene.solver.sleep = false;
  World world(scene);
  Contacts contacts(world.model);
  world.workspace.keepContacts(&contacts.log());
  const auto energy = [&] {
    return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state) +
           springEnergy(world.model, world.state);
  };
  HumanDrop result;
  double lowest = energy();
  const double start = lowest;
  for (int i = 0; i < hz; ++i) {
    contacts.begin(world.state);
    world.steps(1);
    contacts.end(world.model, world.inputs, world.state);
    result.rise = std::max(result.rise, (energy() - lowest) / start);
    lowest = std::min(lowest, energy());
    for (const Touch& t : contacts.take().touches)
      if (regionName(world.model, 0, t.contact.particle) == "head")
        result.head = std::max(result.head, t.peak_force);
  }
  return result;
}

TEST(CompliantContactOfABody, ThePeakForceOnAHeadHardlyDependsOnTheStep) {
  for (const char* rpy : {"0, 88, 0", "90, 90, 0", "85, 88, 0", "70, 88, 20", "180, 88, 0"}) {
    const double fine = dropHuman(4000, "type: plane", rpy).head;
    EXPECT_GT(fine, 500);
    EXPECT_NEAR(dropHuman(240, "type: plane", rpy).head / fine, 1, 0.02) << rpy;
  }
}

TEST(CompliantContactOfABody, EnergyOfAFallNeverRises) {
  for (const char* floor : {"type: plane", "type: box, position: [0, 0, -1], size: [6, 6, 2]"})
    for (const double hz : {120, 1000}) EXPECT_LT(dropHuman(hz, floor).rise, 1e-4) << floor << hz;
}

TEST(CompliantContactOfABody, WhatIsWrongSaysWhatWouldBeRight) {
  const auto said = [](const std::string& text) {
    return errorOf([&] { buildModel(parseScene(text, "bad.yaml")); });
  };
  const std::string body = "ragdolls: [{model: human}]\nobstacles:\n  - {type: plane, ";
  EXPECT_THAT(said(body + "stiffness: -5}\n"),
              testing::HasSubstr("bad.yaml:3: obstacles[0].stiffness"));
  EXPECT_THAT(said(body + "stiffness: .inf}\n"), testing::HasSubstr("obstacles[0].stiffness"));
  EXPECT_THAT(said(body + "stiffness: .nan}\n"), testing::HasSubstr("obstacles[0].stiffness"));
  EXPECT_THAT(said(body + "stiffness: 1e-9}\n"), testing::HasSubstr("from 1 to 1e"));
  EXPECT_THAT(said(body + "stiffness: 5, damping: -1}\n"),
              testing::HasSubstr("obstacles[0].damping"));
  EXPECT_THAT(said(body + "damping: 3}\n"), testing::HasSubstr("together with 'stiffness'"));
  for (const char* out_of_range : {"-5", "0", "0.5", "1e13"})
    EXPECT_THAT(said(body + "stiffness: " + out_of_range + "}\n"),
                testing::HasSubstr("it must be from 1 to 1e+12 [N/m]; leave it out for rigid"));
  const auto region = [&](const std::string& contact) {
    return said(
        "ragdolls:\n  - model:\n      particles: {a: {position: [0, 0, 0], mass: 1}, b: {position: "
        "[0, 0, 1], mass: 1}}\n      sticks: [[a, b]]\n      segments: {rod: {from: a, to: b, "
        "contact: " +
        contact + "}}\n");
  };
  const std::string where = "bad.yaml:5: ragdolls[0].model.segments.rod.contact";
  EXPECT_EQ(region("{stiffness: 100, damping: 1}"), "");
  EXPECT_THAT(region("{stiffness: -5}"),
              testing::StartsWith(where + ".stiffness: stiffness is -5; it must"));
  EXPECT_THAT(region("{stiffness: .nan}"), testing::StartsWith(where + ".stiffness: is '.nan'"));
  EXPECT_THAT(region("{stiffness: 100, damping: -1}"),
              testing::StartsWith(where + ".damping: damping is -1; it must be from 0 to"));
  EXPECT_THAT(region("{damping: 3}"),
              testing::StartsWith(where + ": the key 'stiffness' is missing"));
  EXPECT_THAT(
      region("{stiffness: 100, dampin: 1}"),
      testing::StartsWith(where + ".dampin: unknown key; the keys here are stiffness, damping"));
  EXPECT_THAT(region("soft"), testing::StartsWith(where + ": is 'soft'; a mapping"));
  EXPECT_THAT(said("ragdolls: [{model: human, contact: soft}]\n"), testing::HasSubstr("compliant"));
  EXPECT_THAT(said("ragdolls: [{model: human_thesis, contact: compliant}]\n"),
              testing::HasSubstr("has a contact: {stiffness"));
}

}  // namespace
}  // namespace ragdoll::test
