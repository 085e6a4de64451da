// How motions and velocities move the two sides of a contact against each other. owner: whose
// motion closes it, a body (with obstacles and itself) or an island (between its bodies).
#pragma once

#include <algorithm>
#include <array>

#include "core/direct/island.h"

namespace ragdoll {

inline const StepContext& contextOf(const Body& body) { return *body.context; }
inline const StepContext& contextOf(const Island& island) { return island.context; }

/// visit(k, body, column): of each point of the contact that moves, its body and column there.
template <class Visit>
void visitMoving(const Body& body, const Contact& c, const Visit& visit) {
  for (int k = 0; k < c.count; ++k) visit(k, body, c.particle[k] - body.first);
}
template <class Visit>
void visitMoving(const Island& island, const Contact& c, const Visit& visit) {
  int place = island.placeOf(c.ragdoll);
  for (int k = 0; k < c.count; ++k) {
    if (k == 2 && c.other >= 0) place = island.placeOf(c.other);
    if (place < 0) continue;
    const Body& body = *island.bodies[place];
    visit(k, body, c.particle[k] - body.first);
  }
}

/// [m] of the contact's plane after the motions.
template <class Owner>
double gapAfter(const Owner& owner, const Contact& c) {
  double moved = 0;
  visitMoving(owner, c, [&](int k, const Body& body, int i) {
    moved += c.weight[k] * c.normal.dot(body.motion.dx.col(i));
  });
  return c.gapAt(contextOf(owner).state.x) + moved;
}

/// [m] How the motions move the two sides along each other, beside their common turn [rad].
template <class Owner>
Vec3 slipAfter(const Owner& owner, const Contact& c, const Vec3& turn) {
  Vec3 slip = Vec3::Zero(), apart = Vec3::Zero();
  visitMoving(owner, c, [&](int k, const Body& body, int i) {
    const Vec3 dx = body.motion.dx.col(i);
    slip += c.middleWeight(k) * dx;
    apart += c.middleWeight(k) * (body.x().col(i) + 0.5 * dx);
  });
  return slip - turn.cross(apart);
}

/// [m] How far its two sides move against each other, at the most.
template <class Owner>
double travelOf(const Owner& owner, const Contact& c) {
  std::array<double, 2> most{};
  visitMoving(owner, c, [&](int k, const Body& body, int i) {
    most[k / 2] = std::max(most[k / 2], body.motion.dx.col(i).norm());
  });
  return most[0] + most[1] + c.surface_motion.norm();
}

/// [m/s] of the contact's point against the other surface; along that; and at which the gap opens
/// now.
inline Vec3 rateOf(const StepContext& step, const Contact& c) {
  return c.of(step.state.v) - c.surface_end / step.h;
}
inline Vec3 slipOf(const StepContext& step, const Contact& c) {
  return tangentialPart(rateOf(step, c), c.normal);
}
inline double openingRate(const StepContext& step, const Contact& c) {
  return c.normal.dot(rateOf(step, c));
}

}  // namespace ragdoll
