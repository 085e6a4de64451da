#include "core/contact/stick_springs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/contact/soft_chain.h"
#include "support/obstacles.h"

namespace ragdoll {
namespace {

using namespace test;

const Obstacle kSoftBox = obstacle(ObstacleSpec::Type::kBox, Vec3(0.4, 0.5, 0.2));

/// A stick with a spring at each end, on or in a box.
struct SprungStick {
  Vec3 a, b;
  double ra = 0.05, rb = 0.05;
  StickEnds ends{{1e-4, 30}, {1e-4, 30}};

  Axis axis() const { return {kSoftBox, a, b, ra, rb}; }
  StickPress press() const { return pressOf(axis(), ends); }
  double energyAt(double t) const {
    return 0.5 * std::pow(std::max(0.0, -axis().gap(t)), 2) / ends.complianceAt(t);
  }
  double energy() const { return energyAt(press().at); }

  static SprungStick random(std::mt19937& engine) {
    const auto upTo = [&](double most) {
      return std::uniform_real_distribution<double>(-most, most)(engine);
    };
    SprungStick s;
    s.a = Vec3(upTo(0.6), upTo(0.6), 0.2 + upTo(0.1));
    s.b = Vec3(upTo(0.6), upTo(0.6), 0.2 + upTo(0.1));
    s.ra += upTo(0.03);
    s.rb += upTo(0.03);
    s.ends.a.compliance *= std::exp(upTo(1));
    s.ends.b.compliance *= std::exp(upTo(1));
    return s;
  }
};

/// At random: no other place along the stick holds more.
TEST(StickSprings, PressWhereTheyHoldMost) {
  std::mt19937 engine(4);
  constexpr int kPlaces = 2000;
  int pressed = 0, between = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const SprungStick s = SprungStick::random(engine);
    double most = 0;
    for (int k = 0; k <= kPlaces; ++k)
      most = std::max(most, s.energyAt(static_cast<double>(k) / kPlaces));
    const StickPress press = s.press();
    pressed += press.depth > 0;
    between += press.between;
    EXPECT_NEAR(press.depth, -s.axis().gap(press.at), 1e-14) << sample;
    EXPECT_GE(s.energy(), most * (1 - 1e-12)) << sample;
  }
  EXPECT_GT(pressed, 200);
  EXPECT_GT(between, 20);
}

/// The force is what the energy has as a slope when an end moves, also where the place is between
/// two faces within the box.
TEST(StickSprings, ForceIsTheSlopeOfTheirEnergy) {
  std::mt19937 engine(5);
  int kinks = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const SprungStick s = SprungStick::random(engine);
    const StickPress press = s.press();
    if (press.depth < 1e-3) continue;
    kinks += press.share < 1 - 1e-9;
    const Vec3 force = press.force(s.ends) * press.share * press.normal;
    for (const bool end : {false, true})
      for (int k = 0; k < 3; ++k) {
        const double e = 1e-6;
        SprungStick less = s, more = s;
        (end ? less.b : less.a)[k] -= e;
        (end ? more.b : more.a)[k] += e;
        const double slope = (more.energy() - less.energy()) / (2 * e);
        EXPECT_NEAR(-(end ? press.at : 1 - press.at) * force[k], slope, 1e-4 * force.norm())
            << sample << (end ? "b" : "a") << k;
      }
  }
  EXPECT_GT(kinks, 10);
}

/// All of it over a face: forces and place of two springs that know nothing of each other.
TEST(StickSprings, OnAFaceAreTheEndsOwn) {
  SprungStick s{Vec3(-0.2, 0.1, 0.24), Vec3(0.3, 0, 0.22)};
  s.ends.b.compliance = 3e-4;
  const double at_a = 0.01 / s.ends.a.compliance, at_b = 0.03 / s.ends.b.compliance;
  const StickPress press = s.press();
  EXPECT_NEAR(press.force(s.ends), at_a + at_b, 1e-9 * (at_a + at_b));
  EXPECT_NEAR(press.at, at_b / (at_a + at_b), 1e-9);
  EXPECT_LT((press.normal - Vec3::UnitZ()).norm(), 1e-14);
  EXPECT_TRUE(press.flat);
  EXPECT_FALSE(press.between);
  EXPECT_NEAR(press.excess, 0, 1e-12);
}

/// Over two edges, in the middle: the ends hang beside the box by what their springs are long, and
/// the stick is as stiff as both.
TEST(StickSprings, BetweenTheEndsCarryIt) {
  const SprungStick s{Vec3(-1, 0, 0.23), Vec3(1, 0, 0.23)};
  const StickPress press = s.press();
  EXPECT_NEAR(press.at, 0.5, 1e-9);
  EXPECT_NEAR(press.force(s.ends), 2 * 0.02 / 1e-4, 1e-9);
  EXPECT_TRUE(press.between);
  EXPECT_NEAR(press.excess, 0.02, 1e-12);
  const SprungStick above{s.a + 0.03 * Vec3::UnitZ(), s.b + 0.03 * Vec3::UnitZ()};
  EXPECT_NEAR(pressedAt(above.axis(), press).depth, -0.01, 1e-14);
  EXPECT_EQ(pressedAt(above.axis(), press).at, press.at);
}

/// The dampers take the power that those of the ends do, which move as their springs give way.
TEST(StickSprings, DampAsTheirEndsDo) {
  const StickEnds ends{{1e-4, 30}, {3e-4, 40}};
  for (const double t : {0.0, 0.3, 1.0}) {
    const double force_a = 1 - t, force_b = t;  // of 1 N at t
    const double way_a = force_a * 1e-4, way_b = force_b * 3e-4;
    const double way = force_a * way_a + force_b * way_b;
    EXPECT_NEAR(ends.complianceAt(t), way, 1e-18);
    EXPECT_NEAR(ends.dampingAt(t) * way * way, 30 * way_a * way_a + 40 * way_b * way_b, 1e-18);
  }
}

/// Where two sticks meet, each has half of the particle's spring and damper.
TEST(StickSprings, OfAParticleAreSharedByItsSticks) {
  const World world(chainOnASoftBox());
  const Obstacle& o = world.model.obstacles[0];
  const Ragdoll& r = world.model.ragdolls[0];
  EXPECT_EQ(sticksAt(world.model, o, r, 0), 1);
  EXPECT_EQ(sticksAt(world.model, o, r, 1), 2);
  const StickEnds ends = endsOf(world.model, o, r, 1, 2, o.contact);
  EXPECT_DOUBLE_EQ(1 / ends.a.compliance, 1000);
  EXPECT_DOUBLE_EQ(ends.a.damping, 6);
  EXPECT_DOUBLE_EQ(1 / ends.b.compliance, 2000);
  EXPECT_DOUBLE_EQ(ends.b.damping, 12);
}

}  // namespace
}  // namespace ragdoll
