// What the sweeps of `method: jakobsen` leave of a blow of a thousand times a body's weight.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

/// Of a length.
double worstStretch(const World& world) {
  double worst = 0;
  for (const Stick& k : world.model.skeletons[0].sticks)
    worst = std::max(worst, std::abs((world.x(k.b) - world.x(k.a)).norm() / k.length - 1));
  return worst;
}

struct Stretch {
  double worst = 0, after = 0;  ///< of all steps, and after a second
};

/// A body in the air whose head is pushed with 1e6 N for one step of 1/120 s.
Stretch stretchOf(int sweeps) {
  Scene scene = loadScene("weightless");
  scene.solver.method = Method::kJakobsen;
  scene.solver.sweeps = sweeps;
  scene.solver.step = 1.0 / 120;
  scene.pokes.assign(1, {});
  scene.pokes[0].body = "head";
  scene.pokes[0].force = Vec3(1e6, 0, 0);
  World world(scene);
  Stretch stretch;
  for (int i = 0; i < 120; ++i) {
    EXPECT_EQ(world.steps(1).guarded, 0);  // sweeps alone
    stretch.worst = std::max(stretch.worst, worstStretch(world));
  }
  stretch.after = worstStretch(world);
  return stretch;
}

/// It spins at 100 m/s then; what it is off by is what its sweeps leave, and goes away with them.
TEST(Relaxation, KeepsSticksAsWellAsItsSweepsAfterABlow) {
  const Stretch few = stretchOf(10), many = stretchOf(640);
  EXPECT_LT(few.worst, 0.25);  // beyond that the guard steps in
  EXPECT_LT(few.after, 1e-2);
  EXPECT_LT(many.worst, 2e-3);
  EXPECT_LT(many.after, 1e-5);
}

}  // namespace
}  // namespace ragdoll::test
