// Impacts beside what lies somewhere: `shake` meets the limit that `rk` finds from event to event.
#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/limit_of.h"

namespace ragdoll::test {
namespace {

/// Of a ball.
void setMass(RagdollSpec& ball, double mass) {
  auto skeleton = std::make_shared<SkeletonSpec>(*ball.skeleton);
  skeleton->particles[0].mass = mass;
  ball.skeleton = skeleton;
}

/// The impact's time is that of motions that the floor bears: of free ones it came too late, and
/// the floor then lifted one ball into the other.
TEST(ImpactLimit, OfABallThatHitsOneThatLies) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - {name: a, position: [0, 0, 0.05], model: {particles: {p: {position: [0, 0, 0], mass: 1.1, radius: 0.05}}}}
  - {name: b, position: [0, -0.31, 0.29], velocity: [0, 2.9, -2.3],
     model: {particles: {p: {position: [0, 0, 0], mass: 0.6, radius: 0.06}}}}
obstacles: [{type: plane, friction: 0}]
)",
                      0.16);
  limit.expectSecondOrder(2, {250.0, 500.0, 1000.0, 4000.0});
}

/// Two rods that glance off each other and slide, in the air and while the floor throws one up.
/// What they meet by, or what has just thrown them off, told whether they slip beside their spin:
/// 1.9e-4 m off at 250 Hz, 2.6e-6 m at 16000 Hz.
TEST(ImpactLimit, OfRodsThatGlanceOff) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - name: one
    position: [0, 0, 0.35]
    velocity: [0.3, 0, -1]
    angular_velocity: [0, 3, 1]
    model: {sticks: [[p, q]], particles: {p: {position: [0,0,0], mass: 1, radius: 0.03},
      q: {position: [0.5,0,0.1], mass: 0.4, radius: 0.03}}}
  - name: two
    position: [0.2, -0.25, 0.5]
    velocity: [0, 0.4, -3]
    angular_velocity: [1, 0, -2]
    model: {sticks: [[p, q]], particles: {p: {position: [0,0,0], mass: 0.6, radius: 0.02},
      q: {position: [0.06,0.5,0.05], mass: 0.9, radius: 0.02}}}
obstacles: [{type: plane, friction: 0.7, restitution: 0.8}]
)",
                      0.24);
  limit.expectSecondOrder(2, {250.0, 500.0, 1000.0, 4000.0});
}

/// Rods at 6 degrees meet where they cross, not where their ends are nearest.
TEST(ImpactLimit, OfRodsThatAlmostLieAlongEachOther) {
  const LimitOf limit(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
ragdolls:
  - name: one
    model: {sticks: [[p, q]], particles: {p: {position: [-0.3, 0, 0], mass: 1, radius: 0.03},
      q: {position: [0.3, 0, 0], mass: 1, radius: 0.03}}}
  - name: two
    velocity: [0.3, 0.5, -0.5]
    model: {sticks: [[p, q]], particles: {p: {position: [-0.0989, -0.0209, 0.0803], mass: 1,
      radius: 0.03}, q: {position: [0.3486, 0.0261, 0.0803], mass: 1, radius: 0.03}}}
)",
                      0.1);
  limit.expectSecondOrder(0.01, {250.0, 1000.0, 4000.0});
}

/// A rod rolls over onto one that lies: where they touch runs half their length within a step, and
/// was hit anew eight times, until no impact was located any more (1.6e-4 and 9e-5 m off).
TEST(ImpactLimit, OfARodThatRollsOverOntoOneThatLies) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - name: one
    position: [0.00799755, -0.0114308, 0.509887]
    rpy_deg: [-61.6439, 1.97826, 40.6367]
    velocity: [0.281473, -0.0259726, -0.0304724]
    angular_velocity: [-0.914588, -0.52756, -1.30241]
    model: {sticks: [[p, q]], particles: {p: {position: [-0.4, 0, 0], mass: 1, radius: 0.03},
      q: {position: [0.4, 0, 0], mass: 1.5, radius: 0.04}}}
  - name: two
    position: [0, 0, 0.04]
    rpy_deg: [0, 0, 20]
    model: {sticks: [[p, q]], particles: {p: {position: [-0.4, 0, 0], mass: 1, radius: 0.04},
      q: {position: [0.4, 0, 0], mass: 1.5, radius: 0.04}}}
