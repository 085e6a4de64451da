// Pokes, streams and pulls of one particle of 1 kg without weight, whose speed tells the impulse.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pokes.h"
#include "support/error_of.h"

namespace {

using ragdoll::Event;
using ragdoll::Poke;
using ragdoll::Vec3;
using ragdoll::World;
using ragdoll::test::advance;
using ragdoll::test::errorOf;
using ragdoll::test::kStep;
using ragdoll::test::particles;
using ragdoll::test::pokeOf;

constexpr double kRounding = 1e-12;  ///< [m/s]

double speedOf(const World& world) { return world.state().v(0, 0); }

TEST(Pokes, AreRoundedToWholeSteps) {
  World world(particles(1));
  EXPECT_EQ(world.addPoke(pokeOf(world, 2.4 * kStep, 3.4 * kStep, 1)), 2u);
  EXPECT_EQ(world.addPoke(pokeOf(world, 7.6 * kStep, 0.1 * kStep, 10)), 8u);  // at least one
  const std::vector<Event> told = world.takeEvents();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NEAR(told[0].poke.start, 2 * kStep, kRounding);
  EXPECT_NEAR(told[0].poke.duration, 3 * kStep, kRounding);
  EXPECT_NEAR(told[1].poke.duration, kStep, kRounding);
  const double after[] = {0, 0, 0, 1, 2, 3, 3, 3, 3, 13, 13};  // [N] times steps
  for (int i = 0; i <= 10; ++i) {
    EXPECT_NEAR(speedOf(world), after[i] * kStep, kRounding) << i;
    world.advance();
  }
}

TEST(Pokes, OfThePastBeginNow) {
  World world(particles(1));
  advance(world, 5);
  EXPECT_EQ(world.addPoke(pokeOf(world, 0, kStep, 1)), 5u);
  EXPECT_NEAR(world.takeEvents().at(0).poke.start, 5 * kStep, kRounding);
  advance(world, 3);
  EXPECT_NEAR(speedOf(world), kStep, kRounding);
}

TEST(Pokes, AreClearedWhetherTheyActOrAreToCome) {
  World world(particles(1));
  world.addPoke(pokeOf(world, 0, -1, 1));  // for ever
  world.addPoke(pokeOf(world, 0.5, kStep, 1));
  advance(world, 4);
  EXPECT_EQ(world.clearPokes(), 2u);
  advance(world, 600);
  EXPECT_NEAR(speedOf(world), 4 * kStep, kRounding);
  const std::vector<Event> told = world.takeEvents();
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(told[2].step, 4u);
  EXPECT_TRUE(told[2].poke.body_name.empty());  // all end
}

TEST(Pokes, AreToldOnceAsTheyAct) {
  World world(particles(1));
  world.addPoke(pokeOf(world, 2 * kStep, 3 * kStep, 1));
  advance(world, 2);
  EXPECT_TRUE(world.takeActed().empty());
  advance(world, 2);
  ASSERT_EQ(world.takeActed().size(), 1u);
  advance(world, 1);  // still does
  EXPECT_EQ(world.takeActed().size(), 1u);
  advance(world, 5);
  EXPECT_TRUE(world.takeActed().empty());
}

TEST(Replay, AClearingEndsWhatWasAcceptedBeforeIt) {
  World world(particles(1));
  Event early{0, pokeOf(world, 0, -1, 1), 0}, clearing, late{3, pokeOf(world, 0, -1, 10), 0};
  clearing.step = 6;
  world.replay(early);
  world.replay(clearing);
  world.replay(late);  // accepted after it, so it stays, though it begins earlier
  advance(world, 8);
  EXPECT_NEAR(speedOf(world), (6 * 1 + 5 * 10) * kStep, kRounding);
}

TEST(Replay, RefusesThePastAndWhatNoClockTells) {
  World world(particles(1));
  advance(world, 3);
  const auto at = [&](std::uint64_t step) {
    return errorOf([&] { world.replay(Event{step, pokeOf(world, 0, 0, 1), 0}); });
  };
  EXPECT_NE(at(2).find("step 2 is past; this is step 3"), std::string::npos) << at(2);
  EXPECT_NE(at(3 + 2'000'000'000'000'000u).find("too far ahead"), std::string::npos);
  EXPECT_EQ(at(3), "");
  EXPECT_EQ(world.takeEvents().size(), 1u);  // what was refused is not told
}

TEST(Pokes, WhoseForceNoBodyBearsAreRefused) {
  World world(particles(1));
  const Poke bad = pokeOf(world, 0, 0, 1e300);
  EXPECT_NE(errorOf([&] { world.addPoke(bad); }), "");
  EXPECT_NE(errorOf([&] { world.stream("wrench", {bad}, 1); }), "");
  EXPECT_TRUE(world.takeEvents().empty());
  EXPECT_EQ(world.clearPokes(), 0u);
}

TEST(Streams, ReplaceWhatTheSameSourceGave) {
  World world(particles(1));
  world.stream("a", {pokeOf(world, 0, 0, 1)}, 1);
  world.stream("b", {pokeOf(world, 0, 0, 100)}, 1);
  advance(world, 3);
  world.stream("a", {pokeOf(world, 0, 0, 10)}, 1);
  advance(world, 2);
  EXPECT_NEAR(speedOf(world), (3 * 1 + 2 * 10 + 5 * 100) * kStep, kRounding);
  const std::vector<Event> told = world.takeEvents();  // the others are not over
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].step, 0u);
  EXPECT_NEAR(told[0].poke.duration, 3 * kStep, kRounding);
}

TEST(Streams, EndAfterTheirTime) {
  World world(particles(1));
  world.stream("a", {pokeOf(world, 0, 0, 1)}, 4.4 * kStep);
  EXPECT_EQ(world.mark().told, 0u);
  advance(world, 10);
  EXPECT_NEAR(speedOf(world), 4 * kStep, kRounding);
  EXPECT_NEAR(world.takeEvents().at(0).poke.duration, 4 * kStep, kRounding);
  EXPECT_EQ(world.mark().told, 10u);  // nothing is left to be told
  world.stream("a", {pokeOf(world, 0, 0, 1)}, 1);
  world.stream("a", {}, 1);  // replaced before it acted
  EXPECT_TRUE(world.takeEvents().empty());
}

TEST(Pulls, BringAParticleToTheTargetAsTheyAreTold) {
  World world(particles(2)), again(particles(2));
  EXPECT_NE(errorOf([&] { world.pull("ragdoll/q", Vec3::Zero()); }), "");
  world.pull("ragdoll/p", Vec3(0, 0, 3));
  world.pull("ragdoll/p", Vec3(0.2, 0, 0));  // the same one: it has one target
  ASSERT_EQ(world.pulls().size(), 1u);
  advance(world, 2000);
  EXPECT_LT((world.state().x.col(0) - Vec3(0.2, 0, 0)).norm(), 1e-6);
  world.release("ragdoll/p");
  EXPECT_TRUE(world.pulls().empty());
  advance(world, 10);
  for (const Event& event : world.takeEvents()) {
    EXPECT_NEAR(event.poke.duration, kStep, kRounding);
    again.replay(event);
  }
  advance(again, 2010);
  EXPECT_EQ(again.state().x, world.state().x);
  EXPECT_EQ(again.state().v, world.state().v);
}

}  // namespace
