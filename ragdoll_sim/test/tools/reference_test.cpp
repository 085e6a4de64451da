// The reference and the measured errors on motions whose answer is known.
#include "reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "measurement.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/error_of.h"
#include "support/worlds.h"
#include "survey.h"

namespace ragdoll::lab {
namespace {

using test::errorOf;
using ::testing::HasSubstr;

constexpr double kG = 9.81;
const auto kQuiet = [](double) {};

Configuration jakobsen(Integrator integrator, double step) {
  Configuration c{"", false, preset("thesis")};
  c.solver.integrator = integrator;
  c.solver.step = step;
  return c;
}

TEST(FreeFall, ErrorAndEnergyDriftAreTheIntegratorsOwn) {
  const double mass = 2, T = 1;
  const Model model = buildModel(test::sceneOf(test::oneParticle(mass)));
  const Reference reference = makeReference(model, T, T, kQuiet);
  EXPECT_NEAR(reference.windows.at(0).end(2, 0), -kG * T * T / 2, 1e-10);
  for (const double h : {1.0 / 60, 1.0 / 480}) {
    // Fallen in n steps: g h^2 n (n + 1) / 2 or g h^2 n (n - 1) / 2, that is g h T / 2 off.
    const double off = kG * h * T / 2;
    const auto measured = [&](Integrator integrator) {
      return measureAccuracy(model, jakobsen(integrator, h), reference, T);
    };
    EXPECT_NEAR(measured(Integrator::kVerlet).error, off, 1e-9);
    EXPECT_NEAR(measured(Integrator::kSymplecticEuler).error, off, 1e-9);
    EXPECT_NEAR(measured(Integrator::kEuler).error, off, 1e-9);
    EXPECT_NEAR(measured(Integrator::kMidpoint).error, 0, 1e-9);
    EXPECT_NEAR(measured(Integrator::kVelocityVerlet).error, 0, 1e-9);
    // The speed is right, the height is not.
    EXPECT_NEAR(measured(Integrator::kVerlet).energy_drift, -mass * kG * off, 1e-7);
    EXPECT_NEAR(measured(Integrator::kEuler).energy_drift, mass * kG * off, 1e-7);
    EXPECT_NEAR(measured(Integrator::kEuler).energy_rise, mass * kG * off, 1e-7);
  }
}

TEST(FreeFall, WindowsStartFromTheReference) {
  const Model model = buildModel(test::sceneOf(test::oneParticle()));
  const Reference reference = makeReference(model, 1, 0.1, kQuiet);
  ASSERT_EQ(reference.windows.size(), 10u);
  for (int k = 0; k < 10; ++k) {
    EXPECT_NEAR(reference.windows[k].start.time, 0.1 * k, 1e-12);
    EXPECT_NEAR(reference.windows[k].start.x(2, 0), -kG * 0.005 * k * k, 1e-9);
  }
  // In each window alone verlet falls g h W / 2 too far.
  const double h = 1.0 / 60;
  EXPECT_NEAR(measureAccuracy(model, jakobsen(Integrator::kVerlet, h), reference, 1).error,
              kG * h * 0.1 / 2, 1e-9);
}

TEST(Pendulum, ReferenceIsAsRightAsItSays) {
  Scene scene = test::sceneOf(test::oneStick());
  scene.pins.push_back({"a", "", "pins"});
  const Model model = buildModel(scene);
  const Reference reference = makeReference(model, 1, 1, kQuiet);
  // Its equation phi'' = -g cos(phi), phi down from the horizontal counted negative, by RK4.
  double phi = 0, w = 0;
  const double h = 1e-4;
  const auto f = [](double angle) { return -kG * std::cos(angle); };
  for (int i = 0; i < 10000; ++i) {
    const double k1 = f(phi), k2 = f(phi + h / 2 * w), k3 = f(phi + h / 2 * (w + h / 2 * k1)),
                 k4 = f(phi + h * (w + h / 2 * k2));
    phi += h * (w + h / 6 * (k1 + k2 + k3));
    w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  const Vec3 truth(std::cos(phi), 0, std::sin(phi));
  const double off = (reference.windows[0].end.col(1) - truth).norm() / std::sqrt(2.0);
  EXPECT_LE(reference.uncertainty, 1e-7);
  EXPECT_LE(off, reference.uncertainty + 1e-10);
}

TEST(Sliding, ReferenceStopsWhereCoulombSays) {
  Scene scene = test::sceneOf(test::oneParticle(1, 0.1), Vec3(0, 0, 0.1));
  scene.ragdolls[0].velocity = Vec3(2, 0, 0);
  scene.obstacles.push_back(test::floorPlane(0.5));
  const Model model = buildModel(scene);
  const Reference reference = makeReference(model, 1, 0.1, kQuiet);
  const double stop = 2 * 2 / (2 * 0.5 * kG);
  EXPECT_NEAR(reference.windows.back().end(0, 0), stop, 1e-4);
  EXPECT_LT(reference.uncertainty, 1e-5);
  EXPECT_TRUE(hasContact(model));
}

/// A grain falls onto the edge of a smooth box: exactly onto it, and it lies there; beside it by
/// any way, and it slides off.
TEST(Edge, AWindowThatForksIsNamedWithItsTimeAndCountsInNoMean) {
  for (const double x : {0.0, 0.1}) {
    Scene scene = test::sceneOf(test::oneParticle(1, 2e-8), Vec3(x, 0, 0.05));
    scene.ragdolls[0].velocity = Vec3(0, 0, -1);
    ObstacleSpec box;
    box.type = ObstacleSpec::Type::kBox;
    box.pose.position = Vec3(0.5, 0, -0.5);
    box.friction = 0;
    scene.obstacles.push_back(box);
    const Reference reference = makeReference(buildModel(scene), 0.1, 0.05, kQuiet);
    const Window& window = reference.windows.at(0);
    EXPECT_EQ(window.forks, x == 0);
    EXPECT_EQ(reference.forks, x == 0 ? 2 : 0);
    if (x == 0) {
      const double falls = (std::sqrt(1 + 2 * kG * 0.05) - 1) / kG;
      EXPECT_NEAR(window.fork_time, falls, 1e-3);
    }
  }
}

TEST(Edge, MeansAreOfTheWindowsThatDoNotForkUnlessAllDo) {
  Reference reference;
  reference.windows.resize(3);
  EXPECT_EQ(countOf(reference), 3);
  reference.windows[1].forks = true;
  reference.forks = 1;
  EXPECT_EQ(countOf(reference), 2);
  EXPECT_FALSE(counts(reference, reference.windows[1]));
  EXPECT_TRUE(counts(reference, reference.windows[2]));
  for (Window& window : reference.windows) window.forks = true;
  reference.forks = 3;
  EXPECT_EQ(countOf(reference), 3);
  EXPECT_TRUE(counts(reference, reference.windows[1]));
}

/// [m] fall 2 nm in the mean and 2e-8 in the worst window, the others 1e-10.
TEST(ShippedScenes, HaveASureReference) {
  for (const char* name : {"fall", "stairs", "between_objects"}) {
    const Reference reference = makeReference(buildModel(loadScene(name)), 1, 0.1, kQuiet);
    EXPECT_LT(reference.uncertainty, 1e-8) << name;
    EXPECT_LT(reference.worst, 1e-7) << name;
    EXPECT_EQ(reference.forks, 0) << name;
  }
}

TEST(Survey, HorizonAndWindowFitTheStepsOrAreRefused) {
  const Model smooth = buildModel(test::sceneOf(test::oneParticle()));
  EXPECT_EQ(completed(smooth, {}).horizon, 1);
  EXPECT_EQ(completed(smooth, {}).window, 1);
  Scene scene = test::sceneOf(test::oneParticle());
  scene.obstacles.push_back(test::floorPlane());
  const Model contact = buildModel(scene);
  EXPECT_EQ(completed(contact, {}).horizon, 2);
  EXPECT_EQ(completed(contact, {}).window, 0.1);
  SurveyOptions bad;
  bad.horizon = 1;
  bad.window = 0.3;
  EXPECT_THAT(errorOf([&] { completed(contact, bad); }), HasSubstr("--window"));
  bad.window = 0;
  bad.horizon = 0.99;
  EXPECT_THAT(errorOf([&] { completed(smooth, bad); }), HasSubstr("--horizon"));
}

TEST(Cost, ThesisIsAsDearAsItself) {
  const Model model = buildModel(test::sceneOf(test::oneStick()));
  Measurement m;
  m.configuration = {"thesis", true, preset("thesis")};
  measureCost(model, 1, m);
  EXPECT_GT(m.cost, 0);
  EXPECT_NEAR(m.ratio, 1, 0.3);
  // Ten times the steps cost about ten times as much.
  m.configuration.solver.step /= 10;
  measureCost(model, 1, m);
  EXPECT_NEAR(m.ratio, 10, 4);
}

}  // namespace
}  // namespace ragdoll::lab
