#include "core/contact/capsule_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/constants.h"
#include "core/contact/first_touch.h"
#include "core/contact/golden_section.h"

namespace ragdoll {
namespace {

constexpr int kTaperSteps = 6;          ///< of one parameter after the other; 2 to 4 are usual
constexpr double kSettledPlace = 1e-9;  ///< of a parameter
/// Squared sine between axes: rounding grows by its inverse.
constexpr double kAllButParallel = 1e-10;
constexpr int kMaxHalvings = 4;  ///< of the step, to find when axes had not yet crossed

double clampUnit(double s) { return std::clamp(s, 0.0, 1.0); }

/// Parameter of the point of a-b nearest to p.
double project(const CapsuleAxis& axis, const Vec3& p) {
  const Vec3 d = axis.b - axis.a;
  const double length2 = d.squaredNorm();
  return length2 > kMinLength * kMinLength ? clampUnit((p - axis.a).dot(d) / length2) : 0;
}

/// Where the axis's surface is nearest to p: sqrt((L (s - s0))^2 + height^2) - (rb - ra) s least.
double nearestTo(const CapsuleAxis& axis, const Vec3& p) {
  const Vec3 d = axis.b - axis.a;
  const double length2 = d.squaredNorm();
  const double taper = axis.rb - axis.ra;
  if (taper * taper >= length2) return taper > 0 ? 1 : 0;  // one end holds the other
  const double s0 = (p - axis.a).dot(d) / length2;
  const double height2 = std::max(0.0, (p - axis.a).squaredNorm() - s0 * s0 * length2);
  return clampUnit(s0 + taper * std::sqrt(height2 / (length2 * (length2 - taper * taper))));
}

double smallestGap(const CapsuleAxis& a, const CapsuleAxis& b) {
  return gapAt(a, b, nearestPoints(a, b));
}

/// [m]
double axisDistance(const CapsuleAxis& a, const CapsuleAxis& b) {
  const AxisPoints at = closestPoints(a, b);
  return (a.at(at.s) - b.at(at.t)).norm();
}

/// Bounds the relative motion of any two points of the capsules: both move straight.
double relativeTravel(const SweptCapsule& a, const SweptCapsule& b) {
  const Vec3 pa = a.a1 - a.a0, pb = a.b1 - a.b0, qa = b.a1 - b.a0, qb = b.b1 - b.b0;
  return std::sqrt(std::max({(pa - qa).squaredNorm(), (pa - qb).squaredNorm(),
                             (pb - qa).squaredNorm(), (pb - qb).squaredNorm()}));
}

Vec3 normalAt(const CapsuleAxis& a, const CapsuleAxis& b, const AxisPoints& at) {
  const Vec3 d = a.at(at.s) - b.at(at.t);
  const double length = d.norm();
  if (length > kMinLength) return d / length;
  Vec3 n = (a.b - a.a).cross(b.b - b.a);  // the axes cross: out of their common plane
  if (n.norm() < kMinLength) n = (a.b - a.a).unitOrthogonal();
  return n.normalized();
}

/// The ends of the overlap of two axes, seen from the first.
std::array<AxisPoints, 2> overlapEnds(const CapsuleAxis& a, const CapsuleAxis& b) {
  const double s0 = project(a, b.a), s1 = project(a, b.b);
  return {{{s0, project(b, a.at(s0))}, {s1, project(b, a.at(s1))}}};
}

CapsuleTouch touchAt(const SweptCapsule& first, const SweptCapsule& second, double time,
                     const AxisPoints& at, const AxisPoints& start) {
  const CapsuleAxis a = first.at(time), b = second.at(time);
  return {at, normalAt(a, b, at), a.radius(at.s) + b.radius(at.t), start,
          gapAt(first.at(0), second.at(0), start)};
}

int touchesAt(const SweptCapsule& first, const SweptCapsule& second, double time,
              std::array<CapsuleTouch, 2>& touches) {
  const CapsuleAxis a = first.at(time), b = second.at(time), a0 = first.at(0), b0 = second.at(0);
  const AxisPoints nearest = nearestPoints(a, b);
  const CapsuleTouch crossing = touchAt(first, second, time, nearest, nearestPoints(a0, b0));
  if (!lieAlong(a, b)) {
    touches[0] = crossing;
    return 1;
  }
  const std::array<AxisPoints, 2> ends = overlapEnds(a, b), before = overlapEnds(a0, b0);
  const double gap0 = gapAt(a, b, ends[0]), gap1 = gapAt(a, b, ends[1]);
  for (int k = 0; k < 2; ++k) touches[k] = touchAt(first, second, time, ends[k], before[k]);
  // Axes that cross at a small angle are nearest between the ends.
  if (gapAt(a, b, nearest) < std::min(gap0, gap1) - kCrossing)
    touches[gap0 > gap1 ? 0 : 1] = crossing;
  return 2;
}

}  // namespace

AxisPoints closestPoints(const CapsuleAxis& first, const CapsuleAxis& second) {
  const Vec3 d1 = first.b - first.a, d2 = second.b - second.a, r = first.a - second.a;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  constexpr double kPoint = kMinLength * kMinLength;
  if (a <= kPoint) return {0, e <= kPoint ? 0 : clampUnit(f / e)};
  const double c = d1.dot(r);
  if (e <= kPoint) return {clampUnit(-c / a), 0};
  const double b = d1.dot(d2);
  const double denominator = a * e - b * b;
  AxisPoints at;
  at.s = denominator > 1e-12 * a * e ? clampUnit((b * f - c * e) / denominator) : 0.5;
  at.t = (b * at.s + f) / e;
  if (at.t < 0 || at.t > 1) {
    at.t = clampUnit(at.t);
    at.s = clampUnit((b * at.t - c) / a);
  }
  return at;
}

namespace {

/// The gap |w| - r1(s) - r2(t), w = r + s d1 - t d2, is convex. Where its gradient is zero the
/// normal n = w / |w| has n . d1 = r1', n . d2 = -r2': its part in the axes' plane, and so |w| from
/// their distance, then s and t. If that is beyond sides of the square, it is least on one of
/// these. False: the axes are too nearly parallel.
bool findNearest(const CapsuleAxis& first, const CapsuleAxis& second, AxisPoints& at) {
  const Vec3 d1 = first.b - first.a, d2 = second.b - second.a, r = first.a - second.a;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), b = d1.dot(d2);
  const double determinant = a * e - b * b;
  if (!(determinant > kAllButParallel * a * e)) return false;
  const double taper1 = first.rb - first.ra, taper2 = second.rb - second.ra;
  const double in_plane =
      (taper1 * taper1 * e + 2 * taper1 * taper2 * b + taper2 * taper2 * a) / determinant;
  AxisPoints best;                     // of the whole plane,
  const bool has_best = in_plane < 1;  // or else all four sides are tried
  if (has_best) {
    const double apart = std::abs(r.dot(d1.cross(d2))) / std::sqrt(determinant * (1 - in_plane));
    const double p = apart * taper1 - r.dot(d1), q = -apart * taper2 - r.dot(d2);
    best = {(e * p - b * q) / determinant, (b * p - a * q) / determinant};
    if (best.s >= 0 && best.s <= 1 && best.t >= 0 && best.t <= 1) {
      at = best;
      return true;
    }
  }
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const AxisPoints& side) {
    const double gap = gapAt(first, second, side);
    if (!(gap < least)) return;
    least = gap;
    at = side;
  };
  for (const double end : {0.0, 1.0}) {
    const auto beyond = [&](double s) { return !has_best || (end == 0 ? s < 0 : s > 1); };
    if (beyond(best.s)) consider({end, nearestTo(second, first.at(end))});
    if (beyond(best.t)) consider({nearestTo(first, second.at(end)), end});
  }
  return true;
}

}  // namespace

