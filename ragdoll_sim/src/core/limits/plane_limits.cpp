#include "ragdoll_sim/core/plane_limits.h"

#include <algorithm>
#include <cmath>

#include "core/limits/constants.h"
#include "ragdoll_sim/core/direction.h"

namespace ragdoll {
namespace {

double violation(const PlaneLimit::Region& region, const Vec3& d) {
  const double c = d.dot(region.middle), s = d.dot(region.side), r = std::hypot(c, s);
  return r < kNoAngle ? 0 : (std::abs(std::atan2(s, c)) - region.half) * r;
}

}  // namespace

LimitPlane limitPlane(int plane, bool left, bool bone_parent) {
  const Vec3 ahead = Vec3::UnitX(), up = Vec3::UnitZ();
  const Vec3 outward = left ? Vec3::UnitY() : Vec3(-Vec3::UnitY());
  if (plane == 0) return {-up, outward};
  if (plane == 1) return bone_parent ? LimitPlane{-up, ahead} : LimitPlane{-ahead, -up};
  return {-outward, ahead};
}

double planeAngle(const LimitPlane& plane, const Vec3& d) {
  return std::atan2(d.dot(plane.quarter), d.dot(plane.zero));
}

PlaneLimit::Region planeRegion(const LimitPlane& plane, const AngleRange& range) {
  PlaneLimit::Region region;
  const double middle = (range.begin + range.end) / 2;
  region.used = true;
  region.middle = std::cos(middle) * plane.zero + std::sin(middle) * plane.quarter;
  region.side = std::cos(middle) * plane.quarter - std::sin(middle) * plane.zero;
  region.centre = middle;
  region.half = (range.end - range.begin) / 2;
  region.cos_half = std::cos(region.half);
  return region;
}

double regionAngle(const PlaneLimit::Region& region, const Vec3& d) {
  return region.centre + std::atan2(d.dot(region.side), d.dot(region.middle));
}

bool isAllowed(const PlaneLimit& limit, const Vec3& d) {
  for (const PlaneLimit::Region& region : limit.regions) {
    if (!region.used) continue;
    const double c = d.dot(region.middle), s = d.dot(region.side);
    const double r = std::sqrt(c * c + s * s);
    if (r > kNoAngle && c < r * region.cos_half) return false;
  }
  return true;
}

Vec3 childInParent(const PlaneLimit& limit, const double* x) {
  const Vec3 w = valueOf(limit.child, x);
  return {valueOf(limit.axes[0], x).dot(w), valueOf(limit.axes[1], x).dot(w),
          valueOf(limit.axes[2], x).dot(w)};
}

double planeViolation(const PlaneLimit& limit, const double* x) {
  const Vec3 d = childInParent(limit, x);
  double worst = 0;
  for (const PlaneLimit::Region& region : limit.regions)
    if (region.used) worst = std::max(worst, violation(region, d));
  return worst;
}

Direction returnDirection(const PlaneLimit& limit, const Vec3& allowed) {
  Direction d = limit.axes[0];  // all three are carried alike, and linear in c
  d.c = allowed[0] * limit.axes[0].c + allowed[1] * limit.axes[1].c + allowed[2] * limit.axes[2].c;
  return d;
}

}  // namespace ragdoll
