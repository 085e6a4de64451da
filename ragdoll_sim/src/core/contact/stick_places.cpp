#include "core/contact/stick_places.h"

#include <cmath>

#include "core/contact/constants.h"

namespace ragdoll {
namespace {

/// Which of them is nearer to a place t.
int nearer(const StickPlaces& places, double t) {
  return std::abs(places.at[1] - t) < std::abs(places.at[0] - t) ? 1 : 0;
}

}  // namespace

StickPlaces placesOf(const Axis& axis, const Compliance& give, double reach) {
  const double t = nearest(axis);
  // The only one to lie flat on; a spring at its ends is enough, and does not come and go.
  if (axis.obstacle.type != ObstacleSpec::Type::kBox || give.compliance > 0) return {{t, t}, false};
  const auto farthest = [&](double end) {
    const double at = flatEnd(axis, t, end);
    return axis.gap(at) > reach ? t : at;
  };
  const double lo = farthest(0), hi = farthest(1);
  if (hi - lo > kStickEnd) return {{lo, hi}, true};
  return {{t, t}, false};
}

std::optional<double> placeBefore(const StickPlaces& before, const StickPlaces& now, int i) {
  const int k = before.flat && now.flat ? i : nearer(before, now.at[i]);
  const bool same = before.flat == now.flat || nearer(now, before.at[k]) == i;
  if (!same || std::abs(now.at[i] - before.at[k]) > kSamePlace) return std::nullopt;
  return before.at[k];
}

}  // namespace ragdoll
