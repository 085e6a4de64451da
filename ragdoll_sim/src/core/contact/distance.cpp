#include "core/contact/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ragdoll {
namespace {

using Type = ObstacleSpec::Type;

/// Distance to a core point or axis, less the radius. out: the way from the core itself, which a
/// capsule's must not have along its axis, where the surface is far.
Distance rounded(const Vec3& from_core, double radius, const Vec3& out) {
  const double length = from_core.norm();
  if (length < kMinLength) return {-radius, out};
  return {length - radius, from_core / length};
}

Distance boxDistance(const Vec3& half, const Vec3& p) {
  const Vec3 q = p.cwiseAbs() - half;
  if ((q.array() <= 0).all()) {  // inside: the nearest face
    int axis = 0;
    const double value = q.maxCoeff(&axis);
    Vec3 normal = Vec3::Zero();
    normal[axis] = p[axis] < 0 ? -1 : 1;
    return {value, normal};
  }
  const Vec3 nearest = p.cwiseMax(-half).cwiseMin(half);
  const double length = (p - nearest).norm();
  if (length < kMinLength) return {0, boxDistance(half, 0.999 * p).normal};
  return {length, (p - nearest) / length};
}

}  // namespace

Distance signedDistance(const Obstacle& o, const Vec3& p) {
  switch (o.type) {
    case Type::kPlane:
      return {p.z(), Vec3::UnitZ()};
    case Type::kBox:
      return boxDistance(o.half, p);
    case Type::kSphere:
      return rounded(p, o.radius, Vec3::UnitZ());
    case Type::kCapsule:
      return rounded(p - Vec3(0, 0, std::clamp(p.z(), -o.half.z(), o.half.z())), o.radius,
                     Vec3::UnitX());
  }
  return {};
}

Distance lineDistance(const Obstacle& o, const Vec3& p, const Vec3& along) {
  const Vec3 across = p - along.dot(p) * along;
  Distance best{-std::numeric_limits<double>::infinity(), along.unitOrthogonal()};
  const double radius = o.type == Type::kBox ? 0 : o.radius;
  const auto consider = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (length < kMinLength) return;
    const Vec3 n = (direction.dot(p) < 0 ? -direction : direction) / length;
    const double reach = n.cwiseAbs().dot(o.half) + radius;  // of the solid along n
    const double value = n.dot(p) - reach;
    if (value > best.value) best = {value, n};
  };
  for (int k = 0; k < 3; ++k)
    if (o.half[k] > 0) consider(along.cross(Vec3::Unit(k)));
  if (std::isinf(best.value)) consider(across);
  if (std::isinf(best.value)) consider(best.normal);
  return best;
}

double signedDistanceValue(const Obstacle& o, const Vec3& p) {
  switch (o.type) {
    case Type::kPlane:
      return p.z();
    case Type::kBox: {
      const Vec3 q = p.cwiseAbs() - o.half;
      return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    }
    case Type::kSphere:
      return p.norm() - o.radius;
    case Type::kCapsule: {
      const double z = p.z() - std::clamp(p.z(), -o.half.z(), o.half.z());
      return std::sqrt(p.x() * p.x() + p.y() * p.y() + z * z) - o.radius;
    }
  }
  return 0;
}

}  // namespace ragdoll
