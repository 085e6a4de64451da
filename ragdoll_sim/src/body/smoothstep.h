#pragma once

#include <algorithm>

namespace ragdoll {

/// From 0 at `from` to 1 at `to`, flat at both ends.
inline double smoothstep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace ragdoll
