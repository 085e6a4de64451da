// A stick over the edges of a soft box rests on a spring at each of its ends; where their force
// acts moves along it and never jumps (core/contact/stick_springs.h).
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/contacts.h"
#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

double energyOf(const World& world) {
  return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state) +
         springEnergy(world.model, world.state);
}

/// Of 1 kg, 0.4 m long, with radii of 5 cm; lumped: half of its mass in each end.
std::string barModel(const std::string& contact, bool lumped = false) {
  const std::string mass = lumped ? ", mass: 0.5" : "";
  return "model: {particles: {a: {position: [-0.2, 0, 0], radius: 0.05" + mass +
         "}, b: {position: [0.2, 0, 0], radius: 0.05" + mass +
         "}}, sticks: [[a, b]], segments: {ab: {from: a, to: b" +
         (lumped ? "" : ", mass: 1, gyration: 0.28867513459481287") + contact + "}}}";
}

struct Throw {
  int seed = 0;
  bool lumped = false;
  double friction = 0, hz = 120, stiffness = 20000;
};

Scene thrownBar(const Throw& t) {
  std::mt19937 random(t.seed);
  const auto upTo = [&](double most) {
    return std::to_string(std::uniform_real_distribution<double>(-most, most)(random));
  };
  std::string text = "gravity: [0, 0, 0]\nragdolls:\n  - contact: compliant\n    position: [";
  text += upTo(0.4) + ", ";
  text += upTo(0.2) + ", 0.45]\n    rpy_deg: [0, ";
  text += upTo(60) + ", ";
  text += upTo(60) + "]\n    velocity: [";
  text += upTo(0.5) + ", ";
  text += upTo(0.5) + ", -2]\n    angular_velocity: [";
  text += upTo(3) + ", ";
  text += upTo(3) + ", ";
  text += upTo(3) + "]\n    ";
  text += barModel(", contact: {stiffness: 1}", t.lumped);
  text +=
      "\nobstacles: [{type: box, position: [0, 0, -0.2], size: [0.3, 3, 0.4]}]\nsolver: {sleep: "
      "false}\n";
  Scene scene = parseScene(text);
  scene.ragdolls[0].compliant = false;
  scene.obstacles[0].contact = {0.5 * t.stiffness, 0};
  scene.obstacles[0].friction = t.friction;
  scene.solver.method = Method::kShake;
  scene.solver.step = 1 / t.hz;
  return scene;
}

/// Of the energy at the start, the most that a step gained, and what was lost in all.
struct Account {
  double rise = 0, loss = 0;
};

Account throwIt(const Throw& t) {
  World world(thrownBar(t));
  const double start = energyOf(world);
  double last = start;
  Account account;
  for (int i = 0; i < 0.8 * t.hz; ++i) {
    world.steps(1);
    account.rise = std::max(account.rise, (energyOf(world) - last) / start);
    last = energyOf(world);
  }
  account.loss = (start - last) / start;
  return account;
}

/// Where its deepest place jumped, a spring appeared at depth, or was lost with all that it held:
/// up to 60 % of the energy. A part of a step keeps what it gains by less than 1e-9 of it.
TEST(SoftBoxEdge, SticksThrownAtItNeverGainEnergy) {
  for (const double hz : {120.0, 1000.0})
    for (const double friction : {0.0, 0.5})
      for (const bool lumped : {false, true})
        for (const double stiffness : {1e3, 2e4, 1e6})
          for (int seed = 180; seed < 240; ++seed) {
            const Account account = throwIt({seed, lumped, friction, hz, stiffness});
            ASSERT_LT(account.rise, 2e-9) << seed << " " << lumped << friction << hz << stiffness;
          }
}

TEST(SoftBoxEdge, SticksThrownAtItWithoutFrictionKeepTheirEnergy) {
  for (int seed = 180; seed < 300; ++seed)
    for (const bool lumped : {false, true})
      EXPECT_LT(throwIt({seed, lumped, 0, 4000, 20000}).loss, 0.005) << seed << lumped;
}

Scene barOnTheBox(double x, double width, double damping) {
  Scene scene = parseScene(
      "ragdolls: [{position: [" + std::to_string(x) + ", 0, 0.05], " + barModel("") +
      "}]\nobstacles: [{type: box, position: [0, 0, -0.2], size: [" + std::to_string(width) +
      ", 3, 0.4], friction: 0.5, stiffness: 20000}]\nsolver: {sleep: false}\n");
  scene.gravity = Vec3(0, 0, -kG);
  scene.obstacles[0].contact.damping = damping;
  scene.solver.method = Method::kShake;
  scene.solver.step = 1e-3;
  return scene;
}

/// Both of its springs carry it, whether all of it lies on the face, one end or none.
TEST(SoftBoxEdge, AStickRestsOnBothItsSprings) {
  for (const double x : {0.0, 0.4})
    for (const double width : {0.1, 1.0}) {
      if (width < 1 && x > 0) continue;
      World world(barOnTheBox(x, width, 200));
      Contacts contacts(world.model);
      world.workspace.keepContacts(&contacts.log());
      double force = 0, along = 0;
      for (int i = 0; i < 3000; ++i) {
        contacts.begin(world.state);
        world.steps(1);
        contacts.end(world.model, world.inputs, world.state);
        force = along = 0;
        for (const Touch& t : contacts.take().touches) {
          force += t.contact.impulse.z() / 1e-3;
          along += t.contact.impulse.z() / 1e-3 * t.contact.point.x();
        }
      }
      EXPECT_NEAR(force, kG, 1e-6) << x << " " << width;
      EXPECT_NEAR(along / force, x, 1e-6) << "where it is carried";
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(0.05 - world.x(i).z(), kG / (2 * 20000), 1e-8) << x << " " << width;
    }
}

/// Shake against rk from event to event, both with the same springs.
double errorOfShake(Scene scene, double until, double hz, const Points& exact) {
  scene.solver.method = Method::kShake;
  scene.solver.step = 1 / hz;
  World world(scene);
  world.steps(static_cast<int>(std::lround(until * hz)));
  return (world.state.x - exact).cwiseAbs().maxCoeff();
}

TEST(SoftBoxEdge, ABarThatTipsOverItIsOfSecondOrder) {
  Scene scene = barOnTheBox(0.52, 1, 0);
  scene.obstacles[0].friction = 0;
  const double until = 0.4;
  Scene exact = scene;
  exact.solver.method = Method::kRk;
  exact.solver.events = true;
  exact.solver.step = 1e-3;
  World world(exact);
  int handed_over = 0;
  for (int i = 0; i < std::lround(until / 1e-3); ++i) handed_over += world.steps(1).handed_over;
  EXPECT_EQ(handed_over, 0);
  EXPECT_LT(world.x(1).z(), 0) << "it has tipped";
  const double coarse = errorOfShake(scene, until, 250, world.state.x);
  const double fine = errorOfShake(scene, until, 16000, world.state.x);
  EXPECT_GT(std::log2(coarse / fine) / 6, 1.9);
  EXPECT_LT(fine, 2e-6);
}

}  // namespace
}  // namespace ragdoll::test
