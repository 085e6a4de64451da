// A batch gives each body the bits that its scene has alone, in a World.
#include "ragdoll_sim/world/batch.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll {
namespace {

Scene bodyScene(int i, const std::string& preset, const std::string& more = "") {
  return parseScene("ragdolls: [{name: body, model: human, position: [0, 0, 1.2], rpy_deg: [" +
                    std::to_string(10 * i) + ", 20, 0]}]\n" +
                    "obstacles: [{type: plane, friction: 0.5}]\n"
                    "pokes: [{at: 0.1, body: torso, force: [" + std::to_string(60 * i) +
                    ", 0, 0], duration: 0.1}]\n" + more +
                    "solver: {preset: " + preset + ", step: 0.01, joint_damping: 2}\n");
}

std::vector<Scene> someScenes(const std::string& preset, const std::string& more = "") {
  std::vector<Scene> scenes;
  for (int i = 0; i < 5; ++i) {
    scenes.push_back(bodyScene(i, preset, more));
    scenes.back().ragdolls[0].skeleton = scenes.front().ragdolls[0].skeleton;
  }
  return scenes;
}

TEST(Batch, HasTheBitsOfEachScene) {
  for (const char* preset : {"fast", "balanced", "thesis"}) {
    const std::vector<Scene> scenes = someScenes(preset);
    Batch batch(scenes);
    for (int k = 0; k < 150; ++k) batch.advance();
    for (int i = 0; i < 5; ++i) {
      World world(scenes[i]);
      for (int k = 0; k < 150; ++k) world.advance();
      EXPECT_EQ(batch.hash(i), hash(world.state())) << preset << " " << i;
    }
    EXPECT_NEAR(batch.time(), 1.5, 1e-12);
  }
}

TEST(Batch, LetsGoAsAWorldDoes) {
  const std::vector<Scene> scenes = someScenes("fast", "pins: [left_foot]\n");
  Batch batch(scenes);
  World world(scenes[3]);
  for (int k = 0; k < 100; ++k) {
    if (k == 15) {
      batch.letGo();
      world.detach("left_foot");
    }
    batch.advance();
    world.advance();
  }
  EXPECT_EQ(batch.hash(3), hash(world.state()));
}

TEST(Batch, KeysAreEqualWhereScenesCanShare) {
  const std::string key = batchKey(bodyScene(0, "fast"));
  EXPECT_FALSE(key.empty());
  EXPECT_EQ(key, batchKey(bodyScene(3, "fast")));
  EXPECT_NE(key, batchKey(bodyScene(3, "balanced")));
  EXPECT_EQ(batchKey(bodyScene(0, "fast", "pins: [head]\n")), "");
  EXPECT_EQ(batchKey(parseScene("ragdolls: [{model: human, count: 3}]\n")), "");
}

TEST(Batch, AForeignBodyIsAnError) {
  Scene scene = bodyScene(0, "fast");
  scene.pokes[0].body = "other/torso";
  EXPECT_THROW(Batch({bodyScene(0, "fast"), scene}), Error);
  EXPECT_THROW(Batch(someScenes("fast")).find(1, "other/torso"), Error);
}

}  // namespace
}  // namespace ragdoll
