// Where runs begin: what they carry over, what they do not, and what they are called.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "pokes.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace {

using ragdoll::Bytes;
using ragdoll::Error;
using ragdoll::Event;
using ragdoll::Poke;
using ragdoll::Scene;
using ragdoll::Vec3;
using ragdoll::World;
using ragdoll::test::advance;
using ragdoll::test::kStep;
using ragdoll::test::particles;
using ragdoll::test::pokeOf;

/// A human that hangs by a hand over a floor, is pushed from step 60 on, and has an IMU.
Scene fallingHuman() {
  return ragdoll::parseScene(
      "ragdolls: [{model: human, position: [0, 0, 1.3], rpy_deg: [20, 30, 0]}]\n"
      "obstacles: [{type: plane}]\n"
      "pins: [right_hand]\n"
      "pokes: [{at: 0.6, body: torso, force: [200, 0, 0], duration: 0.2}]\n"
      "sensors: [{name: back, type: imu, segment: torso, rate: 100}]\n"
      "solver: {preset: draft, step: 0.01}\n",
      "scene");
}

TEST(Runs, AResetBeginsAgainWithTheSameBits) {
  World world(fallingHuman());
  EXPECT_EQ(world.run(), 0u);
  advance(world, 100);
  const auto end = hash(world.state());
  const std::size_t samples = world.takeImuSamples().size();
  EXPECT_EQ(samples, 100u);
  world.detach("right_hand");
  world.attach("left_hand", "robot/gripper");
  world.clearPokes();
  advance(world, 7);
  world.reset();
  EXPECT_EQ(world.state().step, 0u);
  EXPECT_EQ(world.pinNames(), std::vector<std::string>{"pin_right_hand"});
  EXPECT_EQ(world.beginning(), nullptr);  // at the scene's start
  EXPECT_EQ(world.run(), 3u);             // after the two changes of what is held
  EXPECT_TRUE(world.takeImuSamples().empty());
  advance(world, 100);
  EXPECT_EQ(hash(world.state()), end);
  EXPECT_EQ(world.takeImuSamples().size(), samples);
}

TEST(Runs, ARestoredMomentGoesOnToTheSameBits) {
  // Saved before the poke and while it acts.
  for (const int saved : {40, 65}) {
    World world(fallingHuman()), other(fallingHuman());
    advance(world, saved);
    Poke more;  // to come, and none of the scene's
    more.start = 0.9;
    more.body_name = "ragdoll/head";
    more.body = findBody(*world.model(), more.body_name);
    more.force = Vec3(0, 300, 0);
    world.addPoke(more);
    const Bytes bytes = world.save();
    advance(other, 13);
    other.restore(bytes);
    EXPECT_EQ(other.state().step, static_cast<std::uint64_t>(saved));
    EXPECT_EQ(other.run(), 1u);
    ASSERT_NE(other.beginning(), nullptr);
    EXPECT_EQ(*other.beginning(), bytes);
    advance(world, 60);
    advance(other, 60);
    EXPECT_EQ(hash(other.state()), hash(world.state())) << saved;
  }
}

TEST(Runs, ARestoredMomentBringsItsSettingsAndPins) {
  World world(particles(1)), other(particles(1));
  const auto scene = std::make_shared<Scene>(*world.scene());
  scene->gravity = Vec3(0, 0, -2);
  world.configure(world.scene(), scene, std::make_shared<ragdoll::Model>(buildModel(*scene)));
  world.attach("ragdoll/p", "robot/gripper");
  other.restore(world.save());
  EXPECT_EQ(other.model()->gravity, Vec3(0, 0, -2));
  EXPECT_EQ(other.scene()->gravity, Vec3(0, 0, -2));
  EXPECT_EQ(other.pinNames(), std::vector<std::string>{"attach_p"});
  EXPECT_NE(other.scene()->text.find("gravity: [0, 0, -2]"), std::string::npos);
  other.reset();  // pins are the scene's, settings stay
  EXPECT_TRUE(other.pinNames().empty());
  EXPECT_EQ(other.model()->gravity, Vec3(0, 0, -2));
}

TEST(Runs, WhatIsNoMomentOfThisSceneChangesNothing) {
  World world(particles(1)), other(particles(2));
  advance(world, 3);
  Bytes broken = world.save();
  broken[broken.size() / 2] ^= 1;
  const auto revision = world.revision();
  for (const Bytes& bytes : {other.save(), broken, Bytes{}}) {
    EXPECT_THROW(world.restore(bytes), Error);
    EXPECT_EQ(world.revision(), revision);
    EXPECT_EQ(world.run(), 0u);
    EXPECT_EQ(world.state().step, 3u);
  }
}

TEST(Runs, OfAnotherSceneAreLaterThanBoth) {
  World world(particles(1)), other(particles(2));
  for (int i = 0; i < 4; ++i) other.reset();
  advance(world, 5);
  world.addPoke(pokeOf(world, 0, kStep, 1));
  const auto revision = std::max(world.revision(), other.revision());
  world.keepContacts(true);
  world.replaceBy(other);
  EXPECT_EQ(world.model()->ragdolls.size(), 2u);
  EXPECT_EQ(world.state().step, 0u);
  EXPECT_EQ(world.run(), 5u);
  EXPECT_GT(world.revision(), revision);
  EXPECT_TRUE(world.keepsContacts());
  const std::vector<Event> told = world.takeEvents();  // what was accepted is still to be told
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].run, 0u);
}

TEST(Runs, AStreamThatGoesOnIsToldOfEachRunByItself) {
  World world(particles(1));
  world.stream("wrench", {pokeOf(world, 0, kStep, 1)}, 1);
  advance(world, 4);
  EXPECT_EQ(world.mark().told, 0u);
  world.attach("ragdoll/p", "robot/gripper");
  EXPECT_EQ(world.mark().run, 1u);
  EXPECT_EQ(world.mark().told, 4u);
  const std::vector<Event> told = world.takeEvents();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].run, 0u);
  EXPECT_EQ(told[0].step, 0u);
  EXPECT_NEAR(told[0].poke.duration, 4 * kStep, 1e-12);
}

TEST(Runs, AnotherStepLengthBeginsAnew) {
  World world(particles(1));
  advance(world, 7);
  EXPECT_EQ(world.stepsPerFollow(), 4u);  // of 1 ms in 4 ms
  const auto scene = std::make_shared<Scene>(*world.scene());
  scene->solver.step = 0.01;
  world.configure(world.scene(), scene, std::make_shared<ragdoll::Model>(buildModel(*scene)));
  EXPECT_EQ(world.stepsPerFollow(), 1u);
  EXPECT_EQ(world.followedStep(), 7u);
  EXPECT_EQ(world.stepLength(), 0.01);
  EXPECT_EQ(world.state().step, 7u);
  advance(world, 1);
  EXPECT_NEAR(world.state().time, 7 * kStep + 0.01, 1e-12);
}

}  // namespace
