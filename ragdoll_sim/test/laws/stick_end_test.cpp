// A stick that presses and slides until it touches at its end, or from its end on: the curvature of
// what touches jumps there, and with it the force, at a time that is not a step's. Its end is not
// hit just before.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "ragdoll_sim/core/measures.h"
#include "support/limit_of.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

/// Off a capsule, by the end. 4.8e-4 m off at 1000 Hz where the motion does not end there and the
/// end is hit.
TEST(StickEnd, SlidesOffACapsule) {
  const LimitOf rod(R"(
ragdolls:
  - {position: [0.06, 0.01, 0.31], velocity: [2, 0, -0.4], angular_velocity: [0.2, -1, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.25, 0, 0], mass: 1, radius: 0.03},
       q: {position: [0.3, 0, 0], mass: 1.1, radius: 0.05}}}}
obstacles: [{type: capsule, from: [0, -0.5, 0.05], to: [0.1, 0.5, 0], radius: 0.2, friction: 0.1}]
)",
                    0.2);
  rod.expectSecondOrder(1, {250.0, 1000.0, 4000.0, 16000.0});
  rod.expectWithinTolerances();
}

/// Off the edge of a box, one stick of a chain after the other. 6.5e-5 m off at 1000 Hz, 2.4e-5 m
/// at 4000.
TEST(StickEnd, AChainSlidesOffAnEdge) {
  const LimitOf chain(R"(
ragdolls:
  - position: [0.1, 0.0, 0.25]
    velocity: [2.0, 0.1, -0.3]
    model:
      sticks: [[a, b], [b, c]]
      particles:
        a: {position: [-0.35, 0, 0.05], mass: 1, radius: 0.03}
        b: {position: [0, 0.03, 0.0], mass: 1.1, radius: 0.04}
        c: {position: [0.3, 0.0, -0.1], mass: 0.8, radius: 0.03}
obstacles: [{type: box, position: [-0.15, 0, 0], size: [0.5, 0.8, 0.4], friction: 0.2}]
)",
                      0.2);
  chain.expectSecondOrder(10, {250.0, 1000.0, 4000.0, 16000.0});
  chain.expectWithinTolerances();
}

/// Off the end of another one that is held. 3.4e-4 m off at 1000 Hz, 8e-5 m at 4000; within 1e-4
/// m/s 63 times what is allowed.
TEST(StickEnd, SlidesOffTheEndOfAnother) {
  const LimitOf rods(R"(
ragdoll_collision: true
pins: [a/p, a/q]
ragdolls:
  - {name: a, model: {sticks: [[p, q]],
     particles: {p: {position: [-0.3, 0, 0], mass: 3, radius: 0.03},
       q: {position: [0.3, 0, 0], mass: 3, radius: 0.03}}}}
  - {name: b, position: [0.2, 0, 0.075], velocity: [3, 0, -0.5], angular_velocity: [0, 0, 0.5],
     model: {sticks: [[p, q]], particles: {p: {position: [0, -0.3, 0], mass: 1, radius: 0.03},
       q: {position: [0, 0.25, 0], mass: 1.1, radius: 0.04}}}}
)",
                     0.1);
  rods.expectSecondOrder(0.5, {250.0, 1000.0, 4000.0});
  rods.expectWithinTolerances();
}

/// Onto both edges of a box at once: each presses and rubs in that impact. Of rk from event to
/// event one edge let go before the other struck, 2.2e-3 m off at any step.
TEST(StickEnd, LandsAcrossABox) {
  const LimitOf rod(R"(
ragdolls:
  - {position: [-0.2, 0, 0.24], velocity: [2, 0, -0.5], angular_velocity: [0, 2, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.25, 0, 0], mass: 1, radius: 0.03},
       q: {position: [0.3, 0, 0], mass: 1.1, radius: 0.03}}}}
obstacles: [{type: box, position: [0, 0, 0], size: [0.3, 1, 0.4], friction: 0.2}]
)",
                    0.2);
  rod.expectSecondOrder(10, {250.0, 1000.0});
  rod.expectWithinTolerances();
}

/// Turns about a box's edge down onto its face. Its place was taken to be where it is 1 mm above
/// the face: 4.8e-4 m off at 250 to 1000 Hz, within 1e-3 m/s 13 times what is allowed.
TEST(StickEnd, TurnsDownOntoAFace) {
  const LimitOf rod(R"(
ragdolls:
  - {position: [0.068, 0, 0.279], rpy_deg: [0, -12.7, -4.7], velocity: [-0.23, 0.37, -0.53],
     angular_velocity: [0.47, 2.66, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.25, 0, 0], mass: 1, radius: 0.03},
       q: {position: [0.3, 0, 0], mass: 1.78, radius: 0.03}}}}
obstacles: [{type: box, position: [0.3, 0, 0], size: [0.6, 1, 0.4], friction: 0.21}]
)",
                    0.2);
  rod.expectSecondOrder(1, {250.0, 500.0, 1000.0, 4000.0});
  rod.expectWithinTolerances();
}

/// Lies on a sphere, and its end swings in within a step, too far for the place to be followed: the
/// end is hit, 2.7 cm deep if it is not looked for.
TEST(StickEnd, OfWhatTouchesIsHitWhereItSwingsIn) {
  for (const double gap : {0.0, -5e-5}) {
    std::ostringstream text;
    text << "gravity: [0, 0, 0]\nragdolls: [{position: [0, 0, " << 0.34 + gap
         << "], velocity: [0, 0, -11.5], angular_velocity: [0, 111, 0],\n"
            "  model: {sticks: [[p, q]], particles: {\n"
            "    p: {position: [-0.083, 0, 0], mass: 1, radius: 0.04},\n"
            "    q: {position: [0.25, 0, 0], mass: 1, radius: 0.04}}}}]\n"
            "obstacles: [{type: sphere, position: [0, 0, 0], radius: 0.3}]\n";
    World world(parseScene(text.str()));
    double deepest = 0;
    for (int i = 0; i < 12; ++i) {
      world.steps(1);
      deepest = std::max(deepest, maxPenetration(world.model, world.state));
    }
    EXPECT_LT(deepest, 1e-4) << gap;
  }
}

}  // namespace
}  // namespace ragdoll::test
