// Where a convex function of one parameter is least, by golden sections [Kiefer1953].
#pragma once

namespace ragdoll {

/// In [lo, hi], to 1e-7 of that.
template <class Function>
double goldenSection(const Function& value, double lo, double hi) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSectionSteps = 32;
  double s1 = hi - kGolden * (hi - lo), s2 = lo + kGolden * (hi - lo);
  double f1 = value(s1), f2 = value(s2);
  for (int i = 0; i < kSectionSteps; ++i) {
    if (f1 <= f2) {
      hi = s2, s2 = s1, f2 = f1, s1 = hi - kGolden * (hi - lo), f1 = value(s1);
    } else {
      lo = s1, s1 = s2, f1 = f2, s2 = lo + kGolden * (hi - lo), f2 = value(s2);
    }
  }
  return 0.5 * (lo + hi);
}

}  // namespace ragdoll
