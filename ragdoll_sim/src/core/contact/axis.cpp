#include "core/contact/axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/contact/constants.h"
#include "core/contact/golden_section.h"

namespace ragdoll {
namespace {

constexpr double kFlatEdge = 1e-9;  ///< [m] flat along an edge, beside which a capsule is round
constexpr double kAsDeep = 10 * kGapResolution;  ///< [m] a stick's depth varies by less
constexpr double kAxisRounding = 1e-9;           ///< of a place along a stick
constexpr int kNarrowings = 8;                   ///< false position, of the end of what lies flat
constexpr int kHalvings = 16;                    ///< and halvings of what that leaves

/// Where |u + t v| - taper t is least between lo and hi.
double leastOf(const Vec3& u, const Vec3& v, double taper, double lo, double hi) {
  const double v2 = v.squaredNorm(), left = v2 - taper * taper;
  if (left <= 0) return taper > 0 ? hi : lo;
  const double foot = -u.dot(v) / v2;
  const double beside = (u + foot * v).norm();
  return std::clamp(foot + taper * beside / std::sqrt(left * v2), lo, hi);
}

/// Planes apart, an obstacle is what is within a radius of a core: a box, a line (capsule) or a
/// point (sphere). Where the axis passes from one side of it to the next cuts it into pieces that
/// look at one face, edge or corner each.
struct Pieces {
  std::array<double, 8> cut;  ///< 0, where the axis is cut, 1
  int count = 1;
};

Pieces piecesOf(const Axis& axis) {
  const Obstacle& o = axis.obstacle;
  const Vec3 v = axis.b - axis.a;
  Pieces pieces;
  std::array<double, 8>& cut = pieces.cut;
  cut[0] = 0;
  for (int k = 0; k < 3; ++k)
    for (const double face : {-o.half[k], o.half[k]}) {
      const double t = (face - axis.a[k]) / v[k];
      if (o.half[k] == 0 || !(t > 0 && t < 1)) continue;  // v_k = 0 among them
      int i = pieces.count++;
      for (; cut[i - 1] > t; --i) cut[i] = cut[i - 1];
      cut[i] = t;
    }
  cut[pieces.count] = 1;
  return pieces;
}

/// 1 for each axis of the obstacle along which the middle between lo and hi is beside its core.
Vec3 outsideOf(const Axis& axis, double lo, double hi) {
  const Vec3 middle = axis.at(0.5 * (lo + hi));
  return (middle.cwiseAbs().array() >= axis.obstacle.half.array()).cast<double>();
}

/// Narrows what is known of where the gap, which grows from `in` to `out`, is `limit`, by false
/// position (Illinois). f: gap - limit at both.
void narrow(const Axis& axis, double limit, double& in, double f_in, double& out, double f_out) {
  const double close = std::abs(out - in) * 0x1p-17;  // half of what half as many halvings leave
  int last = 0;
  for (int i = 0; i < kNarrowings && std::abs(out - in) > close; ++i) {
    const double at = in + (out - in) * (f_in / (f_in - f_out)), f = axis.gap(at) - limit;
    const int side = f <= 0 ? -1 : 1;
    if (side < 0) {
      in = at, f_in = f;
      if (last == side) f_out *= 0.5;
    } else {
      out = at, f_out = f;
      if (last == side) f_in *= 0.5;
    }
    last = side;
  }
}

/// How far the axis stays within `band` of its nearest place `t`, towards `end` (0 or 1): by
/// halving, where false position has not told yet.
double stretch(const Axis& axis, double t, double end, double band) {
  const double limit = axis.gap(t) + band, f_end = axis.gap(end) - limit;
  if (f_end <= 0) return end;
  double in = t, out = end, known_in = t, known_out = end;
  narrow(axis, limit, known_in, -band, known_out, f_end);
  const double sign = end > t ? 1 : -1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (in + out);
    const bool within = sign * (middle - known_in) <= 0 ||
                        (sign * (middle - known_out) < 0 && axis.gap(middle) <= limit);
    (within ? in : out) = middle;
  }
  return in;
}

/// The last place on the way from t to `far` that looks at a face (most: 1) or edge (2) of the
/// core, beside which it is along as many axes at most; NaN: none does.
double lastBeside(const Axis& axis, double t, double far, int most) {
  const Pieces pieces = piecesOf(axis);
  for (int i = 0; i < pieces.count; ++i) {
    const int k = far > t ? pieces.count - 1 - i : i;  // from that end on
    const double lo = std::max(pieces.cut[k], std::min(t, far));
    const double hi = std::min(pieces.cut[k + 1], std::max(t, far));
    if (hi - lo > kAxisRounding && outsideOf(axis, lo, hi).sum() <= most) return far > t ? hi : lo;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double nearest(const Axis& axis) {
  const Obstacle& o = axis.obstacle;
  const Vec3 v = axis.b - axis.a;
  const double taper = axis.rb - axis.ra;
  if (o.type == ObstacleSpec::Type::kPlane) return v.z() < taper ? 1 : 0;
  const Pieces pieces = piecesOf(axis);
  for (int i = 0; i < pieces.count; ++i) {
    const double lo = pieces.cut[i], hi = pieces.cut[i + 1];
    const Vec3 middle = axis.at(0.5 * (lo + hi));
    const Vec3 outside = outsideOf(axis, lo, hi);
    double t;
    if (outside.isZero(0)) {
      t = goldenSection([&](double s) { return axis.gap(s); }, lo, hi);
      if (axis.gap(hi) <= axis.gap(t)) t = hi;
    } else {
      const Vec3 face = middle.cwiseMax(-o.half).cwiseMin(o.half);
      t = leastOf((axis.a - face).cwiseProduct(outside), v.cwiseProduct(outside), taper, lo, hi);
    }
    if (hi - t > kAxisRounding) return t;  // the gap is convex: it grows from here on
  }
  return 1;
}

double nearestTo(const Axis& axis, const std::array<int, 3>& feature, double beyond) {
  const Vec3& half = axis.obstacle.half;
  const Vec3 side(feature[0], feature[1], feature[2]);
  const Vec3 outside = (side.array() != 0 || half.array() == 0).cast<double>();
  return leastOf((axis.a - side.cwiseProduct(half)).cwiseProduct(outside),
                 (axis.b - axis.a).cwiseProduct(outside), axis.rb - axis.ra, -beyond, 1 + beyond);
}

bool isRoundTo(const Axis& axis, double t, double end) {
  const double lo = std::min(t, end), hi = std::max(t, end);
  const Pieces pieces = piecesOf(axis);
  const auto first = pieces.cut.begin() + 1, last = pieces.cut.begin() + pieces.count;
  const bool one = std::none_of(first, last, [&](double cut) { return lo < cut && cut < hi; });
  return one && outsideOf(axis, lo, hi).sum() > 1;
}

double travelOf(const Axis& start, const Axis& end) {
  return std::max((end.a - start.a).norm(), (end.b - start.b).norm());
}

double flatEnd(const Axis& axis, double t, double end) {
  constexpr int kFace = 1, kEdge = 2;
  // What runs through the box comes out across itself, by what of it is as deep.
  const bool inside = axis.gap(t) < -axis.radius(t);
  const double over = lastBeside(axis, t, inside ? stretch(axis, t, end, kAsDeep) : end, kFace);
  const double rise = std::sqrt(kParallel) * std::abs(over - t) * (axis.b - axis.a).norm();
  if (!std::isnan(over) && (inside || axis.gap(over) - axis.gap(t) <= rise)) return over;
  const double least = t + std::copysign(kStickEnd, end - t);
  if (std::abs(end - t) > kStickEnd && axis.gap(least) > axis.gap(t) + kFlatEdge) return t;
  const double along = lastBeside(axis, t, stretch(axis, t, end, kFlatEdge), kEdge);
  return std::abs(along - t) > kStickEnd ? along : t;
}

}  // namespace ragdoll
