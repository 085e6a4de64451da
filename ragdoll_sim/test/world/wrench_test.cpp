#include "ragdoll_sim/world/wrench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/error_of.h"

namespace ragdoll {
namespace {

struct Sum {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  ///< [N], [N m] about the world's origin
};

Sum sumOfPokes(const World& world, const std::vector<Poke>& pokes) {
  Sum sum;
  for (const Poke& poke : pokes) {
    const Vec3 at = world.state().x.col(poke.body.particles[0]);
    sum.force += poke.force;
    sum.moment += at.cross(poke.force);
  }
  return sum;
}

const char* const kTurned =
    "ragdolls: [{model: human, position: [0, 0, 2], rpy_deg: [20, 50, 30]}]\n";

TEST(WrenchPokes, AreTheForceInTheFramesAxes) {
  const World world(parseScene(kTurned));
  const std::string frame = "ragdoll/pelvis";
  const Vec3 force(100, 50, -80);
  const Sum sum = sumOfPokes(world, wrenchPokes(world, frame, force, Vec3::Zero()));
  EXPECT_LT((sum.force - world.frame(frame)->orientation * force).norm(), 1e-9);
}

TEST(WrenchPokes, ATorqueIsAMomentWithoutForce) {
  const World world(parseScene(kTurned));
  const std::string frame = "ragdoll/pelvis";
  const Vec3 torque(3, -4, 12);
  const Sum sum = sumOfPokes(world, wrenchPokes(world, frame, Vec3::Zero(), torque));
  EXPECT_LT(sum.force.norm(), 1e-9);
  EXPECT_LT((sum.moment - world.frame(frame)->orientation * torque).norm(), 1e-9);
}

TEST(WrenchPokes, OfNothingAreNone) {
  const World world(parseScene(kTurned));
  EXPECT_TRUE(wrenchPokes(world, "ragdoll/pelvis", Vec3::Zero(), Vec3::Zero()).empty());
}

TEST(WrenchPokes, OnAnUnknownFrameListWhatThereIs) {
  const World world(parseScene(kTurned));
  const std::string error =
      test::errorOf([&] { wrenchPokes(world, "nobody", Vec3::UnitX(), Vec3::Zero()); });
  EXPECT_NE(error.find("ragdoll/pelvis"), std::string::npos) << error;
}

}  // namespace
}  // namespace ragdoll