obstacles: [{type: plane, friction: 0.4}]
)",
                      0.3);
  limit.expectBelow(1e-5, {500.0, 2000.0, 8000.0});
}

/// A rod slides down a capsule: what is microns deep in it at a step's start rests there, too.
/// Taken for something that is yet to come it was thrown off, 4.5e-3 m after 0.3 s.
TEST(ImpactLimit, OfARodThatSlidesDownACapsule) {
  const LimitOf limit(R"(
ragdolls:
  - position: [0.123633, -0.0115199, 0.538388]
    rpy_deg: [-92.0619, 3.40968, -58.679]
    velocity: [-0.253455, 0.164999, -0.695979]
    angular_velocity: [0.101877, -0.0120721, -1.39948]
    model: {sticks: [[p, q]], particles: {p: {position: [-0.4, 0, 0], mass: 1, radius: 0.03},
      q: {position: [0.4, 0, 0], mass: 1.5, radius: 0.04}}}
obstacles: [{type: capsule, from: [0, -1, 0.2], to: [0, 1, 0.2], radius: 0.2, friction: 0.4}]
)",
                      0.3);
  limit.expectSecondOrder(4, {120.0, 480.0, 1920.0});
}

/// A rod falls across one that lies, at 8 degrees: their crossing is far from where it was a step
/// before, and the end that is next to touch does not touch yet. 2.7e-4 m off at 500 Hz, 3.5e-5 m
/// at 4000 Hz if it does.
TEST(ImpactLimit, OfARodThatFallsAcrossOneThatLies) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - name: one
    position: [0, 0, 0.03]
    model: {sticks: [[p, q]], particles: {p: {position: [-0.5, 0, 0], mass: 1, radius: 0.03},
      q: {position: [0.5, 0, 0], mass: 1, radius: 0.03}}}
  - name: two
    velocity: [0.1, 0.05, -0.3]
    model: {sticks: [[p, q]], particles: {p: {position: [-0.4, -0.02, 0.16], mass: 1.5,
      radius: 0.03}, q: {position: [0.2932, 0.0774, 0.16], mass: 1.5, radius: 0.03}}}
obstacles: [{type: plane, friction: 0.5}]
)",
                      0.14);
  limit.expectSecondOrder(4, {500.0, 1000.0, 4000.0});
}

/// Sticks that slip along each other meet where a step begins, to rounding: they hit each other
/// where they are then, not where they are a step later. 1.7e-4 m off at 1000 Hz, 4e-5 at 4000 Hz
/// if they do it there.
TEST(ImpactLimit, OfSticksThatMeetWhereAStepBegins) {
  const LimitOf limit(R"(
ragdoll_collision: true
gravity: [0, 0, 0]
ragdolls:
  - name: one
    model: {sticks: [[p, q]], particles: {p: {position: [-0.5, 0, 0], mass: 1, radius: 0.03},
      q: {position: [0.5, 0, 0], mass: 1.3, radius: 0.03}}}
  - name: two
    position: [-0.45, -0.065, 0.0616]
    rpy_deg: [0, 0, 5]
    velocity: [0.3, 0.02, -0.2]
    angular_velocity: [0, 0, 3]
    model: {sticks: [[p, q]], particles: {p: {position: [0, 0, 0], mass: 1.5, radius: 0.03},
      q: {position: [0.7, 0, 0], mass: 0.7, radius: 0.03}}}
)",
                      0.12);
  limit.expectSecondOrder(1, {250.0, 1000.0, 4000.0});
}

