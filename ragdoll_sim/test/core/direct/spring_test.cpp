#include "core/direct/spring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ragdoll {
namespace {

constexpr double kStiffness = 2000, kDamping = 15;  ///< [N/m], [N s/m]
constexpr double kSprungMass = 2;                   ///< [kg]
constexpr double kAnswer = 1 / kSprungMass;

/// Of a spring, `before` [m] from its surface at the motion's start.
Contact springContact(double before, double damping = kDamping) {
  Contact c;
  c.give = {1 / kStiffness, damping};
  c.before = before;
  return c;
}

/// Where a row is zero its p is that of the spring's force: by the middle of the motion in
/// leapfrog, by its end in backward Euler. What begins above the surface is met there.
TEST(Spring, RowIsZeroWhereItsForceIs) {
  const double h = 0.004, p = 0.003;
  for (const double before : {-0.01, 0.02}) {
    const Contact c = springContact(before);
    const double start = std::min(before, 0.0);
    const SpringRow middle = springRow(c.give, c.before, h, kAnswer, true),
                    end = springRow(c.give, c.before, h, kAnswer, false);
    const double gap_middle = -middle.slack(0, p), gap_end = -end.slack(0, p);
    const double damping = effectiveDamping(c.give, h, kAnswer);
    EXPECT_NEAR(p,
                0.5 * h * h *
                    (-0.5 * kStiffness * (start + gap_middle) - damping * (gap_middle - start) / h),
                1e-15);
    EXPECT_NEAR(p, h * h * (-kStiffness * gap_end - kDamping * (gap_end - start) / h), 1e-15);
  }
}

TEST(Spring, DamperIsOfSecondOrderInTheStep) {
  const auto error = [](double h) {
    return kDamping - effectiveDamping({1 / kStiffness, kDamping}, h, kAnswer);
  };
  EXPECT_GT(error(2e-3), 1e-4);
  EXPECT_NEAR(error(2e-3) / error(1e-3), 4, 0.02);
}

/// Gap and rate of a free mass on it after a step of leapfrog.
Eigen::Vector2d stepped(double gap, double rate, double damping, double h) {
  const SpringRow row = springRow(springContact(gap, damping).give, gap, h, kAnswer, true);
  const double free = gap + h * rate, p = -row.slack(free, 0) / (kAnswer + row.compliance);
  return {free + kAnswer * p, rate + 2 / h * kAnswer * p};
}

/// However strong it is, a step does not turn both ways in which gap and rate go: their
/// determinant, (1 + q - x) / (1 + q + x) by x = d h / 2m and q = k h^2 / 4m, stays positive.
TEST(Spring, DamperNeverThrowsBack) {
  for (const double damping : {0.0, 10.0, 1e3, 1e6})
    for (const double h : {1e-4, 1e-2, 1.0}) {
      Eigen::Matrix2d map;
      map << -stepped(-1, 0, damping, h), -stepped(0, -1, damping, h);
      EXPECT_GT(map.determinant(), 0) << damping << " " << h;
      EXPECT_LE(map.determinant(), 1 + 1e-12) << damping << " " << h;
    }
}

/// A mass that a spring lets go has what the spring held as kinetic energy.
TEST(Spring, LetsGoWithTheEnergyThatItHeld) {
  const double h = 0.02, before = -0.01, half = 0.1;
  for (const double damping : {0.0, kDamping}) {
    const Contact c = springContact(before, damping);
    const SpringRow row = springRow(c.give, c.before, h, kAnswer, true);
    const double rate = 0.6, gap = before + h * (rate + kAnswer * half);
    const double force = -kStiffness * before - damping * rate;
    ASSERT_TRUE(gap > 0 && force > 0);
    const double after = rate + kAnswer * releaseImpulse(c.give, c.before, row, gap, half, h);
    EXPECT_NEAR(0.5 * kSprungMass * (after * after - rate * rate), 0.5 * force * force / kStiffness,
                1e-14);
  }
  const SpringRow row = springRow(springContact(before).give, before, h, kAnswer, true);
  EXPECT_EQ(releaseImpulse(springContact(before).give, before, row, -0.005, half, h), 0)
      << "still pressed";
  EXPECT_EQ(releaseImpulse(springContact(0.01).give, 0.01, row, 0.02, half, h), 0)
      << "never pressed";
}

/// A mass that meets a spring and a damper under a constant force, in closed form.
struct Landed {
  double damping, speed, other;  ///< [N s/m]; [m/s] at which it comes; [N] out of the surface
  double decay = 0.5 * damping * kAnswer;
  double w = std::sqrt(kStiffness * kAnswer - decay * decay);
  double rest = other / kStiffness;  ///< [m] gap at which all balances

  double gap(double t) const {
    const double cosine = -rest, sine = (-speed - decay * rest) / w;
    return rest + std::exp(-decay * t) * (cosine * std::cos(w * t) + sine * std::sin(w * t));
  }
  double rate(double t) const { return (gap(t + 1e-5) - gap(t - 1e-5)) / 2e-5; }
  double force(double t) const { return -kStiffness * gap(t) - damping * rate(t); }
  SpringMotion until(double h) const {
    SpringMotion m;
    m.h = h;
    for (int i = 0; i < 2; ++i) m.gap[i] = gap(i * h), m.rate[i] = rate(i * h);
    m.answer = kAnswer;
    m.force = (m.rate[1] - m.rate[0]) * kSprungMass / h - other;
    return m;
  }
};

/// Inside a motion that it ends on its way out, or at the end of one that still presses.
TEST(Spring, PeakIsTheLargestForceOfTheMotion) {
  for (const double damping : {0.0, kDamping, 60.0})
    for (const double other : {0.0, -kSprungMass * 9.81}) {
      const Landed one{damping, 1.5, other};
      for (const double turns : {0.2, 0.7}) {  // of half a period
        const double h = turns * M_PI / one.w;
        double largest = 0;
        for (int i = 0; i <= 10000; ++i) largest = std::max(largest, one.force(1e-4 * i * h));
        EXPECT_NEAR(peakForce(springContact(0, damping), one.until(h)), largest, 1e-6 * largest)
            << damping << " " << other << " " << turns;
      }
    }
}

}  // namespace
}  // namespace ragdoll
