// What slides on more contacts than it needs: each has the share that equal springs would, by both
// methods, in whatever order the particles are.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/plates.h"

namespace ragdoll::test {
namespace {

const char* const kLegs[] = {"a: {position: [0.5, 0.3, 0], radius: 0.05}",
                             "b: {position: [-0.4, 0.35, 0], radius: 0.05}",
                             "c: {position: [-0.45, -0.3, 0], radius: 0.05}",
                             "d: {position: [0.4, -0.35, 0], radius: 0.05}"};

/// com: [m], x, y, z; speed: [m/s] along x.
struct Table {
  const char *com, *speed;
};

/// A table of four legs that slides and turns.
Scene table(const std::array<int, 4>& order, const Table& of) {
  std::string particles;
  for (const int leg : order) particles += std::string(kLegs[leg]) + ", ";
  return parseScene(
      "ragdolls:\n"
      "  - {name: t, position: [0, 0, 0.05], angular_velocity: [0, 0, 2], velocity: [" +
      std::string(of.speed) + ", 0.3, 0], model: {particles: {" + particles +
      "top: {position: [0.1, 0.05, 0.6], radius: 0.05}}, segments: {s: {particles: [a, b, c, d, "
      "top],"
      " mass: 10, com: [" +
      of.com +
      "], inertia: [0.6, 0.7, 0.5, 0, 0, 0]}}}}\n"
      "obstacles: [{type: plane, friction: 0.4}]\n");
}

/// Ends of a, b, c, d, top.
Points legsOf(const Points& end, const std::array<int, 4>& order) {
  Points legs = end;
  for (int k = 0; k < 4; ++k) legs.col(order[k]) = end.col(k);
  return legs;
}

class ATableThatSlides : public testing::TestWithParam<Table> {};

TEST_P(ATableThatSlides, HasOneLimitByBothMethods) {
  const std::array<int, 4> order{0, 1, 2, 3};
  const Scene scene = table(order, GetParam());
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.2);
  for (const double rate : {250.0, 1000.0, 4000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.2) - exact),
              3 / (rate * rate))
        << rate;
}

TEST_P(ATableThatSlides, DoesNotKnowTheOrderOfItsLegs) {
  const std::array<int, 4> orders[] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}};
  const Points end = endOfImpacts(table(orders[0], GetParam()), Method::kShake, 4e-3, 0.2);
  for (const std::array<int, 4>& order : orders) {
    const Points other = endOfImpacts(table(order, GetParam()), Method::kShake, 4e-3, 0.2);
    EXPECT_LT(largest(legsOf(other, order) - legsOf(end, orders[0])), 1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(SharedLoad, ATableThatSlides,
                         testing::Values(Table{"0.02, 0.03, 0.25", "1.0"},
                                         Table{"0.35, -0.2, 0.5", "2.0"}));  // legs lift

/// A leg hits a leg: the rows of both are solved for at once.
TEST(SharedLoad, OfTablesThatSlideAgainstEachOther) {
  const char* const kTable =
      "top: {position: [0.05, 0.02, 0.5], radius: 0.05}}, segments: {s: {mass: 10, "
      "com: [0.02, 0.01, 0.2], inertia: [0.6, 0.7, 0.5, 0, 0, 0], particles: [";
  const Scene scene =
      parseScene(std::string("ragdoll_collision: true\nragdolls:\n"
                             "  - {name: t, position: [0, 0, 0.05], velocity: [0.6, 0.2, 0], "
                             "angular_velocity: [0, 0, 1], model: {particles: {") +
                 kLegs[0] + ", " + kLegs[1] + ", " + kLegs[2] + ", " + kLegs[3] + ", " + kTable +
                 "a, b, c, d, top]}}}}\n"
                 "  - {name: u, position: [1.1, 0, 0.05], velocity: [-0.8, 0.1, 0], "
                 "angular_velocity: [0, 0, -0.5], model: {particles: {" +
                 kLegs[3] + ", " + kLegs[1] + ", " + kLegs[0] + ", " + kLegs[2] + ", " + kTable +
                 "a, b, c, d, top]}}}}\n"
                 "obstacles: [{type: plane, friction: 0.35}]\n");
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.2);
  Scene apart = scene;
  apart.ragdoll_collision = false;
  ASSERT_GT(largest(endOfImpacts(apart, Method::kRk, 1e-3, 0.2) - exact), 1e-3);
  // [m] What legs that land leave of their gaps, 1e-10 m, is velocity over the rest of a step: 4e-7
  // m in the end, from 1/4000 to 1/16000 s.
  constexpr double kLands = 2e-7;
  for (const double rate : {250.0, 1000.0, 4000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.2) - exact),
              8 / (rate * rate) + kLands)
        << rate;
}

/// [m] between shake at 4000 Hz and rk from event to event, after 0.4 s.
double apart(const Scene& scene) {
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.4);
  return largest(endOfImpacts(scene, Method::kShake, 1.0 / 4000, 0.4) - exact);
}

/// Four gaps of a plate contradict each other by 1e-13 m, as rounding and impacts leave them.
/// Sweeps never settled on that, but took all load from two of them, and it was not shared (1e-3 m
/// off at any step up to 1/64000 s).
TEST(SharedLoad, OfAPlateThatHasLandedIsOneByBothMethods) {
  EXPECT_LT(apart(plateAcrossAnEdge()), 1e-4);
}

/// The same between bodies (6e-4 m off at 1/4000 s, 4e-3 at 1/16000).
TEST(SharedLoad, OfAPlateThatHasLandedOnARodIsOneByBothMethods) {
  EXPECT_LT(apart(plateOnARod()), 1e-6);
}

/// Places that strike had been found where the motion led before it was cut short: 5e-8 of a stick
/// off, so that their speeds contradicted each other and some took the whole impact (3e-4 m off at
/// any step up to 1/16000 s).
TEST(SharedLoad, OfAnImpactIsOneByBothMethods) { EXPECT_LT(apart(plateOnACapsule()), 1e-5); }

}  // namespace
}  // namespace ragdoll::test
