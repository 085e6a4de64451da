// Capsule against capsule: two sticks whose radii vary along them from end to end.
//
// The gap |P(s) - Q(t)| - r1(s) - r2(t) is convex in (s, t) in [0, 1]^2, and its minimum in closed
// form: without taper at the closest points of the axes [Ericson2005, sec. 5.1.9], else where its
// gradient is zero, or on a side of the square. Where axes are all but parallel one parameter is
// sought after the other, or by golden sections where that settles slowly. Such capsules touch at
// two places, the ends of their overlap.
#pragma once

#include <array>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// A capsule at one instant; a == b makes it a sphere.
struct CapsuleAxis {
  Vec3 a, b;      ///< [m]
  double ra, rb;  ///< [m] at the ends

  Vec3 at(double s) const { return a + s * (b - a); }
  double radius(double s) const { return ra + s * (rb - ra); }
};

/// Places along two axes, each in [0, 1] from a to b.
struct AxisPoints {
  double s = 0, t = 0;
};

/// Closest points of the two axes, radii aside. Where many are (parallel axes), one of them.
AxisPoints closestPoints(const CapsuleAxis& first, const CapsuleAxis& second);

/// Where the gap between the two surfaces is smallest.
AxisPoints nearestPoints(const CapsuleAxis& first, const CapsuleAxis& second);

/// Whether they lie along each other, and so touch at two places.
bool lieAlong(const CapsuleAxis& first, const CapsuleAxis& second);

/// [m] between the surfaces at these places; negative: overlap.
double gapAt(const CapsuleAxis& first, const CapsuleAxis& second, const AxisPoints& at);

/// A capsule during a step: its ends move straight from 0 to 1.
struct SweptCapsule {
  Vec3 a0, b0, a1, b1;  ///< [m]
  double ra, rb;        ///< [m]

  CapsuleAxis at(double time) const {
    return {a0 + time * (a1 - a0), b0 + time * (b1 - b0), ra, rb};
  }
};

/// A place where two capsules touch or may touch: n . (P(s) - Q(t)) >= radii keeps them apart.
struct CapsuleTouch {
  AxisPoints at;
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the second
  double radii = 0;             ///< [m] r1(s) + r2(t)
  AxisPoints start;             ///< where it was at the step's start
  double gap_start = 0;         ///< [m] there
};

/// Touches of two capsules during a step: what meets on the way, by conservative advancement
/// [Mirtich1996], or comes nearer than `margin` plus kSpeculative of its relative travel. Returns
/// how many of `touches` are used.
///
/// Guaranteed: as long as the ends would move straight, no pair that is apart at the step's start
/// goes unfound, at any speed; and points that obey n . (P - Q) >= radii are apart at the step's
/// end. Not guaranteed: a pair that only meets because something else deflects one of the two by
/// more than the margin is found in the next step, as an overlap.
int findTouches(const SweptCapsule& first, const SweptCapsule& second, double margin,
                std::array<CapsuleTouch, 2>& touches);

/// Touches of two capsules that overlap by more than `depth` at the step's end, whatever they did
/// on the way: where that is or, if their axes have crossed, was before. Returns how many of
/// `touches` are used.
int findOverlaps(const SweptCapsule& first, const SweptCapsule& second, double depth,
                 std::array<CapsuleTouch, 2>& touches);

}  // namespace ragdoll
