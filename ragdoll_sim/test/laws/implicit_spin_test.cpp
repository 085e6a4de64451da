// Implicit steps keep the angular momentum of what flies freely.
#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// About the centre of mass.
Vec3 ownAngularMomentum(const World& world) {
  return angularMomentum(world.model, world.state) -
         centreOfMass(world.model, world.state, 0).cross(momentum(world.model, world.state));
}

TEST(ImplicitStep, KeepsTheAngularMomentumOfAFreeBody) {
  for (const double force : {6600.0, 60000.0})
    for (const char* model : {"human_lumped", "human"})
      for (const double rate : {60.0, 120.0}) {
        Scene scene = parseScene(std::string("gravity: [0, 0, 0]\nragdolls: [{model: ") + model +
                                 "}]\npokes: [{at: 0, body: right_hand, force: [0, 0, 1]}]\n");
        scene.solver.step = 1 / rate;
        scene.pokes[0].force.z() = force * rate / 60;
        World world(scene);
        StepReport report = world.steps(1);  // of the poke
        const Vec3 first = ownAngularMomentum(world);
        for (int i = 0; i < 60; ++i) report += world.steps(1);
        const Vec3 last = ownAngularMomentum(world);
        EXPECT_LT((last - first).norm(), 1e-3 * first.norm())
            << model << " " << rate << " implicit " << report.implicit << " rigid " << report.rigid;
      }
}

}  // namespace
}  // namespace ragdoll
