// Directions that particles carry: their value and the exact gradient of a function of them.
// What they are: limit.h. x points at the coordinates of a body's first particle, xyz per particle.
#pragma once

#include "ragdoll_sim/core/limit.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// [-] The smallest 1 + cos to a swing's start that is divided by; nearer to the singular direction
/// (about 0.1 deg) the frame turns with finite speed instead of flipping.
constexpr double kMinSwing = 1e-6;

using Coordinates = Eigen::Map<const Vec3>;

inline Coordinates pointAt(const double* x, int particle) { return Coordinates(x + 3 * particle); }

/// v turned by the smallest rotation that takes a to u (unit vectors).
inline Vec3 swung(const Vec3& a, const Vec3& u, const Vec3& v) {
  const Vec3 s = a + u;
  return v - (s.dot(v) / std::max(1 + a.dot(u), kMinSwing)) * s + (2 * a.dot(v)) * u;
}

/// c_0 e + c_1 f + c_2 e x f, normalised.
inline Vec3 baseDirection(const Direction& d, const Vec3& c, const double* x) {
  const Vec3 e = pointAt(x, d.base[1]) - pointAt(x, d.base[0]);
  if (d.bone) return e / std::max(e.norm(), kMinLength);
  const Vec3 f = pointAt(x, d.base[2]) - pointAt(x, d.base[0]);
  const Vec3 q = c[0] * e + c[1] * f + c[2] * e.cross(f);
  return q / std::max(q.norm(), kMinLength);
}

inline Vec3 boneDirection(const Direction::Swing& bone, const double* x) {
  const Vec3 e = pointAt(x, bone.to) - pointAt(x, bone.from);
  return e / std::max(e.norm(), kMinLength);
}

/// The direction with coefficients c carried through the first `swings` of d's.
inline Vec3 carried(const Direction& d, int swings, const Vec3& c, const double* x) {
  if (swings == 0) return baseDirection(d, c, x);
  const Direction::Swing& bone = d.swing[swings - 1];
  return swung(carried(d, swings - 1, bone.axis, x), boneDirection(bone, x),
               carried(d, swings - 1, c, x));
}

inline Vec3 valueOf(const Direction& d, const double* x) { return carried(d, d.swings, d.c, x); }

/// Adds to the row the gradient of a function whose derivative with respect to d is g.
void addGradient(const Direction& d, const Vec3& g, const double* x, int first, LimitRow& row);

}  // namespace ragdoll
