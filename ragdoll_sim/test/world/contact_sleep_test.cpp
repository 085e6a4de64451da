// What is told of who lies still: awake, asleep, alone and in piles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "contact_scenes.h"
#include "ragdoll_sim/core/findings.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll {
namespace {

/// Every step's force of contacts on every body against its weight, over so many steps.
void expectWeights(World& world, int steps, const std::string& what) {
  world.keepContacts(true);
  for (int i = 0; i < steps; ++i) {
    world.advance();
    const ContactReport report = *world.takeContacts();
    for (int body = 0; body < static_cast<int>(world.model()->ragdolls.size()); ++body) {
      const double weight = massOf(*world.model(), body) * kG;
      const Vec3 force = impulseOn(body, report.touches) / report.interval;
      EXPECT_LT((force - Vec3(0, 0, weight)).norm(), 1e-6 * weight) << what << " body " << body;
    }
    EXPECT_GT(report.touches.size(), 2u) << what;
    for (const Touch& touch : report.touches)
      EXPECT_GT(touch.contact.impulse.dot(touch.contact.normal), 0) << what;
  }
}

TEST(Contacts, CarryTheWeightAtRest) {
  for (const char* method : {"shake", "rk"})
    for (const char* sleep : {"true", "false"}) {
      Scene scene = loadScene("fall");
      applySetting(scene, "solver.method", method);
      applySetting(scene, "solver.sleep", sleep);
      World world(scene);
      for (int i = 0; i < 1500; ++i) world.advance();
      EXPECT_EQ(world.state().asleep[0] != 0, std::string(sleep) == "true");
      expectWeights(world, 20, std::string(method) + ", sleep " + sleep);
    }
}

/// [N s] What a report has of the same contact; nothing if it does not press there.
Vec3 impulseOf(const ContactImpulse& contact, const ContactReport& report) {
  for (const Touch& touch : report.touches)
    if (touch.contact.particle == contact.particle && touch.contact.obstacle == contact.obstacle)
      return touch.contact.impulse;
  return Vec3::Zero();
}

TEST(Contacts, OfASleeperAreWhatTheyWereWhenItFellAsleep) {
  // Half of each was told, and what was missing of the weight shared out: feet on edges were told
  // to press beyond friction's cone.
  for (const char* scene : {"stairs", "fall"})
    for (const char* method : {"shake", "rk"}) {
      Scene at = loadScene(scene);
      applySetting(at, "solver.method", method);
      World world(at);
      world.keepContacts(true);
      ContactReport last, awake, asleep;
      while (world.state().time < 20 && !world.state().asleep[0]) {
        world.advance();
        last = awake;
        awake = *world.takeContacts();
      }
      ASSERT_TRUE(world.state().asleep[0]);
      world.advance();
      asleep = *world.takeContacts();
      EXPECT_GE(awake.touches.size(), 10u);
      std::vector<Touch> all = awake.touches;
      all.insert(all.end(), asleep.touches.begin(), asleep.touches.end());
      for (const Touch& touch : all) {
        const ContactImpulse& c = touch.contact;
        const Vec3 before = impulseOf(c, awake);
        // But for what one more step would have changed, and, of shake, for what damps the last
        // motion within, which the second half of a step alone carries.
        const double changes = (before - impulseOf(c, last)).norm(),
                     damps = at.solver.method == Method::kShake ? 0.2 : 0.02;
        EXPECT_LT((impulseOf(c, asleep) - before).norm(), 1.1 * changes + damps * awake.interval)
            << scene << method << c.particle[0];
      }
    }
}

TEST(Contacts, OfSleepersAreTheSameForWhoBeginsToListen) {
  for (const char* method : {"shake", "fast", "jakobsen"}) {
    Scene scene = loadScene("fall");
    applySetting(scene, "solver.method", method);
    World all_along(scene), anew(scene);
    all_along.keepContacts(true);
    const auto expectSame = [&] {
      anew.keepContacts(true);
      all_along.advance();
      anew.advance();
      const ContactReport a = *all_along.takeContacts(), b = *anew.takeContacts();
      ASSERT_EQ(a.touches.size(), b.touches.size()) << method << a.step;
      for (std::size_t i = 0; i < a.touches.size(); ++i) {
        const ContactImpulse &x = a.touches[i].contact, &y = b.touches[i].contact;
        ASSERT_EQ(x.particle, y.particle) << method << a.step;
        ASSERT_EQ(x.impulse, y.impulse) << method << a.step;
        ASSERT_EQ(x.point, y.point) << method << a.step;
      }
      ASSERT_EQ(a.on_obstacles, b.on_obstacles) << method << a.step;
    };
    const auto sleep = [&] {
      while (all_along.state().time < 40 && !all_along.state().asleep[0])
        ASSERT_NO_FATAL_FAILURE(expectSame());
      ASSERT_TRUE(all_along.state().asleep[0]) << method;
      for (int i = 0; i < 5; ++i) ASSERT_NO_FATAL_FAILURE(expectSame());
    };
    ASSERT_NO_FATAL_FAILURE(sleep());
    Poke poke;
    poke.body_name = "torso";
    poke.body = findBody(*all_along.model(), poke.body_name);
    poke.force = Vec3(0, 0, 600);
    poke.duration = 0.2;
    for (World* world : {&all_along, &anew}) world->addPoke(poke);
    ASSERT_NO_FATAL_FAILURE(expectSame());
    ASSERT_FALSE(all_along.state().asleep[0]) << method;
    ASSERT_NO_FATAL_FAILURE(sleep());
  }
}

TEST(Contacts, OfAPileOfPeopleCarryEachOfThem) {
  for (const char* sleep : {"true", "false"}) {
    Scene scene = parseScene(R"(
ragdolls:
  - {name: al, model: human, position: [0, 0, 0.13], rpy_deg: [0, -90, 0]}
  - {name: ben, model: human, position: [-0.3, 0.1, 0.42], rpy_deg: [0, -90, 90]}
obstacles: [{type: plane, friction: 0.6}]
ragdoll_collision: true
solver: {joint_damping: 2}
)");
    applySetting(scene, "solver.sleep", sleep);
    World world(scene);
    // Awake, their limbs still settle after 5 s: the weight is then carried to 1e-4, after 16 s to
    // 1e-7.
    for (int i = 0; i < 1920; ++i) world.advance();
    EXPECT_EQ(world.state().asleep[1] != 0, std::string(sleep) == "true");
    expectWeights(world, 20, std::string("sleep ") + sleep);
    world.advance();
    double between = 0;  // [N] upwards, by al on ben
    const auto report = world.takeContacts();
    for (const Touch& touch : report->touches) {
      const ContactImpulse& c = touch.contact;
      if (c.obstacle < 0 && c.other >= 0 && c.other != c.ragdoll)
        between += (c.ragdoll == 1 ? 1 : -1) * c.impulse.z() / world.stepLength();
    }
    EXPECT_GT(between, 500) << "ben does not lie on al";
  }
}

TEST(Contacts, OfAPileCarryWhatIsAbove) {
  for (const char* sleep : {"true", "false"}) {
    World world(
        parseScene(balls("0.1 0.3 0.5", 2,
                         "obstacles: [{type: plane, name: floor}]\nragdoll_collision: true\n"
                         "solver: {sleep: " +
                             std::string(sleep) + "}\n")));
    world.keepContacts(true);
    for (int i = 0; i < 600; ++i) world.advance();
    world.takeContacts();
    for (int i = 0; i < 12; ++i) world.advance();
    const ContactReport report = *world.takeContacts();
    ASSERT_EQ(report.touches.size(), 3u) << sleep;
    for (const Touch& touch : report.touches) {
      const ContactImpulse& c = touch.contact;
      const double above = c.obstacle >= 0 ? 3 : 3 - std::max(c.ragdoll, c.other);
      EXPECT_NEAR(std::abs(c.impulse.z()) / report.interval, above * 2 * kG, 1e-6 * 2 * kG)
          << sleep;
    }
    EXPECT_EQ(otherName(*world.model(), report.touches[1].contact), "floor");
  }
}

/// A plank on two bars that lie, its centre nearer to one: by the law of the lever, asleep, too,
/// where no state has what they give each other. The floor below kept 5e-5 of it to itself.
TEST(Contacts, OfAPlankOnTwoBarsFollowTheLever) {
  const auto rod = [](const std::string& name, const std::string& a, const std::string& b,
                      double height, double com) {
    return "  - name: " + name + "\n    position: [0, 0, " + std::to_string(height) +
           "]\n    model:\n      particles: {a: {position: " + a +
           ", radius: 0.05}, b: {position: " + b +
           ", radius: 0.05}}\n      sticks: [[a, b]]\n      segments: {rod: {from: a, to: b, mass: "
           "3, com: " +
           std::to_string(com) + ", gyration: 0.28}}\n";
  };
  const std::string text = "ragdolls:\n" + rod("plank", "[0, 0, 0]", "[1, 0, 0]", 0.15, 0.3) +
                           rod("near", "[0.1, -0.4, 0]", "[0.1, 0.4, 0]", 0.05, 0.5) +
                           rod("far", "[0.9, -0.4, 0]", "[0.9, 0.4, 0]", 0.05, 0.5) +
                           "obstacles: [{type: plane}]\nragdoll_collision: true\n";
  for (const char* method : {"shake", "rk"})
    for (const char* sleep : {"false", "true"}) {
      Scene scene = parseScene(text);
      applySetting(scene, "solver.method", method);
      applySetting(scene, "solver.sleep", sleep);
      World world(scene);
      world.keepContacts(true);
      while (world.state().time < 1.5) world.advance();
      EXPECT_EQ(world.state().asleep[0] != 0, std::string(sleep) == "true");
      world.takeContacts();
      world.advance();
      double on[] = {0, 0, 0};  // [N] of the plank on each
      const auto report = world.takeContacts();
      for (const Touch& touch : report->touches) {
        const ContactImpulse& c = touch.contact;
        if (c.obstacle < 0)
          on[c.ragdoll == 0 ? c.other : c.ragdoll] += c.impulse.norm() / report->interval;
      }
      EXPECT_NEAR(on[1], 3 * kG * (0.9 - 0.3) / 0.8, 1e-6) << method << sleep;
      EXPECT_NEAR(on[2], 3 * kG * (0.3 - 0.1) / 0.8, 1e-6) << method << sleep;
    }
}

TEST(Contacts, AreTheSameWhenOneBeginsToListenLater) {
  Scene scene = loadScene("fall");
  World early(scene), late(scene);
  early.keepContacts(true);
  for (int i = 0; i < 1500; ++i) {
    early.advance();
    late.advance();
  }
  ASSERT_TRUE(early.state().asleep[0]);
  late.keepContacts(true);
  early.takeContacts();
  for (int i = 0; i < 6; ++i) {
    early.advance();
    late.advance();
  }
  const ContactReport a = *early.takeContacts(), b = *late.takeContacts();
  ASSERT_EQ(a.touches.size(), b.touches.size());
  for (std::size_t i = 0; i < a.touches.size(); ++i)
    EXPECT_EQ(a.touches[i].contact.impulse, b.touches[i].contact.impulse);
}

}  // namespace
}  // namespace ragdoll
