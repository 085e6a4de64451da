// Joints of a model file made into limits: Joint -> Limit, PlaneLimit.
#include <algorithm>
#include <cmath>

#include "core/loading/joint_checks.h"
#include "core/loading/skeleton.h"
#include "ragdoll_sim/core/joint_frames.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {
namespace {

constexpr double kRigidTwist = 5 * M_PI / 180;  ///< [rad] play of a hinge on a rigid parent
constexpr double kParallelAxis = 1e-3;  ///< [-] sine below which directions count as parallel

class LimitBuilder {
 public:
  LimitBuilder(const SkeletonSpec& spec, Skeleton& skeleton)
      : spec_(spec), s_(skeleton), frames_(skeleton), checks_(spec, skeleton) {}

  void build() {
    const int joints = static_cast<int>(s_.joints.size());
    for (int j = 0; j < joints; ++j) {
      checks_.checkJoint(j);
      const bool rigid = s_.segments[s_.joints[j].parent].group;
      s_.joints[j].twist = spec_.joints[j].twist.value_or(rigid ? kRigidTwist : M_PI / 2);
    }
    for (int j = 0; j < joints; ++j) {
      const JointSpec::Type type = s_.joints[j].type;
      if (type == JointSpec::Type::kHinge) addHinge(j);
      if (type == JointSpec::Type::kCone) addCone(j);
      if (type == JointSpec::Type::kPlanes) addPlanes(j);
    }
    for (const Limit& limit : s_.limits)
      if (!limit.region) checks_.checkRestPose(limit.joint, -limitValue(limit, s_.rest.data()));
    for (const PlaneLimit& limit : s_.plane_limits)
      checks_.checkRestPose(limit.joint, planeViolation(limit, s_.rest.data()));
  }

 private:
  Direction childDirection(int j, const Vec3& rest) const {
    const Joint& joint = s_.joints[j];
    if (!s_.segments[joint.child].group)
      return frames_.boneAlong(frames_.boneFrom(joint.child, joint.parent));
    Direction d;
    if (!frames_.fixedIn(joint.child, rest, d))
      checks_.fail(j, ".child", "its child's particles are in line");
    return d;
  }

  void addWithin(int j, const Direction& reference, const Direction& child, double angle) {
    if (angle > M_PI - kNegligibleAngle) return;
    add(j, Limit::Kind::kWithin, reference, child, Direction(), angle);
  }

  void add(int j, Limit::Kind kind, const Direction& reference, const Direction& child,
           const Direction& normal, double angle) {
    Limit limit;
    limit.kind = kind;
    limit.joint = j;
    limit.reference = reference;
    limit.child = child;
    limit.normal = normal;
    limit.angle = angle;
    limit.sin_angle = std::sin(angle);
    limit.cos_angle = std::cos(angle);
    if (std::isfinite(s_.joints[j].stiffness)) limit.compliance = 1 / s_.joints[j].stiffness;
    limit.damping = s_.joints[j].damping;
    if (particlesOf(limit) > LimitRow::kMaxParticles)
      checks_.fail(
          j, "", "its directions depend on more than 8 particles; give its parent a shorter chain");
    s_.limits.push_back(limit);
  }

  static int particlesOf(const Limit& limit) {
    std::vector<int> seen;
    for (const Direction* d : {&limit.reference, &limit.child, &limit.normal}) {
      if (d == &limit.normal && limit.kind == Limit::Kind::kWithin) continue;
      seen.insert(seen.end(), d->base.begin(), d->base.end());
      for (int k = 0; k < d->swings; ++k) {
        seen.push_back(d->swing[k].from);
        seen.push_back(d->swing[k].to);
      }
    }
    std::sort(seen.begin(), seen.end());
    return static_cast<int>(std::unique(seen.begin(), seen.end()) - seen.begin());
  }

  void addCone(int j) {
    const Joint& joint = s_.joints[j];
    Direction reference;
    if (!frames_.fixedIn(joint.parent, joint.axis, reference)) {
      if (s_.segments[joint.parent].group)
        checks_.fail(j, ".parent", "its parent's particles are in line");
      const std::pair<int, int> bone = frames_.parentBone(joint.parent, joint.child);
      if (frames_.restDirection(bone).cross(joint.axis).norm() > kParallelAxis ||
          frames_.restDirection(bone).dot(joint.axis) < 0)
        checks_.fail(
            j, ".axis",
            "nothing shows how its parent, a bone, is turned about itself; the axis must point "
            "along it, or the parent needs a joint that hangs it on a rigid group");
      reference = frames_.boneAlong(bone);
    }
    addWithin(j, reference, childDirection(j, joint.axis), joint.half_angle);
  }

