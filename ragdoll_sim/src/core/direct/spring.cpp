#include "core/direct/spring.h"

#include <algorithm>
#include <cmath>

#include "core/contact/first_touch.h"

namespace ragdoll {

double effectiveDamping(const Compliance& give, double h, double answer) {
  // Of a free mass the product of a step's two eigenvalues is (1 + q - y) / (1 + q + y), y = x /
  // sqrt(1 + x^2 / (1 + q)^2) < 1 + q: no step turns both. x - y is of third order in h.
  const double x = 0.5 * give.damping * h * answer, q = 0.25 * h * h * answer / give.compliance;
  return give.damping / std::hypot(1.0, x / (1 + q));
}

SpringRow springRow(const Compliance& give, double before, double h, double answer, bool leapfrog) {
  const double start = std::min(0.0, before), k = 1 / give.compliance;
  if (!leapfrog) {
    const double damper = give.damping / h;
    return {-damper / (k + damper) * start, 1 / (h * h * (k + damper)), answer};
  }
  const double spring = 0.5 * k, damper = effectiveDamping(give, h, answer) / h;
  return {(spring - damper) / (spring + damper) * start, 2 / (h * h * (spring + damper)), answer};
}

double releaseImpulse(const Compliance& give, double before, const SpringRow& row, double gap,
                      double half, double h) {
  if (!(before < 0)) return 0;
  const double k = 1 / give.compliance, mean = (gap - before) / h;
  const double rate = mean - row.answer * half;  // at the start
  const double force = -k * before - give.damping * rate;
  if (!(force > 0 && rate > 0 && -k * gap - give.damping * mean < 0)) return 0;
  // impulse (rate + answer impulse / 2) = F^2 / 2k
  const double twice = force * force / k;
  return twice / (rate + std::sqrt(rate * rate + row.answer * twice));
}

namespace {

/// [N] the largest inside a motion, where a mass on a spring and a damper under a constant force
/// has its largest there: all told swing about the force that balances what else acts. 0: it has
/// not.
double dampedPeak(const Contact& c, const SpringMotion& m) {
  const double k = 1 / c.give.compliance, d = c.give.damping;
  const double decay = 0.5 * d * m.answer, square = k * m.answer - decay * decay;
  if (!(d > 0 && m.gap[0] <= kResting && square > 0)) return 0;
  const double balance = m.force - (m.rate[1] - m.rate[0]) / (m.h * m.answer);
  const double start = -k * m.gap[0] - d * m.rate[0] - balance;
  const double grows = -k * m.rate[0] - d * m.answer * start;
  if (!(grows > 0)) return 0;
  const double w = std::sqrt(square), sine = (grows + decay * start) / w;
  const double phase = std::atan2(grows, w * start + decay * sine), t = phase / w;
  if (t > m.h) return 0;
  return balance + std::exp(-decay * t) * (start * std::cos(phase) + sine * std::sin(phase));
}

}  // namespace

double peakForce(const Contact& c, const SpringMotion& m) {
  const double k = 1 / c.give.compliance;
  double peak = std::max(m.force, dampedPeak(c, m));
  for (int i = 0; i < 2; ++i)
    if (m.gap[i] <= 0) peak = std::max(peak, -k * m.gap[i] - c.give.damping * m.rate[i]);
  if (!(m.rate[0] < 0 && m.rate[1] > 0 && m.answer > 0)) return peak;
  const double deepest = -std::min(m.gap[0], m.gap[1]);
  // [m] where the spring would balance what else acts: -d rate / h = -answer (force + other).
  const double balance = -((m.rate[1] - m.rate[0]) / (m.h * m.answer) - m.force) / k;
  const double swing = std::hypot(-m.gap[1] - balance, m.rate[1] / std::sqrt(k * m.answer));
  const double reach = deepest + m.h * std::max(-m.rate[0], m.rate[1]);  // no motion goes beyond
  return std::max(peak, k * std::min(balance + swing, reach));
}

}  // namespace ragdoll
