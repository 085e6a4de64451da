// Three rods in a chain, hung up, of which the first two bend only so far: against the Lagrangian
// in their angles, integrated apart from the product's code. The stop is reached inside a step and
// pressed upon.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "support/gravity.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kLength = 0.4, kMass = 1.5;    ///< [m], [kg] of each rod
constexpr double kCom = 0.45, kGyration = 0.3;  ///< fractions of the length
const Vec3 kStart(1.2, 1.0, 0.3);               ///< [rad] from hanging
const Vec3 kStartRate(-2, 12, -14);             ///< [rad/s]
constexpr double kStop = 0.3;                   ///< [rad] between the first two
constexpr double kChainSeconds = 0.4;

struct Chain {
  Vec3 angle, rate;  ///< of the rods, from hanging
};

/// Kinetic energy 1/2 sum m_ij cos(angle_i - angle_j) rate_i rate_j; `moment`: of the weights.
struct Inertia {
  Eigen::Matrix3d m;
  Vec3 moment;

  Inertia() {
    const double l = kLength, c = kCom * l, own = kMass * (c * c + std::pow(kGyration * l, 2));
    for (int i = 0; i < 3; ++i) {
      const int below = 2 - i;  // rods that hang on its end
      m(i, i) = own + below * kMass * l * l;
      for (int j = 0; j < i; ++j) m(i, j) = m(j, i) = l * (kMass * c + below * kMass * l);
      moment[i] = kG * (kMass * c + below * kMass * l);
    }
  }
};

/// Unit torque of the stop, which turns the first rod on and the second back.
const Vec3 kPress(1, -1, 0);

Eigen::Matrix3d massAt(const Vec3& angle) {
  static const Inertia inertia;
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = inertia.m(i, j) * std::cos(angle[i] - angle[j]);
  return m;
}

/// Angular accelerations; `held`: of a chain whose first two rods keep their angle.
Vec3 accelerations(const Chain& c, bool held) {
  static const Inertia inertia;
  Vec3 torque;
  for (int i = 0; i < 3; ++i) {
    torque[i] = -inertia.moment[i] * std::sin(c.angle[i]);
    for (int j = 0; j < 3; ++j)
      torque[i] -= inertia.m(i, j) * std::sin(c.angle[i] - c.angle[j]) * c.rate[j] * c.rate[j];
  }
  const Eigen::Matrix3d W = massAt(c.angle).inverse();
  Vec3 a = W * torque;
  if (held) a -= W * kPress * kPress.dot(a) / kPress.dot(W * kPress);
  return a;
}

/// A step of the classic Runge-Kutta method.
Chain chainAfter(const Chain& c, double h, bool held) {
  const auto at = [&](const Chain& k, double share) {
    return Chain{c.angle + share * h * k.angle, c.rate + share * h * k.rate};
  };
  const auto rates = [&](const Chain& k) { return Chain{k.rate, accelerations(k, held)}; };
  const Chain k1 = rates(c), k2 = rates(at(k1, 0.5)), k3 = rates(at(k2, 0.5)),
              k4 = rates(at(k3, 1));
  return {c.angle + h / 6 * (k1.angle + 2 * k2.angle + 2 * k3.angle + k4.angle),
          c.rate + h / 6 * (k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate)};
}

double bend(const Chain& c) { return c.angle[1] - c.angle[0]; }

struct Stopped {
  Chain end;
  double impact = 0;   ///< [rad/s] at which the bend grew when it was stopped, at most
  double pressed = 0;  ///< [s] for so long
};

