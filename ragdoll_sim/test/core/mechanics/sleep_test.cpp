#include "ragdoll_sim/core/sleep.h"

#include <gtest/gtest.h>

#include "core/contact/contact.h"
#include "core/mechanics/supports.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kQuietStep = 0.1;

/// Two balls at rest.
struct Balls : World {
  Balls() : World(scene()) {}
  static Scene scene() {
    Scene scene = sceneOf(oneParticle());
    scene.ragdolls.push_back(scene.ragdolls[0]);
    scene.ragdolls[1].name = "other";
    return scene;
  }
  /// Steps in which an obstacle presses on those, and bodies on each other.
  void rest(double seconds, std::vector<std::uint8_t> pressed,
            const std::vector<BodyPair>& pressing) {
    for (double t = 0; t < seconds - 0.5 * kQuietStep; t += kQuietStep) {
      Supports now{pressed, pressing, pressed};
      putToSleep(model, kQuietStep, now, state);
    }
  }
};

TEST(Sleep, WhatLiesStillFallsAsleepAndWhatFloatsLater) {
  Balls balls;
  balls.rest(kQuietTime - kQuietStep, {1, 0}, {});
  EXPECT_FALSE(balls.state.asleep[0]);
  balls.rest(2 * kQuietStep, {1, 0}, {});
  EXPECT_TRUE(balls.state.asleep[0]);
  EXPECT_FALSE(balls.state.asleep[1]);
  balls.rest(kHungTime, {1, 0}, {});
  EXPECT_TRUE(balls.state.asleep[1]);
}

TEST(Sleep, BodiesThatPressOnEachOtherFallAsleepTogether) {
  Balls balls;
  balls.state.v.col(1) = Vec3(2 * kStillSpeed, 0, 0);
  balls.rest(2 * kQuietTime, {1, 0}, {{0, 1, true}});  // the second lies on the first
  EXPECT_FALSE(balls.state.asleep[0]);
  balls.state.v.setZero();
  balls.rest(kQuietTime + kQuietStep, {1, 0}, {{0, 1, true}});
  EXPECT_TRUE(balls.state.asleep[0]);
  EXPECT_TRUE(balls.state.asleep[1]);
}

TEST(Sleep, APokeWakesTheBodyThatItActsOn) {
  Balls balls;
  balls.state.asleep = {1, 1};
  Poke poke;
  poke.body.ragdoll = 1;
  balls.inputs.pokes = {poke};
  wakeDisturbed(balls.model, balls.inputs, kQuietStep, balls.state);
  EXPECT_TRUE(balls.state.asleep[0]);
  EXPECT_FALSE(balls.state.asleep[1]);
}

}  // namespace
}  // namespace ragdoll