/// A ball that is thrown at a sphere: its way there is curved, so that it hits elsewhere than along
/// the step's chord. 2.1e-4 m off at 60 Hz, 1.4e-5 m at 240 Hz if it does not.
TEST(ImpactLimit, OfABallThatIsThrownAtASphere) {
  const LimitOf limit(R"(
ragdolls:
  - {position: [0.06, 0, 0.3537], velocity: [1, 0, -1],
     model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}
obstacles: [{type: sphere, position: [0, 0, 0], radius: 0.2, restitution: 0.5, friction: 0.3}]
)",
                      0.15);
  limit.expectSecondOrder(0.01, {60.0, 240.0, 960.0});
}

/// The same at a capsule, from beside. 2.1e-5 m off at 250 Hz, 8e-8 m at 4000 Hz along the chord.
TEST(ImpactLimit, OfABallThatIsThrownAtACapsule) {
  const LimitOf limit(R"(
ragdolls:
  - {position: [0.11, 0.02, 0.42], velocity: [-0.7, 0.9, -1.3],
     model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}
obstacles: [{type: capsule, from: [-0.4, -0.2, 0], to: [0.5, 0.3, 0.1], radius: 0.15, friction: 0.4,
             restitution: 0.3}]
)",
                      0.2);
  limit.expectSecondOrder(1e-3, {250.0, 1000.0, 4000.0});
}

/// A rod slides over the corners of a box, and where it touches runs to its end: it presses on
/// there. Where the end strikes instead, 2e-4 m off at 1000 Hz.
TEST(ImpactLimit, OfARodThatTouchesUpToItsEnd) {
  const Scene scene = parseScene(R"(
ragdolls:
  - {position: [-0.2, 0, 0.24], velocity: [2, 0, -0.5], angular_velocity: [0, 2, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.25, 0, 0], mass: 1, radius: 0.03},
       q: {position: [0.3, 0, 0], mass: 1.1, radius: 0.03}}}}
obstacles: [{type: box, position: [0, 0, 0], size: [0.3, 1, 0.4], friction: 0.2}]
)");
  const Points end = endOfImpacts(scene, Method::kShake, 1.0 / 64000, 0.12);
  for (const double rate : {250.0, 1000.0, 4000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.12) - end), 5 / (rate * rate))
        << rate;
}

/// A blow bends a joint onto a spring and a damper: where they are reached, from which way they
/// push and where they let go. 4e-4 m off at 1000 Hz, 6e-5 m at 4000 Hz, where one of these is of
/// first order.
TEST(ImpactLimit, OfALimbThatIsBentOntoASoftLimit) {
  const LimitOf limit(R"(
gravity: [0, 0, 0]
ragdolls:
  - velocity: [0, -1.5, 0.2]
    model:
      particles:
        a: {position: [0, 0, 0], mass: 1, radius: 0.03}
        b: {position: [0.3, 0, 0], mass: 0.5, radius: 0.03}
        c: {position: [0.55, 0.1, 0], mass: 0.7, radius: 0.03}
      segments: {upper: {from: a, to: b}, lower: {from: b, to: c}}
      joints:
        elbow: {type: cone, parent: upper, child: lower, axis: [1, 0, 0], half_angle_deg: 22,
                stiffness: 50, damping: 2}
obstacles: [{type: sphere, position: [0.31, -0.15, 0], radius: 0.1}]
)",
                      0.1);
  limit.expectSecondOrder(80, {250.0, 1000.0, 4000.0});
}

/// A ball that a poke throws on a box: a particle has no angular momentum that could be lost on the
/// way there. 0.12 m off at 1000 Hz where rounding is given back as a spin.
TEST(ImpactLimit, OfABallThatAPokeThrowsOnABox) {
  const LimitOf limit(R"(
gravity: [0, 0, 0]
pokes:
  - {body: a/p0, force: [-2634.5505242, -517.161681902, -518.892697404], at: 0, duration: 0.004}
ragdolls:
  - name: a
    model: {particles: {p0: {position: [0, -0.0174958834933, -0.202707845513],
      mass: 0.155322331616, radius: 0.0485820241201}}}
obstacles: [{type: box, position: [-0.230157517917, -0.052677930733, -0.177751464794],
  size: [0.360301317539, 0.369252900679, 0.538107452436], restitution: 0, friction: 0}]
)",
                      0.12);
  for (const double rate : {250.0, 1000.0, 4000.0}) EXPECT_LT(limit.errorAt(rate), 1e-12) << rate;
}