  void addHinge(int j) {
    const Joint& joint = s_.joints[j];
    if (s_.segments[joint.parent].group) return addTurn(j, joint.twist);
    const std::pair<int, int> parent = frames_.parentBone(joint.parent, joint.child);
    const Vec3 u = frames_.restDirection(parent);
    if (u.cross(joint.axis).norm() < 0.1)
      checks_.fail(j, ".axis",
                   "the axis points along the parent bone, about which nothing can bend");
    const JointFrames::Bend bend = frames_.bend(j);
    double begin = joint.range.begin, end = joint.range.end;
    if (bend.side < 0) std::tie(begin, end) = std::pair(-end, -begin);
    if (begin < -M_PI / 2 || (begin > 0 && end > M_PI - begin)) return addTurn(j, joint.twist);
    const Direction child = childDirection(j, Vec3::Zero());
    addWithin(j, bend.parent, child, bendOfTurn(end, bend.sine));
    if (!bend.sided) {
      checks_.warn(j, "nothing shows how its parent, a bone, is turned about itself: it may bend " +
                          degrees(end) + " to any side");
      return;
    }
    const double back = std::acos(std::clamp(bend.sine * std::sin(begin), -1.0, 1.0));
    addWithin(j, bend.forward, child, back);
    if (joint.twist > M_PI / 2 - kNegligibleAngle) return;
    const Vec3 n = bend.side * joint.axis.cross(u).normalized();
    Direction forward;
    for (const double t : {M_PI / 2 - joint.twist, joint.twist - M_PI / 2}) {
      frames_.fixedIn(joint.parent, turned(t, u, n), forward);
      addWithin(j, forward, child, back);
    }
  }

  /// A hinge by its angle about the axis alone, and how far the child may leave its plane.
  void addTurn(int j, double twist) {
    const Joint& joint = s_.joints[j];
    const Vec3 w = frames_.childRest(j), zero = frames_.hingeZero(j);
    if (!(zero.norm() > 0.5) || w.cross(joint.axis).norm() < 0.1)
      checks_.fail(j, ".axis", "the axis points along the child, which cannot turn about it");
    const double middle = (joint.range.begin + joint.range.end) / 2;
    const Vec3 m = turned(middle, joint.axis, zero);
    const Direction child = childDirection(j, w);
    Direction reference, normal, axis;
    if (!frames_.fixedIn(joint.parent, m, reference) ||
        !frames_.fixedIn(joint.parent, joint.axis.cross(m), normal))
      checks_.fail(j, ".parent", "nothing shows how its parent is turned, so it has no angle");
    const double half = (joint.range.end - joint.range.begin) / 2;
    const bool free = twist > M_PI / 2 - kNegligibleAngle && !sharesAxis(joint);
    if (free)
      addLune(j, m, joint.axis.cross(m), child, half);
    else if (half < M_PI - kNegligibleAngle)
      add(j, Limit::Kind::kTurn, reference, child, normal, half);
    if (twist > M_PI / 2 - kNegligibleAngle || sharesAxis(joint)) return;
    const double tilt = std::acos(std::clamp(joint.axis.dot(w), -1.0, 1.0));
    frames_.fixedIn(joint.parent, joint.axis, axis);
    addWithin(j, axis, child, tilt + twist);
    frames_.fixedIn(joint.parent, -joint.axis, axis);
    addWithin(j, axis, child, M_PI - tilt + twist);
  }

  /// The directions within `half` of the half-plane of `middle` and the axis, `side` a quarter turn
  /// on, by rows that hold where the child points along the axis, too (limit.h).
  void addLune(int j, const Vec3& middle, const Vec3& side, const Direction& child, double half) {
    const int parent = s_.joints[j].parent;
    Direction first, second;
    if (half > M_PI / 2 + kNegligibleAngle) {
      if (half > M_PI - kNegligibleAngle) return;
      frames_.fixedIn(parent, middle, first);
      frames_.fixedIn(parent, side, second);
      return add(j, Limit::Kind::kWedge, first, child, second, half);
    }
    frames_.fixedIn(parent, std::sin(half) * middle - std::cos(half) * side, first);
    addWithin(j, first, child, M_PI / 2);
    if (half > M_PI / 2 - kNegligibleAngle) return;  // both are the same
    frames_.fixedIn(parent, std::sin(half) * middle + std::cos(half) * side, second);
    addWithin(j, second, child, M_PI / 2);
  }

  /// Two particles in common hold parent and child on an axis: no row need do that.
  bool sharesAxis(const Joint& joint) const {
    const Segment &parent = s_.segments[joint.parent], &child = s_.segments[joint.child];
    return std::count_if(child.particles.begin(), child.particles.end(), [&](int i) {
             return std::count(parent.particles.begin(), parent.particles.end(), i) > 0;
           }) > 1;
  }

  void addPlanes(int j) {
    const Joint& joint = s_.joints[j];
    if (s_.segments[joint.child].group)
      checks_.fail(j, ".child",
                   "planes project a bone; '" + s_.segments[joint.child].name +
                       "' is a rigid group, name a bone of it as a segment");
    PlaneLimit limit = frames_.planes(j);
    for (int k = 0; k < 3; ++k)
      if (!frames_.fixedIn(joint.parent, Vec3::Unit(k), limit.axes[k]))
        checks_.fail(j, ".parent", "nothing shows how its parent is turned");
    s_.plane_limits.push_back(limit);
    for (const PlaneLimit::Region& region : limit.regions) {
      if (!region.used) continue;
      const std::size_t known = s_.limits.size();
      addLune(j, region.middle, region.side, limit.child, region.half);
      for (std::size_t k = known; k < s_.limits.size(); ++k) s_.limits[k].region = true;
    }
  }

  const SkeletonSpec& spec_;
  Skeleton& s_;
  JointFrames frames_;
  JointChecks checks_;
};

}  // namespace

void addLimits(const SkeletonSpec& spec, Skeleton& skeleton) {
  LimitBuilder(spec, skeleton).build();
}

}  // namespace ragdoll
