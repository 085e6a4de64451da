// What comes into a world at the wrong moment.
#include "ragdoll_sim/world/world.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>

#include "pokes.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"

namespace {

using ragdoll::Error;
using ragdoll::Event;
using ragdoll::Vec3;
using ragdoll::World;
using ragdoll::test::kStep;
using ragdoll::test::particles;

constexpr std::size_t kMostPokes = 100000;  ///< docs/ros_api.md

/// A push of one step along x, at its recorded step.
Event push(const World& world, std::uint64_t step, double force) {
  Event event;
  event.step = step;
  event.poke = ragdoll::test::pokeOf(world, 0, 0, force);
  return event;
}

TEST(World, settingsForASceneThatIsGoneAreRefused) {
  World world(particles(20));
  const auto before = world.scene();
  const auto scene = std::make_shared<ragdoll::Scene>(*before);
  scene->gravity.z() = -1;
  const auto model = std::make_shared<ragdoll::Model>(buildModel(*scene));
  World other(particles(1));
  const auto loaded = other.scene();
  world.replaceBy(other);
  EXPECT_THROW(world.configure(before, scene, model), Error);
  EXPECT_EQ(world.scene(), loaded);
  EXPECT_EQ(world.model()->ragdolls.size(), 1u);
  EXPECT_EQ(world.model()->gravity.z(), 0);

  other.configure(before, scene, model);  // the one that they were made for
  EXPECT_EQ(other.model()->gravity.z(), -1);
}

TEST(World, aReplayMayHaveMorePokesThanANodeAccepts) {
  World world(particles(1));
  for (std::size_t i = 0; i < kMostPokes; ++i) world.replay(push(world, 3, 0.001));
  EXPECT_THROW(world.replay(push(world, 3, 0.001)), Error);
  world.setMaxPokes(std::numeric_limits<std::size_t>::max());
  world.replay(push(world, 3, 0.001));
  for (int i = 0; i < 4; ++i) world.advance();
  const double impulse = 0.001 * static_cast<double>(kMostPokes + 1) * kStep;  // F t = m v
  EXPECT_NEAR(world.state().v(0, 0), impulse, 1e-9 * impulse);
}

TEST(World, aStreamGoesOnWhenASettingChanges) {
  World world(particles(1));
  const Event one = push(world, 0, 2.0);
  world.stream("wrench", {one.poke}, 1);
  for (int i = 0; i < 5; ++i) world.advance();
  const auto scene = std::make_shared<ragdoll::Scene>(*world.scene());
  scene->gravity.z() = -1;
  world.configure(world.scene(), scene,
                  std::make_shared<ragdoll::Model>(ragdoll::buildModel(*scene)));
  for (int i = 0; i < 20; ++i) world.advance();
  EXPECT_NEAR(world.state().v(0, 0), 2.0 * 25 * kStep, 1e-12);  // 2 N on 1 kg
  world.stream("wrench", {}, 1);
  const std::vector<Event> told = world.takeEvents();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].step, 0u);
  EXPECT_NEAR(told[0].poke.duration, 5 * kStep, 1e-12);
  EXPECT_EQ(told[1].step, 5u);
  EXPECT_NEAR(told[1].poke.duration, 20 * kStep, 1e-12);
}

TEST(World, aSettingOrAnotherHoldWakesWhatSleeps) {
  ragdoll::Scene scene = particles(1);
  scene.solver.sleep = true;
  World world(scene);
  const auto sleeps = [&world] { return world.state().asleep[0] != 0; };
  const auto rest = [&] {
    for (int i = 0; i < 3000 && !sleeps(); ++i) world.advance();
    return sleeps();
  };
  ASSERT_TRUE(rest());
  world.attach("ragdoll/p", "robot/gripper");
  EXPECT_FALSE(sleeps());
  ASSERT_TRUE(rest());
  world.detach("ragdoll/p");
  EXPECT_FALSE(sleeps());
  ASSERT_TRUE(rest());
  const auto before = world.scene();
  const auto heavy = std::make_shared<ragdoll::Scene>(*before);
  heavy->gravity.z() = -1;
  world.configure(before, heavy, std::make_shared<ragdoll::Model>(buildModel(*heavy)));
  EXPECT_FALSE(sleeps());
  world.advance();
  EXPECT_NEAR(world.state().v(2, 0), -kStep, 1e-12);
}

/// A poke ends and one begins in each step; others come later.
TEST(World, takesEachPokeInItsStepHoweverManyAreToCome) {
  constexpr std::uint64_t kSteps = 500;
  World world(particles(1));
  for (std::uint64_t i = 0; i < kMostPokes; ++i) world.replay(push(world, i, 0.001));
  for (std::uint64_t i = 0; i < kSteps; ++i) world.advance();
  const double speed = 0.001 * static_cast<double>(kSteps) * kStep;  // F t = m v
  EXPECT_NEAR(world.state().v(0, 0), speed, 1e-9 * speed);
  // And the last one, which is looked at in a step.
  EXPECT_EQ(world.clearPokes(), kMostPokes - kSteps + 1);
}

}  // namespace