/// A rod that lies, hit by a ball that stays on it: one end's slip turns right round within 0.2 ms.
/// 1.7e-5, 1e-5 and 4e-6 m off where motions go on over that.
TEST(ImpactLimit, OfARodThatLiesAndIsHit) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - name: rod
    position: [0, 0, 0.02]
    model: {sticks: [[p, q]], segments: {s: {from: p, to: q, mass: 0.6, gyration: 0.289}},
      particles: {p: {position: [0,0,0], mass: 0.5, radius: 0.02},
        q: {position: [0.5,0.05,0], mass: 0.3, radius: 0.02}}}
  - {name: ball, position: [0.41, 0.3, 0.09], velocity: [0.2, -3, -0.4],
     model: {particles: {c: {position: [0,0,0], mass: 2, radius: 0.06}}}}
obstacles: [{type: plane, friction: 0.4, restitution: 0.5}]
)",
                      0.1);
  for (const double rate : {500.0, 1000.0, 2000.0})
    EXPECT_LT(limit.errorAt(rate), 4e-3 / rate) << rate;
}

/// What presses from below has turned by the impact, by less than its place tells.
TEST(ImpactLimit, OfABallOnABarThatIsHit) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - {name: a, position: [0, 0, 0.053], model: {particles: {p: {position: [0, 0, 0], mass: 2.097, radius: 0.053}}}}
  - {name: b, position: [-0.2263, 0.2515, 0.4174], velocity: [1.771, -2.106, -2.614],
     model: {particles: {p: {position: [0, 0, 0], mass: 0.723, radius: 0.032}}}}
obstacles: [{type: capsule, from: [0.03, -0.8, -0.2], to: [-0.05, 0.9, -0.2], radius: 0.2, friction: 0}]
)",
                      0.24);
  limit.expectSecondOrder(5, {500.0, 1000.0, 2000.0, 4000.0, 8000.0});
}

/// In steps of 4 ms it ends 15 us after the impact: before the floor's share, free motions end
/// without.
TEST(ImpactLimit, OfAnImpactJustBeforeAStepsEnd) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - {name: a, position: [-0.073, 0, 0.068], velocity: [0.706, -0.83, 0],
     model: {particles: {p: {position: [0, 0, 0], mass: 1.854, radius: 0.068}}}}
  - {name: b, position: [-0.3456, -0.3214, 0.4297], velocity: [2.492, 2.775, -2.227],
     model: {particles: {p: {position: [0, 0, 0], mass: 2.457, radius: 0.046}}}}
obstacles: [{type: box, position: [0.1, 0, -0.15], size: [0.9, 1.1, 0.3], friction: 0.777}]
)",
                      0.14);
  limit.expectSecondOrder(12, {250.0, 500.0, 1000.0, 2000.0});
}

/// A ball rolls against a rod, and sticks to it: the floor presses with nothing in the impact, but
/// both lie on it, and friction's couple does not turn them into it.
TEST(ImpactLimit, OfBodiesThatStayOnTheFloor) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - {name: a, position: [-0.53, 0, 0.05], model: {sticks: [[a, b]], particles: {
       a: {position: [0, 0, 0], mass: 1.1, radius: 0.05}, b: {position: [1, 0, 0], mass: 0.9, radius: 0.05}}}}
  - {name: b, position: [0.411, -0.4, 0.02], velocity: [0.3, 3.9, 0],
     model: {particles: {p: {position: [0, 0, 0], mass: 0.9, radius: 0.02}}}}
obstacles: [{type: plane, friction: 0}]
)",
                      0.14);
  limit.expectSecondOrder(0.1, {250.0, 300.0, 600.0, 1000.0, 1200.0, 3000.0});
}

