// What is held: by which name, and what it loses by that.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "particles.h"
#include "ragdoll_sim/world/world.h"
#include "support/error_of.h"

namespace {

using ragdoll::Vec3;
using ragdoll::World;
using ragdoll::test::errorOf;
using ragdoll::test::particles;

using PinNames = std::vector<std::string>;

/// Two rods a - b of 1 m without weight, side by side; the scene holds an end of the first.
ragdoll::Scene twoRods() {
  ragdoll::Scene scene = ragdoll::test::sceneOf(ragdoll::test::oneStick());
  scene.gravity.setZero();
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].pose.position = Vec3(0, 2, 0);
  scene.pins = {ragdoll::test::pinOf("a")};
  return scene;
}

TEST(Pins, AreNamedByWhoHoldsAndWhatIsHeld) {
  World world(twoRods());
  EXPECT_EQ(world.pinNames(), PinNames{"pin_a"});
  world.attach("b", "robot/gripper");
  world.attach("other/b", "robot/gripper");
  EXPECT_EQ(world.pinNames(), (PinNames{"pin_a", "attach_b", "attach_other_b"}));
  world.attach("a", "robot/gripper");  // in place of the scene's own
  EXPECT_EQ(world.pinNames(), (PinNames{"attach_b", "attach_other_b", "attach_a"}));
  world.detach("other/b");
  EXPECT_EQ(world.pinNames(), (PinNames{"attach_b", "attach_a"}));
}

TEST(Pins, TakeTheEnergyOfWhatTheyStop) {
  ragdoll::Scene scene = particles(2);
  for (auto& body : scene.ragdolls) body.velocity = Vec3(0, 3, 0);
  World world(scene);
  EXPECT_EQ(world.energyTaken(), 0);
  world.attach("ragdoll/p", "robot/gripper");
  EXPECT_NEAR(world.energyTaken(), 4.5, 1e-12);  // of 1 kg at 3 m/s
  EXPECT_EQ(world.state().v.col(0), Vec3::Zero());
  EXPECT_EQ(world.state().v.col(1), Vec3(0, 3, 0));
  const Vec3 held = world.state().x.col(0);
  for (int i = 0; i < 10; ++i) world.advance();
  EXPECT_EQ(world.state().x.col(0), held);
  world.detach("ragdoll/p");
  EXPECT_EQ(world.energyTaken(), 0);
}

TEST(Pins, ThatCannotBeAreRefusedAndChangeNothing) {
  World world(twoRods());
  const auto refuses = [&](const std::string& text, const std::function<void()>& call) {
    const std::string message = errorOf(call);
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  refuses("must name a TF frame", [&] { world.attach("b", ""); });
  refuses("one of the ragdolls' own", [&] { world.attach("b", world.frameNames()[0]); });
  refuses("one of the ragdolls' own", [&] { world.attach("b", "/" + world.frameNames()[0]); });
  refuses("a particle is held, of this one: ragdoll/a, ragdoll/b",
          [&] { world.attach("ab", "robot/gripper"); });
  refuses("held are ragdoll/a", [&] { world.detach("b"); });
  EXPECT_EQ(world.run(), 0u);
  EXPECT_EQ(world.pinNames(), PinNames{"pin_a"});
  world.detach("a");
  refuses("nothing is", [&] { world.detach("a"); });
}

}  // namespace
