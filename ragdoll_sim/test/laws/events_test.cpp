// `method: rk` through contact, from event to event: against closed forms, and against integrations
// of single coordinates apart from the product's code. docs/equations.md#event-driven-rk.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/across_slope.h"
#include "support/event_steps.h"
#include "support/gravity.h"
#include "support/limbs.h"

namespace ragdoll::test {
namespace {

Scene rkSceneOf(const SkeletonSpec& skeleton, const Vec3& position, const ObstacleSpec& obstacle) {
  Scene scene = sceneOf(skeleton, position);
  scene.gravity = Vec3(0, 0, -kG);
  scene.obstacles.push_back(obstacle);
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = kStep;
  return scene;
}

/// A plane through the origin that rises along x.
ObstacleSpec slope(double angle, double friction, double restitution = 0) {
  ObstacleSpec plane = floorPlane(friction, restitution);
  plane.normal = Vec3(-std::sin(angle), 0, std::cos(angle));
  return plane;
}

/// Way along the slope of a block that is pushed up at `speed`, slows down, and stays or slides
/// back.
double wayOnSlope(double angle, double friction, double speed, double time) {
  const double up = kG * (std::sin(angle) + friction * std::cos(angle));
  const double back = std::max(0.0, kG * (std::sin(angle) - friction * std::cos(angle)));
  const double stop = speed / up;
  if (time < stop) return speed * time - 0.5 * up * time * time;
  return 0.5 * speed * stop - 0.5 * back * (time - stop) * (time - stop);
}

TEST(Events, ABlockOnASlopeStopsAndStaysOrSlidesBack) {
  const double angle = 0.35, radius = 0.1, speed = 1.7;
  const Vec3 along(std::cos(angle), 0, std::sin(angle)), up(-std::sin(angle), 0, std::cos(angle));
  for (const double friction : {0.6, 0.2, 0.0}) {
    Scene scene = rkSceneOf(oneParticle(3, radius), radius * up, slope(angle, friction));
    scene.ragdolls[0].velocity = speed * along;
    World world(scene);
    int handed_over = 0;
    for (int n = 1; n <= 120; ++n) {
      handed_over += world.steps(1).handed_over;
      const Vec3 exact = radius * up + wayOnSlope(angle, friction, speed, n * kStep) * along;
      ASSERT_LT((world.x(0) - exact).norm(), kNear) << friction << ", step " << n;
    }
    EXPECT_EQ(handed_over, 0);
    if (friction > std::tan(angle)) {
      EXPECT_LT(world.v(0).norm(), kNear);
    }
  }
}

/// A hop of less than a nanometre: in the air nothing rubs, and the landing does at once.
TEST(Events, ABlockThatHopsAsItSlidesHasFrictionFromItsLandingOn) {
  const double radius = 0.1, friction = 0.6, hop = 1e-4;  // [m/s]
  Scene scene = rkSceneOf(oneParticle(3, radius), Vec3(0, 0, radius), floorPlane(friction));
  scene.ragdolls[0].velocity = Vec3(1, 0, hop);
  World world(scene);
  EXPECT_EQ(world.steps(1).handed_over, 0);
  const double air = 2 * hop / kG, rest = kStep - air;
  const double landed = 1 - friction * hop;
  EXPECT_NEAR(world.v(0).x(), landed - friction * kG * rest, 1e-10);
  EXPECT_NEAR(world.x(0).x(), air + landed * rest - 0.5 * friction * kG * rest * rest, 1e-11);
}

TEST(Events, ABlockThatSlidesAcrossASlopeTurnsIntoTheLineOfFall) {
  Scene scene = AcrossSlope::scene();
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = kStep;
  World world(scene);
  world.steps(static_cast<int>(std::lround(AcrossSlope::kTime / kStep)));
  EXPECT_LT((world.x(0) - AcrossSlope::end()).norm(), kNear);
}

/// On a slope at the angle of friction it creeps on at constant speed, once its way has turned: v
/// (1 + cos psi) stays, psi its angle to the line of fall. Friction turns it within 1e-7 s.
/// Explicit pieces would have to be as short: the steps were handed over.
TEST(Events, ABallThatCreepsDownASlopeTurnsIntoTheLineOfFallAtOnce) {
  const double angle = 0.5, radius = 0.05, speed = 1e-6, aside = 0.5, time = 0.5;
  Scene scene = rkSceneOf(oneParticle(1, radius), Vec3(0, 0, radius), floorPlane(std::tan(angle)));
  scene.gravity = kG * Vec3(std::sin(angle), 0, -std::cos(angle));
  scene.ragdolls[0].velocity = speed * Vec3(std::cos(aside), std::sin(aside), 0);
  World world(scene);
  EXPECT_EQ(world.steps(static_cast<int>(std::lround(time / kStep))).handed_over, 0);
  const double creeps = 0.5 * speed * (1 + std::cos(aside));
  EXPECT_LT((world.x(0) - Vec3(creeps * time, 0, radius)).norm(), 1e-10);
}

/// Where a ball is after `time` that starts at `speed` up a slope, but for `aside` [rad], with the
/// coordinates down the slope and across. With u = ln tan(angle to the line of fall / 2), s = g
/// sin(slope) and k = friction/tan(slope): v = C exp(k u) cosh u, du/dt = -s/v.
Eigen::Vector2d turningBack(double slope, double friction, double speed, double aside,
                            double time) {
  const double s = kG * std::sin(slope), k = friction / std::tan(slope);
  const double start = std::log(std::tan(0.5 * (M_PI - aside)));
  const double C = speed / (std::exp(k * start) * std::cosh(start));
  const auto power = [](double exponent, double u) { return std::exp(exponent * u) / exponent; };
  const auto when = [&](double u) { return C / (2 * s) * (power(k + 1, u) + power(k - 1, u)); };
  double lo = -60, hi = start;
  for (int i = 0; i < 100; ++i) {
    const double u = 0.5 * (lo + hi);
    (when(start) - when(u) > time ? lo : hi) = u;
  }
  const auto down = [&](double u) {
    return -C * C / (4 * s) * (power(2 * k + 2, u) - power(2 * k - 2, u));
  };
  const auto across = [&](double u) {
    return C * C / (2 * s) * (power(2 * k + 1, u) + power(2 * k - 1, u));
  };
  return {down(start) - down(lo), across(start) - across(lo)};
}

/// Friction turns by half a turn within a millisecond, while it slips at a millimetre per second.
TEST(Events, ABallThatAllButStopsOnASlopeTurnsBack) {
  const double angle = 0.5, friction = 0.4, aside = 1e-3, radius = 0.05, time = 0.5;
  Scene scene = rkSceneOf(oneParticle(1, radius), Vec3(0, 0, radius), floorPlane(friction));
  scene.gravity = kG * Vec3(std::sin(angle), 0, -std::cos(angle));
  scene.ragdolls[0].velocity = Vec3(-std::cos(aside), std::sin(aside), 0);
  World world(scene);
  EXPECT_EQ(world.steps(static_cast<int>(std::lround(time / kStep))).handed_over, 0);
  const Eigen::Vector2d exact = turningBack(angle, friction, 1, aside, time);
  EXPECT_LT((world.x(0).head<2>() - exact).norm(), 1e-10);
}

/// Height of a ball that is dropped and bounces.
double bouncing(double height, double restitution, double time) {
  double speed = 0;
  for (;;) {
    const double flight = (speed + std::sqrt(speed * speed + 2 * kG * height)) / kG;
    if (time < flight) return height + speed * time - 0.5 * kG * time * time;
    speed = restitution * (kG * flight - speed);
    height = 0;
    time -= flight;
  }
}

TEST(Events, ABallBouncesAsOftenAsItShould) {
  const double radius = 0.1, height = 0.8;
  for (const double restitution : {1.0, 0.8}) {
    Scene scene = rkSceneOf(oneParticle(2, radius), Vec3(0, 0, radius + height),
                            floorPlane(0.4, restitution));
    World world(scene);
    int handed_over = 0;
    for (int n = 1; n <= 300; ++n) {
      handed_over += world.steps(1).handed_over;
      ASSERT_NEAR(world.x(0).z() - radius, bouncing(height, restitution, n * kStep), kNear)
          << restitution << ", step " << n;
    }
    EXPECT_EQ(handed_over, 0);
  }
}

/// A ball on top of a smooth sphere leaves it where cos = 2/3 of the start's; until then the angle
/// obeys a pendulum's law.
TEST(Events, ABallLeavesASphereThatItSlidesOff) {
  ObstacleSpec sphere;
  sphere.type = ObstacleSpec::Type::kSphere;
  sphere.radius = 0.4;
  sphere.friction = 0;
  const double radius = 0.1, reach = 0.5, start = 0.3;
  Scene scene =
      rkSceneOf(oneParticle(1, radius), reach * Vec3(std::sin(start), 0, std::cos(start)), sphere);
  World world(scene);
  const int steps = 72;
  world.steps(steps);
  // By the angle, in steps so fine that the last one on the sphere is found by halving.
  double angle = start, rate = 0, time = 0;
  const auto move = [&](double h, double& a, double& w) {
    const auto acc = [&](double q) { return kG / reach * std::sin(q); };
    const double k1 = acc(a), k2 = acc(a + 0.5 * h * w),
                 k3 = acc(a + 0.5 * h * w + 0.25 * h * h * k1),
                 k4 = acc(a + h * w + 0.5 * h * h * k2);
    a += h * w + h * h / 6 * (k1 + k2 + k3);
    w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  };
  const auto presses = [&](double a, double w) { return kG * std::cos(a) > reach * w * w; };
  double h = 1e-5;
  while (h > 1e-16) {
    double a = angle, w = rate;
    move(h, a, w);
    if (!presses(a, w)) {
      h *= 0.5;
      continue;
    }
    angle = a, rate = w, time += h;
  }
  EXPECT_NEAR(std::cos(angle), 2.0 / 3 * std::cos(start), 1e-9);
  const double left = steps * kStep - time;
  ASSERT_GT(left, 0.02);
  const Vec3 exact = reach * Vec3(std::sin(angle), 0, std::cos(angle)) +
                     left * reach * rate * Vec3(std::cos(angle), 0, -std::sin(angle)) -
                     0.5 * kG * left * left * Vec3::UnitZ();
  EXPECT_LT((world.x(0) - exact).norm(), kNear);
}

/// A rod of two equal balls on a smooth floor, one above the other: its middle falls straight down,
/// the upper ball lands and bounces while the lower one stays. One coordinate, the angle to the
/// floor.
struct Rocking {
  double half, angle, rate = 0;

