// Joint limits as the thesis has them [Pascucci2007, sec. 4.3.4, 4.3.5]: the child bone projected
// on three planes, in each of which its angle must lie between region_begin and region_end; a bone
// that has left them returns to its last allowed position.
//
// Axes. In the thesis y is up and, by its figures and regions, the body faces +z: an upper arm may
// go from hanging down (0, -1, 0) 120 degrees to its side, from 40 degrees behind to 135 in front,
// and from 10 degrees past straight ahead to 45 behind its side only if the right arm is at -x, and
// the "normal of the plane" its code turns about is -z, -x and -y. Ours: thesis x, y, z = our y
// (left), z (up), x (forward), so
//
//   key  plane       0 degrees            90 degrees (right side)  shoulder
//   xy   frontal     down (0, 0, -1)      right (0, -1, 0)           0 ... 120
//   yz   sagittal    back (-1, 0, 0)      down (0, 0, -1)           50 ... 225
//   xz   transverse  left (0, 1, 0)       ahead (1, 0, 0)           80 ... 225
//
// Where the parent is a bone (elbow, knee) yz starts from down and 90 degrees is ahead, as in its
// code for the elbow (10 ... 130). For a child bone that begins on the left (y > 0 in the rest
// pose) all is mirrored: left and right change places.
//
// Differences to the thesis. The planes are the PARENT's, not the world's, so that they turn with
// the body. A bone square to a plane has no angle in it, which is allowed. The way back is shared
// by mass between child and parent (as C = -angle(last allowed, child), a row like the others'),
// where the thesis moves the child alone: a return that nothing balances is a rocket, and drove a
// body lying on stairs to 20 kJ. So the relaxation. The direct methods stop the child at the
// borders of each region (limit.h): the way back to a direction some degrees inside has a pole
// where it ends, and a body left its regions by 10 degrees while they searched for it.
#pragma once

#include "ragdoll_sim/core/limit.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// Where a plane's angles are measured from, in the model's axes (x forward, y left, z up).
struct LimitPlane {
  Vec3 zero, quarter;  ///< unit: 0 and 90 degrees
};

/// plane: 0 XY, 1 YZ, 2 XZ; left: of the left side; bone_parent: elbow or knee.
LimitPlane limitPlane(int plane, bool left, bool bone_parent);

/// [rad] in (-pi, pi] of a direction in the parent's rest axes.
double planeAngle(const LimitPlane& plane, const Vec3& direction);

PlaneLimit::Region planeRegion(const LimitPlane& plane, const AngleRange& range);

/// [rad] of a direction in the parent's rest axes, within half a turn of the region's middle.
double regionAngle(const PlaneLimit::Region& region, const Vec3& direction);

/// A unit direction in the parent's rest axes, tested.
bool isAllowed(const PlaneLimit& limit, const Vec3& direction);

/// [rad] the worst of the planes; x: coordinates of the body's first particle.
double planeViolation(const PlaneLimit& limit, const double* x);

/// The child's direction in the parent's rest axes.
Vec3 childInParent(const PlaneLimit& limit, const double* x);

/// The last allowed direction, carried by the parent: where a child that has left its regions
/// returns to.
Direction returnDirection(const PlaneLimit& limit, const Vec3& allowed);

}  // namespace ragdoll
