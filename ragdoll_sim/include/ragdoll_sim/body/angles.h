// Joint angles. All in the PARENT's own frame, never in the world's; radians.
//
// As the limits measure them (core/limit.h, core/plane_limits.h), so that a joint at its limit
// shows the limit's own number: hinge: one angle, the right-hand turn of the child about `axis`
// from the straight continuation of
//   the parent bone; > 0 for a bent elbow or knee. Named <joint>_<x|y|z> by the axis's largest
//   part. On a bone it is read from the angle between the bones, as the limit's is: how far the
//   plane of bending has turned about the parent bone does not count.
// cone: <joint>_swing, the angle between the cone's axis and the child; at most half_angle. A cone
//   does not limit twist, and measures none.
// planes: <joint>_xy, _yz, _xz, the child's angle in each plane that has a region, within half a
// turn
//   of the region's middle.
//
// Beside these, for joints that turn about three axes (cones, and planes but for those on a bone with
// less than three regions, as elbow and knee), the turn R of the child part in the parent part since
// the rest pose,
//   R = Ry(y) Rx(x) Rz(z): for a limb that hangs down flexion about y, then abduction about x, then
//   twist about the limb itself, the order of the joint coordinate system [GroodSuntay1983] which
//   locks only at x = +-90 deg. Named <joint>_x, _y, _z. y and z in (-pi, pi], x in [-pi/2, pi/2].
// Ragdolls after the first prefix "<ragdoll>/".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/core/joint_frames.h"

namespace ragdoll {

/// Turn about `axis` that takes the straight continuation of `parent` to `child` (unit vectors of
/// one frame, axis unit). In (-pi, pi]; the parts of the bones along the axis do not count.
double hingeAngle(const Vec3& axis, const Vec3& parent, const Vec3& child);

/// x, y, z of R = Ry(y) Rx(x) Rz(z).
Vec3 jointEuler(const Quat& child_in_parent);
Quat fromJointEuler(const Vec3& xyz);

/// A hinge in the rest pose's axes; unit vectors.
struct HingeGeometry {
  Vec3 axis;      ///< fixed in the parent
  Vec3 straight;  ///< fixed in the parent: where `child` points at angle 0
  Vec3 child;     ///< fixed in the child: its bone, or any direction for a group
};
HingeGeometry hingeGeometry(const Skeleton& skeleton, const Joint& joint);

/// All joint angles of a world.
class JointAngles {
 public:
  JointAngles(const Model& model, const FrameTracker& tracker);
  const std::vector<std::string>& names() const { return names_; }
  /// One value per name.
  void compute(const Posture& posture, std::vector<double>& angles) const;

 private:
  /// What one joint gives; in this order.
  struct Entry {
    int parent, child;                      ///< parts of the posture
    int particle;                           ///< the body's first
    std::optional<JointFrames::Bend> bend;  ///< a hinge from bone to bone
    std::optional<HingeGeometry> hinge;     ///< any other hinge
    bool euler = false;                     ///< three axes
    std::optional<Limit> cone;              ///< its limit
    std::optional<PlaneLimit> planes;
  };
  void add(const Skeleton& skeleton, int joint, const std::string& prefix, Entry entry);

  std::vector<Entry> entries_;
  std::vector<std::string> names_;
};

}  // namespace ragdoll