  double acceleration(double q, double w) const {
    // per mass: half^2 (cos^2 + 1) q'' - half^2 sin cos q'^2 + g half cos = 0
    const double c = std::cos(q), s = std::sin(q);
    return (s * c * w * w - kG / half * c) / (c * c + 1);
  }
  void move(double h) {
    const double a1 = acceleration(angle, rate), w2 = rate + 0.5 * h * a1,
                 a2 = acceleration(angle + 0.5 * h * rate, w2), w3 = rate + 0.5 * h * a2,
                 a3 = acceleration(angle + 0.5 * h * w2, w3), w4 = rate + h * a3,
                 a4 = acceleration(angle + h * w3, w4);
    angle += h / 6 * (rate + 2 * w2 + 2 * w3 + w4);
    rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  /// The lower ball's force per weight of both.
  double pressure() const {
    const double c = std::cos(angle), s = std::sin(angle);
    return 1 + half / kG * (c * acceleration(angle, rate) - s * rate * rate);
  }
};

TEST(Events, ARodTopplesLandsAndRocks) {
  const double radius = 0.05, restitution = 0.5;
  Rocking exact{0.5, 0.6};
  World world([&] {
    Scene scene = rkSceneOf(oneStick(1, 1, radius), Vec3(0, 0, radius), floorPlane(0, restitution));
    scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(-exact.angle, Vec3::UnitY()));
    return scene;
  }());
  int bounces = 0, handed_over = 0;
  for (int n = 1; n <= 108; ++n) {
    handed_over += world.steps(1).handed_over;
    double left = kStep;
    while (left > 0) {
      Rocking next = exact;
      const double h = std::min(left, 1e-4);
      next.move(h);
      if (next.angle > 0) {
        exact = next;
        left -= h;
        ASSERT_GT(exact.pressure(), 0);
        continue;
      }
      double lo = 0, hi = h;
      for (int i = 0; i < 60; ++i) {
        Rocking middle = exact;
        middle.move(0.5 * (lo + hi));
        (middle.angle > 0 ? lo : hi) = 0.5 * (lo + hi);
      }
      exact.move(lo);
      exact.rate *= -restitution;
      left -= lo;
      ++bounces;
    }
    ASSERT_NEAR(world.x(1).z() - radius, 2 * exact.half * std::sin(exact.angle), kNear) << n;
    ASSERT_NEAR(world.x(0).z(), radius, kNear) << n;
  }
  EXPECT_GE(bounces, 2);
  EXPECT_EQ(handed_over, 0);
}

/// Two balls of equal mass on a stick, of which the lower one stands: it sticks while the upper one
/// falls over, until it slides back. x, u: of the lower one.
struct Toppling {
  using State = Eigen::Vector4d;  ///< angle from upright, its rate, x, u
  double length, friction;
  bool slides = false;

