// Newton's restitution with Coulomb's friction may give energy in an impact off the middle: it is
// taken out at once, by both methods alike, and out of what was hit alone.
#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"

namespace ragdoll::test {
namespace {

/// A rod of two masses falls aslant with a spin, onto a rough floor that throws back all.
Scene fallingRod() {
  return parseScene(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
ragdolls:
  - name: rod
    position: [0, 0, 0.0216754785617]
    velocity: [0.251832054628, 0, -2.62749886449]
    angular_velocity: [0, -3.88001226965, 0]
    model:
      particles:
        p0: {position: [0, 0, 0], mass: 1, radius: 0.02}
        p1: {position: [0.303726170466, 0, 0.260289095765], mass: 1, radius: 0.02}
      sticks: [[p0, p1]]
obstacles: [{type: plane, restitution: 1, friction: 0.6}]
)");
}

TEST(ImpactEnergy, OfARodThatBouncesOnARoughFloorStaysAsItWas) {
  Scene scene = fallingRod();
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = 1e-3;
  World world(scene);
  const double before = kineticEnergy(world.model, world.state);
  world.steps(12);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), before, 1e-9 * before);
  const Points exact = endOfImpacts(scene, Method::kRk, 1.0 / 8000, 0.012);
  EXPECT_LT(largest(endOfImpacts(scene, Method::kRk, 1.0 / 250, 0.012) - exact), 1e-11);
  for (const double rate : {250.0, 500.0, 1000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.012) - exact),
              0.5 / (rate * rate))
        << rate;
}

/// A ball that flies by near the rod and touches nothing.
TEST(ImpactEnergy, IsNotTakenOutOfWhatFliesBy) {
  Scene scene = fallingRod();
  const Vec3 velocity = scene.ragdolls[0].velocity;
  scene.ragdolls.push_back(
      sceneOf(oneParticle(1, 0.02), Vec3(0.303726170466, 0.0444, 0.281964574326)).ragdolls[0]);
  scene.ragdolls[1].name = "ball";
  scene.ragdolls[1].velocity = velocity;
  const Vec3 start = scene.ragdolls[1].pose.position;
  for (const Method method : {Method::kRk, Method::kShake})
    for (const double rate : {250.0, 1000.0}) {
      const Points end = endOfImpacts(scene, method, 1 / rate, 0.012);
      EXPECT_LT((end.col(2) - start - 0.012 * velocity).norm(), 1e-12) << rate;
    }
}

/// A ball pushes a lying limb onto a solid that throws it back: of the two impacts at once one
/// gives energy, and the other one's loss does not make up for it.
TEST(ImpactEnergy, OfOneIsNotMadeUpForByTheLossOfAnother) {
  const Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
self_collision: false
ragdolls:
  - name: a
    velocity: [0, 0, 0]
    model:
      particles:
        p0: {position: [0, 0.028452194886, -0.141989775491], mass: 2.35668322056, radius: 0.0201049649887}
        p1: {position: [-0.107472385569, 0.111572191074, 0.00997002723254], mass: 0.463537435953, radius: 0.0201049649887}
      sticks: [[p0, p1]]
      segments:
        s0: {from: p0, to: p1, mass: 0.312160318858, gyration: 0.289}
  - name: s
    velocity: [-3.71954705397, -0.143211727886, 0.273234720498]
    model:
      particles:
        p0: {position: [0.0461714456586, 0.0702471707386, -0.0906601643436], mass: 6.11345590793, radius: 0.0514168730717}
obstacles:
  - {type: capsule, from: [-0.313279284143, 0.120235148353, -0.444570483719], to: [-0.313279284143, 0.158494612301, 0.55469735496], radius: 0.176967501621, restitution: 1, friction: 0.6}
)");
  const Points exact = endOfImpacts(scene, Method::kRk, 1.0 / 4000, 0.048);
  EXPECT_LT(largest(endOfImpacts(scene, Method::kRk, 1.0 / 1000, 0.048) - exact), 1e-10);
  for (const double rate : {1000.0, 4000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.048) - exact),
              20 / (rate * rate))
        << rate;
}

}  // namespace
}  // namespace ragdoll::test