/// A ball throws a rod off two smooth spheres. What they held together while the spheres pressed
/// may slip beside their spin when nothing does.
TEST(ImpactLimit, OfARodThatTwoSpheresLetGo) {
  const LimitOf limit(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
ragdolls:
  - {name: a, position: [-0.53, 0, 0.35], model: {sticks: [[a, b]],
       segments: {ab: {from: a, to: b, mass: 0.8, gyration: 0.289}}, particles: {
       a: {position: [0, 0, 0], mass: 1.1, radius: 0.05}, b: {position: [1, 0, 0], mass: 0.9, radius: 0.05}}}}
  - {name: b, position: [0.19, -0.31, 0.59], velocity: [0.4, 2.9, -2.3],
     model: {particles: {p: {position: [0, 0, 0], mass: 0.6, radius: 0.06}}}}
obstacles:
  - {type: sphere, position: [-0.3, 0, 0], radius: 0.3, friction: 0}
  - {type: sphere, position: [0.3, 0, 0], radius: 0.3, friction: 0}
)",
                      0.12);
  for (const double rate : {250.0, 1000.0, 4000.0})
    EXPECT_LT(limit.errorAt(rate), 2.5e-3 / rate) << rate;
}

/// Two rods meet in the air and slide on each other at 5 m/s: what friction takes of their angular
/// momentum meanwhile comes back as a turn, too.
TEST(ImpactLimit, OfRodsThatSlideOnEachOtherAfterIt) {
  const LimitOf limit(R"(
ragdoll_collision: true
ragdolls:
  - {name: a, position: [-0.2815, 0, 0.049], model: {sticks: [[a, b]], particles: {
       a: {position: [0, 0, 0], mass: 0.941, radius: 0.049}, b: {position: [0.6078, 0, 0], mass: 2.07, radius: 0.049}}}}
  - {name: b, position: [0.0871, 0.073, 0.5459], velocity: [-2.788, -0.996, -3.549], rpy_deg: [5.95, 15.24, 153.73],
     angular_velocity: [-0.931, 0.321, -1.977], model: {sticks: [[a, b]], particles: {
       a: {position: [0, 0, 0], mass: 0.883, radius: 0.056}, b: {position: [0.4795, 0, 0], mass: 2.411, radius: 0.032}}}}
  - {name: c, position: [-0.713, 0.2576, 0.6753], velocity: [1.678, -1.439, -2.079], rpy_deg: [-11.72, -0.58, 166.44],
     angular_velocity: [2.397, 0.851, 1.019], model: {sticks: [[a, b]], particles: {
       a: {position: [0, 0, 0], mass: 0.859, radius: 0.067}, b: {position: [0.6865, 0, 0], mass: 1.67, radius: 0.064}}}}
obstacles: [{type: capsule, from: [0.03, -0.8, -0.2], to: [-0.05, 0.9, -0.2], radius: 0.2, friction: 0.103}]
)",
                      0.24);
  for (const double rate : {250.0, 500.0, 1000.0, 2000.0, 4000.0})  // by 2 cm in a step of 4 ms
    EXPECT_LT(limit.errorAt(rate), 9e-3 / rate) << rate;
}

/// A rod's tip lies on a box; the rod falls across the box's edge. Each place has a gap of its own.
TEST(ImpactLimit, OfARodThatFallsAcrossAnEdge) {
  const LimitOf limit(R"(
ragdolls:
  - {name: a, position: [0, 0, 0.05], place: {a: [-0.137, 0.05, 0.037], b: [0.61, 0.09, 0.19]},
     model: {sticks: [[a, b, 0.7635561537961697]], particles: {
       a: {position: [0, 0, 0], mass: 1.1, radius: 0.037},
       b: {position: [0.7635561537961697, 0, 0], mass: 0.9, radius: 0.06}}}}
obstacles: [{type: box, position: [0, 0, -0.15], size: [0.9, 1.1, 0.3], friction: 0.35}]
)",
                      0.2);
  for (const double rate : {250.0, 500.0, 1000.0, 4000.0})
    EXPECT_LT(limit.errorAt(rate), 1e-2 / rate) << rate;
}