  /// Rates of the state; push and pressure: on the floor, per mass of one ball.
  State rates(const State& s, double& push, double& pressure) const {
    const double c = std::cos(s[0]), d = std::sin(s[0]), w2 = length * s[1] * s[1];
    // Of the upper ball across the stick: a c + L angle'' = g d. Of both: 2 a + L (c angle'' - d
    // rate^2) = push, 2 g - L (d angle'' + c rate^2) = pressure; sliding back: push = mu pressure.
    const double a = slides ? (friction * (2 * kG - d * d * kG - c * w2) - c * d * kG + d * w2) /
                                  (2 - c * c - friction * c * d)
                            : 0;
    const double turn = kG * d - a * c;  // L angle''
    push = 2 * a + c * turn - d * w2;
    pressure = 2 * kG - d * turn - c * w2;
    return {s[1], turn / length, s[3], a};
  }
  double grip(const State& s) const {
    double push = 0, pressure = 0;
    rates(s, push, pressure);
    return friction * pressure - push;
  }
  State after(const State& s, double h) const {
    double push = 0, pressure = 0;
    const State k1 = rates(s, push, pressure), k2 = rates(s + 0.5 * h * k1, push, pressure),
                k3 = rates(s + 0.5 * h * k2, push, pressure),
                k4 = rates(s + h * k3, push, pressure);
    return s + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  /// Over `time` [s]; when it begins to slide.
  State move(State s, double time, double& began) {
    const double h = 2e-5;
    for (double t = 0; t < time - 1e-12;) {
      double step = std::min(h, time - t);
      if (!slides && grip(after(s, step)) < 0) {
        double lo = 0, hi = step;
        for (int i = 0; i < 60; ++i)
          (grip(after(s, 0.5 * (lo + hi))) > 0 ? lo : hi) = 0.5 * (lo + hi);
        s = after(s, lo);
        t += lo;
        began = t;
        slides = true;
        continue;
      }
      s = after(s, step);
      t += step;
    }
    return s;
  }
};

/// What begins to slip within a step goes on doing so: it was held where it stood until the step
/// ended.
TEST(Events, ARodThatTopplesBeginsToSlideWhereFrictionEnds) {
  const double radius = 0.05, angle = 0.3, time = 0.4;
  Toppling exact{1, 0.2};
  double began = 0;
  const Toppling::State end = exact.move({angle, 0, 0, 0}, time, began);
  ASSERT_TRUE(began > 0.1 && began < 0.35) << began;
  ASSERT_LT(end[2], -1e-4) << "it slides back";
  for (const double hz : {100, 300}) {
    Scene scene = rkSceneOf(oneStick(1, 1, radius), Vec3(0, 0, radius), floorPlane(exact.friction));
    scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(angle - 0.5 * M_PI, Vec3::UnitY()));
    scene.solver.step = 1 / hz;
    World world(scene);
    EXPECT_EQ(world.steps(static_cast<int>(std::lround(time * hz))).handed_over, 0);
    EXPECT_NEAR(world.x(0).x(), end[2], kNear) << hz;
    EXPECT_NEAR(world.x(1).x(), end[2] + exact.length * std::sin(end[0]), kNear) << hz;
    EXPECT_NEAR(world.v(0).x(), end[3], 1e-8) << hz;
  }
}

}  // namespace
}  // namespace ragdoll::test
