// Normally distributed numbers whose bits are specified: SplitMix64 [Steele2014] for the bits, the
// polar method [Marsaglia1964] for the shape, and a logarithm of its own, as that of the C library
// may differ from one to the next. Only +, -, *, / and the square root, which IEEE 754 fixes.
#include <cmath>

#include "ragdoll_sim/world/imu.h"

namespace ragdoll {
namespace {

std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t state) : state_(state) {}
  /// In [-1, 1), of 53 random bits.
  double symmetric() {
    state_ += 0x9e3779b97f4a7c15u;
    return static_cast<double>(mixed(state_) >> 11) * 0x1p-52 - 1;
  }

 private:
  std::uint64_t state_;
};

/// ln x for x in (0, 1), by ln m = 2 artanh((m - 1) / (m + 1)).
double logarithm(double x) {
  constexpr double kLn2 = 0.69314718055994530942;
  constexpr int kTerms = 12;  // s^25 / 25 is below 1e-20
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752440) {
    m *= 2;
    --exponent;
  }
  const double s = (m - 1) / (m + 1), s2 = s * s;
  double sum = 0;
  for (int k = kTerms; k >= 0; --k) sum = sum * s2 + 1.0 / (2 * k + 1);
  return 2 * s * sum + exponent * kLn2;
}

}  // namespace

void normalNumbers(std::uint64_t stream, std::uint64_t n, int count, double* out) {
  SplitMix64 random(mixed(mixed(stream) + n));
  for (int i = 0; i < count;) {
    const double x = random.symmetric(), y = random.symmetric(), r2 = x * x + y * y;
    if (!(r2 > 0 && r2 < 1)) continue;
    const double scale = std::sqrt(-2 * logarithm(r2) / r2);
    out[i++] = scale * x;
    if (i < count) out[i++] = scale * y;
  }
}

}  // namespace ragdoll