/// However much heavier what falls on it is, a ball that lies is no way through the floor: a sweep
/// over the contacts left all but m / M of what was wrong, and from 1000 times on what fell went
/// through it.
TEST(ImpactLimit, OfAHeavyBallOnALightOne) {
  for (const double light : {5.0, 0.5, 0.05, 5e-3}) {
    Scene scene = parseScene(R"(
ragdoll_collision: true
ragdolls:
  - {name: a, position: [0, 0, 0.05], model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}
  - {name: b, position: [0, 0, 0.2], velocity: [0, 0, -1],
     model: {particles: {p: {position: [0, 0, 0], mass: 50, radius: 0.05}}}}
obstacles: [{type: plane}]
)");
    setMass(scene.ragdolls[0], light);
    World world(scene);
    for (int i = 0; i < 120; ++i) {
      const StepReport report = step(world.model, world.inputs, world.workspace, world.state);
      EXPECT_EQ(report.guarded, 0) << light << " kg, step " << i;
      EXPECT_GT(world.state.x(2, 1), 0.15 - 1e-6) << light << " kg, step " << i;
    }
    EXPECT_NEAR(world.state.x(2, 0), 0.05, 1e-6) << light;
    EXPECT_NEAR(world.state.x(2, 1), 0.15, 1e-6) << light;
    EXPECT_LT(world.state.v.cwiseAbs().maxCoeff(), 1e-5) << light;
  }
}

/// A rod lies on a light ball and the floor: what presses goes through the ball, to the floor and
/// back.
TEST(ImpactLimit, OfAHeavyRodOnALightBall) {
  for (const double light : {2.0, 0.2, 0.02}) {
    Scene scene = parseScene(R"(
ragdoll_collision: true
ragdolls:
  - {name: ball, position: [0.13, 0.004, 0.03],
     model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.03}}}}
  - {name: rod, position: [-0.4, 0, 0.12], velocity: [0, 0, -0.5],
     model: {sticks: [[a, b]], particles: {a: {position: [0, 0, 0], mass: 10, radius: 0.03},
                                           b: {position: [0.9, 0, 0.02], mass: 10, radius: 0.03}}}}
obstacles: [{type: plane, friction: 0.6}]
)");
    setMass(scene.ragdolls[0], light);
    const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.3);
    for (const double rate : {250.0, 500.0, 1000.0})
      EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.3) - exact),
                0.05 / (rate * rate))
          << light << " kg at " << rate;
  }
}

/// A body falls down stairs: where a limb rolls over an edge it touches at the start, wherever its
/// place along the limb then was; from 1.26 s on it all but lies flat. From states that `rk` went
/// through.
TEST(ImpactLimit, OfLimbsThatRollOverEdges) {
  Scene scene = loadScene(RAGDOLL_SHARE_DIR "/scenes/stairs.yaml");
  scene.solver.sleep = false;
  const auto worldAt = [&scene](const State* from, Method method, double rate) {
    scene.solver.method = method;
    scene.solver.events = method == Method::kRk;
    scene.solver.step = 1 / rate;
    World world(scene);
    if (!from) return world;
    world.state = *from;
    world.state.impulses.clear();
    world.state.multipliers.clear();
    return world;
  };
  struct Window {
    int from, until;  // [ms]
    double rate;
  };
  World exact = worldAt(nullptr, Method::kRk, 1000);
  int now = 0;
  for (const Window& window : {Window{600, 700, 4000}, Window{1260, 1300, 16000}}) {
    exact.steps(window.from - now);
    World fine = worldAt(&exact.state, Method::kShake, window.rate);
    now = window.until;
    exact.steps(now - window.from);
    fine.steps(std::lround((now - window.from) * window.rate / 1000));
    // 4e-4 and 4e-3 where they came anew in each step.
    EXPECT_LT(largest(fine.state.x - exact.state.x), 1e-5) << window.from;
  }
}

}  // namespace
}  // namespace ragdoll::test