Stopped byLagrangian(int steps) {
  const double h = kChainSeconds / steps;
  Stopped out{{kStart, kStartRate}};
  Chain& c = out.end;
  bool held = false;
  for (int n = 0; n < steps; ++n) {
    held = held && kPress.dot(accelerations(c, false)) < 0;
    const Chain next = chainAfter(c, h, held);
    if (held || bend(next) < kStop || kPress.dot(next.rate) > 0) {
      c = next;
      out.pressed += held ? h : 0;
      continue;
    }
    double lo = 0, hi = h;
    for (int i = 0; i < 60; ++i)
      (bend(chainAfter(c, 0.5 * (lo + hi), false)) < kStop ? lo : hi) = 0.5 * (lo + hi);
    c = chainAfter(c, lo, false);
    out.impact = std::max(out.impact, -kPress.dot(c.rate));
    const Eigen::Matrix3d W = massAt(c.angle).inverse();
    c.rate -= W * kPress * kPress.dot(c.rate) / kPress.dot(W * kPress);
    held = kPress.dot(accelerations(c, false)) < 0;
    c = chainAfter(c, h - lo, held);
  }
  return out;
}

Points particlesOf(const Vec3& angle) {
  Points x = Points::Zero(3, 4);
  for (int i = 0; i < 3; ++i)
    x.col(i + 1) = x.col(i) + kLength * Vec3(std::sin(angle[i]), 0, -std::cos(angle[i]));
  return x;
}

/// [m] RMS after kSeconds at so many steps per second.
double chainError(Method method, int rate) {
  static const Points exact = particlesOf(byLagrangian(8000).end.angle);
  const int steps = static_cast<int>(std::lround(kChainSeconds * rate));
  const Points x = particlesOf(kStart);
  const std::vector<std::string> names = {"a", "b", "c", "d"};
  SkeletonSpec s;
  s.name = "chain";
  for (int i = 0; i < 4; ++i) s.particles.push_back(particle(names[i], x.col(i), 0));
  for (int i = 0; i < 3; ++i) {
    s.sticks.push_back(stick(names[i], names[i + 1]));
    s.segments.push_back(bone("rod_" + names[i], names[i], names[i + 1]));
    s.segments.back().mass = kMass;
    s.segments.back().com = kCom;
    s.segments.back().gyration = kGyration;
  }
  s.joints = {cone("stop", "rod_a", "rod_b", x.col(1), deg(kStop))};
  Scene scene = sceneOf(s);
  scene.pins = {pinOf("a")};
  scene.solver.method = method;
  scene.solver.events = true;  // of rk
  scene.solver.step = kChainSeconds / steps;
  World world(scene);
  for (int i = 0; i < 3; ++i)
    world.state.v.col(i + 1) =
        world.state.v.col(i) +
        kLength * kStartRate[i] * Vec3(std::cos(kStart[i]), 0, std::sin(kStart[i]));
  world.steps(steps);
  return std::sqrt((world.state.x - exact).squaredNorm() / 4);
}

/// Least-squares slope of log error over log step; no rate is a multiple of another, so that the
/// stop falls anywhere in its step.
double orderOfTheChain(Method method) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const std::vector<int> rates = {160, 230, 310, 440, 610, 890, 1270, 1810};
  for (const int rate : rates) {
    const double x = -std::log(rate), y = std::log(chainError(method, rate));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double n = static_cast<double>(rates.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(Stop, OfTheReferenceIsReachedAndPressedUpon) {
  const Stopped coarse = byLagrangian(4000), fine = byLagrangian(8000);
  EXPECT_LT((particlesOf(coarse.end.angle) - particlesOf(fine.end.angle)).norm(), 1e-12);
  EXPECT_GT(fine.impact, 10);
  EXPECT_GT(fine.pressed, 0.2);
}

TEST(Stop, IsLocatedInTheStepSoThatTheOrderStays) {
  EXPECT_NEAR(orderOfTheChain(Method::kShake), 2, 0.02);
  for (const int rate : {60, 240, 890}) {
    EXPECT_LT(chainError(Method::kShake, rate), 40.0 / (rate * rate)) << rate;
  }
}

TEST(Stop, IsAnEventOfRkWhichKeepsItsOrderThroughIt) {
  EXPECT_LT(chainError(Method::kRk, 120), 1e-6);
  EXPECT_LT(chainError(Method::kRk, 480), 1e-9);
  EXPECT_NEAR(orderOfTheChain(Method::kRk), 5, 0.5);
}

}  // namespace
}  // namespace ragdoll
