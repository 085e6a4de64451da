#include "core/contact/stick_springs.h"

#include <algorithm>
#include <cmath>

#include "core/contact/compliance.h"
#include "core/contact/constants.h"

namespace ragdoll {
namespace {

constexpr int kSpringNarrowings = 24;     ///< false position (Illinois)
constexpr int kSpringHalvings = 40;       ///< of what that leaves, at a kink
constexpr double kSettledPull = 1e-14;    ///< of the scale of pullAt
constexpr double kPlaceRounding = 1e-12;  ///< of places
constexpr double kTouches = 1e-11;        ///< [m] no depth
constexpr double kDeeper = 1e-9;          ///< of the depth; below it is rounding

/// One place of the axis.
struct Place {
  double t = 0, depth = 0, slope = 0;  ///< slope: [m] of the depth along the axis
  Vec3 normal;
  double pull = 0;  ///< [m^2/N] > 0: the force acts farther towards b
};

Place placeAt(const Axis& axis, const StickEnds& ends, double t) {
  const Distance d = signedDistance(axis.obstacle, axis.at(t));
  Place p;
  p.t = t;
  p.normal = d.normal;
  p.depth = axis.radius(t) - d.value;
  p.slope = axis.rb - axis.ra - d.normal.dot(axis.b - axis.a);
  // Of depth^2 / 2C, which has one maximum: depth is concave, the root of C convex.
  const double ca = (1 - t) * ends.a.compliance, cb = t * ends.b.compliance;
  p.pull = p.slope * ends.complianceAt(t) - std::max(p.depth, 0.0) * (cb - ca);
  return p;
}

/// [m] By how much the depth is concave at a place: minus its second derivative along the axis.
double curvatureAt(const Axis& axis, const Place& p) {
  const Vec3 at = axis.at(p.t);
  const Vec3 beside = (at.cwiseAbs().array() >= axis.obstacle.half.array()).cast<double>();
  if (beside.isZero(0)) return 0;  // within a box: the nearest face
  const Vec3 v = beside.cwiseProduct(axis.b - axis.a);
  const Vec3 u =
      beside.cwiseProduct(at - at.cwiseMax(-axis.obstacle.half).cwiseMin(axis.obstacle.half));
  const double distance = u.norm();
  if (!(distance > 0)) return 0;
  return std::max(0.0, v.squaredNorm() - std::pow(u.dot(v) / distance, 2)) / distance;
}

/// Rocking on what is curved turns the plane beneath: less than half of what it would meet on a
/// plane.
bool isFlat(const Axis& axis, const StickEnds& ends, const Place& p) {
  const double c = ends.complianceAt(p.t);
  return curvatureAt(axis, p) * c * c <= p.depth * ends.a.compliance * ends.b.compliance;
}

/// Narrows lo, hi to where the pull changes sign; whether it does so there in a jump.
bool narrow(const Axis& axis, const StickEnds& ends, Place& lo, Place& hi) {
  const double scale = kSettledPull * (ends.a.compliance + ends.b.compliance);
  double pull_lo = lo.pull, pull_hi = hi.pull;
  int last = 0;
  for (int i = 0; i < kSpringNarrowings + kSpringHalvings && hi.t - lo.t > kPlaceRounding; ++i) {
    const double share = i < kSpringNarrowings ? pull_lo / (pull_lo - pull_hi) : 0.5;
    const Place p = placeAt(axis, ends, lo.t + share * (hi.t - lo.t));
    const int side = p.pull > 0 ? 1 : -1;
    if (side == last) (side > 0 ? pull_hi : pull_lo) *= 0.5;
    last = side;
    if (side > 0) {
      lo = p, pull_lo = p.pull;
    } else {
      hi = p, pull_hi = p.pull;
    }
    if (std::abs(p.pull) <= scale * std::max(p.depth, kPlaceRounding)) {
      lo = hi = p;
      return false;
    }
  }
  return true;
}

}  // namespace

double StickEnds::dampingAt(double t) const {
  const double c = complianceAt(t);
  if (!(c > 0)) return 0;
  const double wa = (1 - t) * a.compliance, wb = t * b.compliance;
  return (wa * wa * a.damping + wb * wb * b.damping) / (c * c);
}

StickPress pressOf(const Axis& axis, const StickEnds& ends) {
  StickPress press;
  press.at = nearest(axis);
  Place p = placeAt(axis, ends, press.at);
  press.depth = p.depth;
  press.normal = p.normal;
  press.between = isBetweenEnds(p.t);
  if (!(p.depth > kTouches)) return press;
  Place lo = placeAt(axis, ends, 0), hi = placeAt(axis, ends, 1);
  const double depth_a = std::max(0.0, lo.depth), depth_b = std::max(0.0, hi.depth);
  if (lo.pull <= 0 || hi.pull >= 0) {
    p = lo.pull <= 0 ? lo : hi;
    press.at = p.t;
    press.depth = p.depth;
    press.normal = p.normal;
    press.between = false;
    return press;
  }
  const bool kink = narrow(axis, ends, lo, hi);
  // At a kink the force is between those of both sides.
  const double share = lo.pull > hi.pull ? lo.pull / (lo.pull - hi.pull) : 0;
  const Vec3 normal = (1 - share) * lo.normal + share * hi.normal;
  press.share = normal.norm();
  press.normal = normal / press.share;
  p = hi;
  press.at = p.t;
  press.depth = p.depth;
  press.flat = !kink && isFlat(axis, ends, p);
  const double force = press.force(ends);
  press.excess = std::max((1 - p.t) * ends.a.compliance * force - depth_a,
                          p.t * ends.b.compliance * force - depth_b);
  press.between = press.excess > kDeeper * press.depth + kDeeper * kTouches;
  return press;
}

StickPress pressedAt(const Axis& axis, const StickPress& before) {
  StickPress press = before;
  const Distance d = signedDistance(axis.obstacle, axis.at(before.at));
  press.depth = axis.radius(before.at) - d.value;
  press.normal = d.normal;
  press.share = 1;
  return press;
}

int sticksAt(const Model& model, const Obstacle& o, const Ragdoll& r, int particle) {
  const Skeleton& s = model.skeletonOf(r);
  int count = 0;
  for (std::size_t j = 0; j < s.sticks.size(); ++j) {
    const Stick& k = s.sticks[j];
    if ((k.a == particle || k.b == particle) && k.a < s.named && k.b < s.named &&
        giveOf(model, o, r, s.stick_contact, j).compliance > 0)
      ++count;
  }
  return count;
}

StickEnds endsOf(const Model& model, const Obstacle& o, const Ragdoll& r, int a, int b,
                 const Compliance& give) {
  const Skeleton& s = model.skeletonOf(r);
  const auto endOf = [&](int particle) {
    Compliance own = giveOf(model, o, r, s.particle_contact, particle - r.first);
    if (!(own.compliance > 0)) return give;
    const int sharing = sticksAt(model, o, r, particle - r.first);
    return Compliance{sharing * own.compliance, own.damping / sharing};
  };
  return {endOf(a), endOf(b)};
}

}  // namespace ragdoll
