// A point of one body against a half-space (an obstacle's tangent plane), or against another body.
//
// gap = n . (sum_k w_k x_k) - offset >= 0. Against an obstacle the weights sum to one and the plane
// is tangent to a convex obstacle, so a point that satisfies it is outside; between bodies they sum
// to zero.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

struct Contact {
  std::array<int, 4> particle{};  ///< columns of the state
  std::array<double, 4> weight{};
  int count = 0;                ///< how many of the four are used
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the obstacle (of the second body)
  double offset = 0;            ///< [m]
  double friction = 0, restitution = 0;
  Compliance give;  ///< of both surfaces; rigid: all methods but direct take it so
  Vec3 surface_motion = Vec3::Zero();  ///< [m] of the obstacle at the contact during the step
  /// [m] The step's length times the obstacle's velocity where it is touched, at the motion's start
  /// and end: where it does not turn, surface_motion.
  Vec3 surface_start = Vec3::Zero(), surface_end = Vec3::Zero();
  int ragdoll = 0, other = -1;  ///< other: the second ragdoll; -1: an obstacle or the same ragdoll
  std::array<bool, 2> moves{true, true};  ///< ragdoll, other: false while it sleeps
  bool follows = false;                   ///< the obstacle follows a frame of others
  bool dropped = false;                   ///< while contacts are looked for: to be taken out
  /// Of a stick: which of its ends touches when its place of contact has run there, not before.
  std::array<bool, 2> has_end{};
  int obstacle = -1;     ///< of the model; -1: another body
  double gap_start = 0;  ///< [m] at the step's start
  // Direct methods.
  /// It touches at the motion's start: place and normal there, along which positions are pushed.
  /// Velocities are along `normal`, at the end: as RATTLE does with equalities [Andersen1983].
  bool touches_at_start = false;
  /// Of sticks that are rigid: they do, but elsewhere: the place runs along them.
  bool runs = false;
  std::array<double, 4> start_weight{};
  Vec3 start_normal = Vec3::UnitZ();
  double before = 0;  ///< [m] gap to the plane at the substep's start
  double found = 0;   ///< [m] offset, before what of an overlap may stay

  /// sum_k w_k x_k of the points or velocities x (3 x N, the state's columns).
  Vec3 of(const Points& x) const {
    Vec3 sum = weight[0] * x.col(particle[0]);
    for (int k = 1; k < count; ++k) sum += weight[k] * x.col(particle[k]);
    return sum;
  }
  /// [m] at positions x.
  double gapAt(const Points& x) const {
    double gap = -offset;
    for (int k = 0; k < count; ++k) gap += weight[k] * normal.dot(x.col(particle[k]));
    return gap;
  }
  /// As it is at the motion's start, but for its offset.
  Contact atStart() const {
    Contact c = *this;
    if (!touches_at_start) return c;
    c.normal = start_normal;
    c.weight = start_weight;
    c.surface_end = surface_start;
    return c;
  }
  /// Of the place that is in touch half way: what slips.
  double middleWeight(int k) const {
    return touches_at_start ? 0.5 * (start_weight[k] + weight[k]) : weight[k];
  }
  /// [m] Of the obstacle where it is touched meanwhile.
  Vec3 surfaceMean() const { return 0.5 * (surface_start + surface_end); }
  /// Along the normal and two tangents.
  std::array<Vec3, 3> directions() const {
    const Vec3 t1 =
        normal.cross(std::abs(normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    return {normal, t1, normal.cross(t1)};
  }
  /// Of how the middle place moves in a motion, what slips: along the surface half way, as what
  /// gives way closes or opens meanwhile.
  Vec3 slipOf(const Vec3& moved) const;
  /// Components along its directions of an impulse with such components at the start: turned as the
  /// normal has.
  Vec3 turned(const Vec3& at_start) const;
  /// Whether it is of the same surfaces: of the same sticks of bodies, or of a stick and one of its
  /// ends, which share a spring, with the same obstacle.
  bool isOfSame(const Contact& c) const {
    if (obstacle != c.obstacle || (count == 4) != (c.count == 4)) return false;
    if (count == 4) return particle == c.particle;
    const auto end = particle.begin() + count;
    return std::find_first_of(particle.begin(), end, c.particle.begin(),
                              c.particle.begin() + c.count) != end;
  }
  bool isSoft() const { return give.compliance > 0; }
  /// [J] in its spring at a gap [m].
  double storedEnergy(double gap) const {
    return isSoft() && gap < 0 ? 0.5 * gap * gap / give.compliance : 0;
  }
};

/// Rows that it is solved for by: along the normal and, with friction, two tangents.
inline int rowsOf(const Contact& c) { return c.friction > 0 ? 3 : 1; }

/// What a vector has along the plane with this unit normal.
inline Vec3 tangentialPart(const Vec3& v, const Vec3& normal) { return v - v.dot(normal) * normal; }

/// Two bodies that press on each other.
struct BodyPair {
  int first = 0, second = 0;  ///< ragdolls
  bool grips = false;         ///< friction holds them: it is less than it could be
};

}  // namespace ragdoll
