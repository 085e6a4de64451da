// How what touches, or may, moves in a motion: each of its points along a curve through both ends,
// so that gaps and places of contact in between are known to the motion's order.
#pragma once

#include <array>
#include <vector>

#include "core/contact/axis.h"
#include "core/contact/capsule_pairs.h"
#include "core/direct/island.h"

namespace ragdoll {

/// A point in a motion over h: [m] where it starts and ends, [m/s] how fast.
struct Path {
  Vec3 start = Vec3::Zero(), end = Vec3::Zero(), rate = Vec3::Zero(), end_rate = Vec3::Zero();

  /// After a share of the motion, by the cubic of Hermite [Hairer1993, II.6].
  Vec3 at(double share, double h) const;
};

/// The points of a contact: a particle or a stick near an obstacle, in the obstacle's frame; or two
/// capsules, in the world.
struct ContactPath {
  std::array<Path, 4> point;
  std::array<double, 4> radius{};      ///< [m]
  const Obstacle* obstacle = nullptr;  ///< nullptr: two capsules
  int count = 0;                       ///< of the points
  double h = 0;                        ///< [s]

  /// Where it is nearest after a share of the motion: places along its sticks.
  AxisPoints placesAt(double share) const;
  /// [m] there.
  double gapAt(double share) const;
  /// [m] between the first two points or the last two: of the sticks.
  double length(int stick) const;

  /// The two sticks' (first: 0, 2), or the one's beside the obstacle.
  CapsuleAxis capsuleAt(int first, double share) const;
  Axis axisAt(double share) const;
};

/// Of motions over h with these velocities at its end: the first body's v1 (3 x n, [m/s]), or those
/// of motions of second order.
ContactPath pathOf(const Body& body, const Contact& contact, double h, const Points* v1 = nullptr);
ContactPath pathOf(const Island& island, const Contact& contact, double h);

/// Whether sticks lie along what they touch: at two of the contacts, neither of which turns them.
bool isFlat(const std::vector<Contact>& contacts, const Contact& c);

/// Has a stick that is rigid and touches an obstacle at the end of a motion over h the place and
/// the normal that it has there; contacts: with those that are found with it. It was found where
/// the motion leads before anything presses or cuts it short, so that a speed along the surface
/// would be one into it: by the way that it is pressed back, over the surface's radius.
void placeAtEnd(const Body& body, const std::vector<Contact>& contacts, double h, Contact& c);
inline void placeAtEnd(const Island&, const std::vector<Contact>&, double, Contact&) {}

/// The share of a motion at which the nearest places are nearest, if they touch there and are
/// farther than `touching` [m] at both ends; and the first one at which they do. kNeverTouched
/// (first_touch.h): there is none.
double shareOfGraze(const ContactPath& path, double touching);
double shareOfTouch(const ContactPath& path, double touching);

}  // namespace ragdoll
