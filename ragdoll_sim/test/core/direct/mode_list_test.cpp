#include "core/direct/mode_list.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// [1 ms] at 10 m/s: three times that way, and a millimetre.
TEST(ModeList, HasWhatThreeSuchMotionsReach) {
  Scene scene = modeScene(oneParticle(1, kModeRadius), Vec3::Zero(), floorPlane());
  scene.gravity.setZero();
  scene.ragdolls[0].velocity = Vec3(10, 0, 0);
  for (const double gap : {0.0309, 0.0311}) {
    scene.ragdolls[0].pose.position.z() = kModeRadius + gap;
    ModeBody one(scene);
    EXPECT_TRUE(startMode(one.island, reachOf(one.island, 1e-3)));
    EXPECT_EQ(one.mode().rows.size(), gap < 0.031 ? 1u : 0u);
  }
}

TEST(ModeList, IsNotForWhatIsDeepInWhatIsRigid) {
  const auto listed = [](double gap, double stiffness) {
    ObstacleSpec floor = floorPlane();
    floor.contact.stiffness = stiffness;
    return ModeBody(modeScene(oneParticle(1, kModeRadius), Vec3(0, 0, kModeRadius + gap), floor))
        .listed;
  };
  const double rigid = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(listed(-1e-12, rigid));
  EXPECT_FALSE(listed(-1e-3, rigid));
  EXPECT_TRUE(listed(-1e-3, 1e5));
}

/// A rod across a plate presses at two edges, for which there is one row.
TEST(ModeList, IsNotForAStickThatLiesAcrossABox) {
  ObstacleSpec plate;
  plate.type = ObstacleSpec::Type::kBox;
  plate.size = Vec3(0.5, 2, 2);
  for (const double half : {0.5, 0.2}) {
    SkeletonSpec rod = oneStick();
    for (ParticleSpec& p : rod.particles) p.radius = kModeRadius, p.position *= 2 * half;
    ModeBody one(modeScene(rod, Vec3(-half, 0, 1 + kModeRadius), plate));
    EXPECT_EQ(startMode(one.island, reachOf(one.island, one.h)), half < 0.25) << half;
  }
}

}  // namespace
}  // namespace ragdoll