AxisPoints nearestPoints(const CapsuleAxis& first, const CapsuleAxis& second) {
  if (first.ra == first.rb && second.ra == second.rb) return closestPoints(first, second);
  AxisPoints at;
  if (findNearest(first, second, at)) return at;
  at = closestPoints(first, second);
  for (int i = 0; i < kTaperSteps; ++i) {
    const AxisPoints before = at;
    at.s = nearestTo(first, second.at(at.t));
    at.t = nearestTo(second, first.at(at.s));
    if (std::abs(at.s - before.s) + std::abs(at.t - before.t) < kSettledPlace) return at;
  }
  // A valley that steps along s and t descend slowly. Its floor is convex.
  const auto along = [&](double s) { return AxisPoints{s, nearestTo(second, first.at(s))}; };
  const auto gap = [&](double s) { return gapAt(first, second, along(s)); };
  return along(goldenSection(gap, 0, 1));
}

bool lieAlong(const CapsuleAxis& first, const CapsuleAxis& second) {
  const Vec3 u = first.b - first.a, w = second.b - second.a;
  const double scale = u.squaredNorm() * w.squaredNorm();
  if (!(scale > 0) || u.cross(w).squaredNorm() > kParallel * scale) return false;
  return std::abs(project(first, second.b) - project(first, second.a)) >= kStickEnd;
}

