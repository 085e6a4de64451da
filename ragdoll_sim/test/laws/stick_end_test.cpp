// A stick that presses and slides until it touches at its end, or from its end on: the curvature of
// what touches jumps there, and with it the force, at a time that is not a step's. Its end is not
// hit just before.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"

namespace ragdoll::test {
namespace {

/// Where a scene leads to in some seconds, by rk from event to event.
class SlidingStick {
 public:
  SlidingStick(const std::string& text, double seconds)
      : scene_(parseScene(text)), seconds_(seconds) {
    Scene scene = scene_;
    scene.solver.events = true;
    exact_ = endOfImpacts(scene, Method::kRk, 1e-3, seconds);
  }
  /// At most `most` [m/s^2] / rate^2, at each of the rates [Hz].
  void expectSecondOrder(double most, std::initializer_list<double> rates) const {
    for (const double rate : rates)
      EXPECT_LT(largest(endOfImpacts(scene_, Method::kShake, 1 / rate, seconds_) - exact_),
                most / (rate * rate))
          << rate;
  }
  void expectWithinTolerances() const {
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
      Scene scene = scene_;
      scene.solver.tolerance = tolerance;
      const Points off = endOfImpacts(scene, Method::kShake, 1.0 / 60, seconds_) - exact_;
      EXPECT_LT(largest(off), 3 * tolerance * seconds_) << tolerance;
    }
  }

 private:
  Scene scene_;
  double seconds_;
  Points exact_;
};

/// Off a capsule, by the end. 4.8e-4 m off at 1000 Hz where the motion does not end there and the
/// end is hit.
TEST(StickEnd, SlidesOffACapsule) {
  const SlidingStick rod(R"(
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
  const SlidingStick chain(R"(
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
  const SlidingStick rods(R"(
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
  const SlidingStick rod(R"(
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

}  // namespace
}  // namespace ragdoll::test