double gapAt(const CapsuleAxis& first, const CapsuleAxis& second, const AxisPoints& at) {
  return (first.at(at.s) - second.at(at.t)).norm() - first.radius(at.s) - second.radius(at.t);
}

namespace {

/// Whether what touch each other at the start do so on the same side in the end, where their gap is
/// `end`, not so deep that they may have gone through. They have gone along each other, however
/// far.
bool goAlong(const SweptCapsule& first, const SweptCapsule& second, double end, double thin) {
  if (end <= -0.5 * thin) return false;
  const auto normal = [&](double time) {
    const CapsuleAxis a = first.at(time), b = second.at(time);
    return normalAt(a, b, nearestPoints(a, b));
  };
  return normal(0).dot(normal(1)) > kSameSide;
}

}  // namespace

int findTouches(const SweptCapsule& first, const SweptCapsule& second, double margin,
                std::array<CapsuleTouch, 2>& touches) {
  const double travel = relativeTravel(first, second);
  const double near = margin + kSpeculative * travel;
  const double start = smallestGap(first.at(0), second.at(0));
  if (!(start <= travel + near)) return 0;
  const double thin = std::min({first.ra, first.rb, second.ra, second.rb});
  const auto gapAt = [&](double time) { return smallestGap(first.at(time), second.at(time)); };
  double time = 1;
  if (start <= -0.5 * thin && start < 0) {
    // Deep: where they would go may lie on the far side.
    if (2 * travel > axisDistance(first.at(0), second.at(0))) time = 0;
  } else {
    const double end = gapAt(1);
    const bool closes = start > kResting && end <= 0;
    double gap = start;
    if (travel > 0.5 * thin && !(isResting(start) && goAlong(first, second, end, thin))) {
      time = 0;
      advance(gapAt, travel, time, gap);
      if (gap > std::max(kGapResolution, near)) return 0;
      if (start > kResting && gap > 0) time = touchAfter(gapAt, travel, thin, time, gap, end);
    } else if (std::min(start, end) > near) {
      return 0;
    } else if (closes) {
      time = firstTouch(gapAt, 0, start, 1, end);
    }
  }
  return touchesAt(first, second, time, touches);
}

int findOverlaps(const SweptCapsule& first, const SweptCapsule& second, double depth,
                 std::array<CapsuleTouch, 2>& touches) {
  const auto sideKept = [&](double time) {
    const CapsuleAxis a = first.at(time), b = second.at(time), a0 = first.at(0), b0 = second.at(0);
    const AxisPoints at = nearestPoints(a, b);
    return normalAt(a, b, at).dot(a0.at(at.s) - b0.at(at.t)) > 0;
  };
  if (!(smallestGap(first.at(1), second.at(1)) < -depth)) return 0;
  double time = 1;
  for (int i = 0; i < kMaxHalvings && !sideKept(time); ++i) time *= 0.5;
  return touchesAt(first, second, time, touches);
}

}  // namespace ragdoll
