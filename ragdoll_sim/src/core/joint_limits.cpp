// Joints of a model file, checked and made into limits: Joint -> Limit, PlaneLimit.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ragdoll_sim/core/direction.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/plane_limits.h"
#include "ragdoll_sim/core/skeleton.h"

namespace ragdoll {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kTolerance = 1 * kDegree;      ///< [rad] of a rest pose outside its own limits
constexpr double kNegligible = 1e-3 * kDegree;  ///< [rad] rounding in a file
constexpr double kRigidTwist = 5 * kDegree;     ///< [rad] play of a hinge on a rigid parent
constexpr double kThin = 1e-3;  ///< [-] sine below which directions count as parallel

std::string degrees(double angle) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f deg", angle / kDegree);
  return text;
}

Vec3 turned(double angle, const Vec3& axis, const Vec3& v) {
  return Eigen::AngleAxisd(angle, axis) * v;
}

class LimitBuilder {
 public:
  LimitBuilder(const SkeletonSpec& spec, Skeleton& skeleton) : spec_(spec), s_(skeleton) {}

  void build() {
    for (std::size_t j = 0; j < s_.joints.size(); ++j) checkJoint(static_cast<int>(j));
    for (std::size_t j = 0; j < s_.joints.size(); ++j) {
      const int joint = static_cast<int>(j);
      const JointSpec::Type type = s_.joints[j].type;
      if (type == JointSpec::Type::kHinge) addHinge(joint);
      if (type == JointSpec::Type::kCone) addCone(joint);
      if (type == JointSpec::Type::kPlanes) addPlanes(joint);
    }
    for (const Limit& limit : s_.limits) checkRestPose(limit.joint, violation(limit));
    for (const PlaneLimit& limit : s_.plane_limits)
      checkRestPose(limit.joint, planeViolation(limit, s_.rest.data()));
  }

 private:
  // --- what the joints' directions are carried by
  const std::string& where(int joint) const { return spec_.joints[joint].where; }
  [[noreturn]] void fail(int joint, const char* key, const std::string& what) const {
    throw Error(where(joint) + key, "joint '" + s_.joints[joint].name + "': " + what);
  }

  int shared(const Segment& a, const Segment& b) const {
    for (const int i : a.particles)
      if (std::count(b.particles.begin(), b.particles.end(), i)) return i;
    return -1;
  }

  int jointAbove(int segment) const {
    for (std::size_t j = 0; j < s_.joints.size(); ++j)
      if (s_.joints[j].child == segment) return static_cast<int>(j);
    return -1;
  }

  /// The segment whose frame a bone's frame is carried from, -1 if there is none.
  int parentOf(int segment) const {
    const int joint = jointAbove(segment);
    if (joint >= 0) return s_.joints[joint].parent;
    for (std::size_t g = 0; g < s_.segments.size(); ++g)
      if (s_.segments[g].group && shared(s_.segments[g], s_.segments[segment]) >= 0)
        return static_cast<int>(g);
    return -1;
  }

  /// A bone's ends, `from` being the one that `other` has too (the first if none is shared).
  std::pair<int, int> boneFrom(int segment, int other) const {
    const std::vector<int>& p = s_.segments[segment].particles;
    const bool turn = other >= 0 && shared(s_.segments[segment], s_.segments[other]) == p[1];
    return turn ? std::pair(p[1], p[0]) : std::pair(p[0], p[1]);
  }

  /// Towards the joint that `child` hangs on.
  std::pair<int, int> parentBone(int parent, int child) const {
    const std::vector<int>& p = s_.segments[parent].particles;
    const bool turn = shared(s_.segments[parent], s_.segments[child]) == p[0];
    return turn ? std::pair(p[1], p[0]) : std::pair(p[0], p[1]);
  }

  Vec3 restDirection(const std::pair<int, int>& bone) const {
    return (s_.rest.col(bone.second) - s_.rest.col(bone.first)).normalized();
  }

  static Direction boneAlong(const std::pair<int, int>& bone) {
    Direction d;
    d.bone = true;
    d.base = {bone.first, bone.second, bone.second};
    return d;
  }

  /// The three particles of a group that span the largest triangle; false if all are in line.
  bool triangle(const Segment& group, std::array<int, 3>& best) const {
    const std::vector<int>& p = group.particles;
    double largest = 0, size = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t j = i + 1; j < p.size(); ++j) {
        const Vec3 e = s_.rest.col(p[j]) - s_.rest.col(p[i]);
        size = std::max(size, e.squaredNorm());
        for (std::size_t k = j + 1; k < p.size(); ++k) {
          const double area = e.cross(Vec3(s_.rest.col(p[k]) - s_.rest.col(p[i]))).norm();
          if (area <= 1.000001 * largest) continue;  // mirror images differ by rounding only
          largest = area;
          best = {p[i], p[j], p[k]};
        }
      }
    return largest > kThin * size;
  }

  Vec3 coefficients(const std::array<int, 3>& base, const Vec3& v) const {
    Eigen::Matrix3d A;
    A.col(0) = s_.rest.col(base[1]) - s_.rest.col(base[0]);
    A.col(1) = s_.rest.col(base[2]) - s_.rest.col(base[0]);
    A.col(2) = A.col(0).cross(A.col(1));
    return A.inverse() * v;
  }

  /// The middle of what a joint allows its child, in the rest pose's axes.
  Vec3 centre(int segment) const {
    const int j = jointAbove(segment), parent = parentOf(segment);
    const Vec3 rest = restDirection(boneFrom(segment, parent));
    if (j < 0) return rest;
    const Joint& joint = s_.joints[j];
    Vec3 centre = rest;
    if (joint.type == JointSpec::Type::kCone) centre = joint.axis;
    if (joint.type == JointSpec::Type::kHinge)
      centre = turned((joint.range.begin + joint.range.end) / 2, joint.axis, hingeZero(j));
    if (joint.type == JointSpec::Type::kPlanes) centre = meanAllowed(j, rest);
    return 1 + centre.dot(rest) > kThin ? centre : rest;
  }

  /// Where a hinge's angle is zero: straight on, or the rest pose on a rigid parent.
  Vec3 hingeZero(int j) const {
    const Joint& joint = s_.joints[j];
    if (!s_.segments[joint.parent].group)
      return restDirection(parentBone(joint.parent, joint.child));
    const Vec3 w = childRest(j);
    return (w - joint.axis.dot(w) * joint.axis).normalized();
  }

  /// A direction fixed in a segment, given in the rest pose's axes. False: nothing shows it.
  bool fixedIn(int segment, const Vec3& rest, Direction& d, int depth = 0) const {
    const Segment& g = s_.segments[segment];
    if (g.group) {
      if (!triangle(g, d.base)) return false;
      d.c = coefficients(d.base, rest);
      d.swings = 0;
      return true;
    }
    const int parent = parentOf(segment);
    if (parent < 0 || depth == Direction::kMaxSwings) return false;
    const std::pair<int, int> bone = boneFrom(segment, parent);
    const Vec3 middle = centre(segment);
    Direction start;
    if (!fixedIn(parent, middle, start, depth + 1)) return false;
    if (!fixedIn(parent, swung(restDirection(bone), middle, rest), d, depth + 1)) return false;
    if (d.swings == Direction::kMaxSwings) return false;
    d.swing[d.swings++] = {bone.first, bone.second, start.c};
    return true;
  }

  // --- the child
  /// Away from the joint: a bone's direction, or from the shared particles to the rest of a group.
  Vec3 childRest(int j) const {
    const Joint& joint = s_.joints[j];
    const Segment& child = s_.segments[joint.child];
    if (!child.group) return restDirection(boneFrom(joint.child, joint.parent));
    const Segment& parent = s_.segments[joint.parent];
    Vec3 near = Vec3::Zero(), far = Vec3::Zero();
    int count = 0;
    for (const int i : child.particles) {
      const bool common = std::count(parent.particles.begin(), parent.particles.end(), i) > 0;
      (common ? near : far) += s_.rest.col(i);
      count += common;
    }
    const int others = static_cast<int>(child.particles.size()) - count;
    Vec3 w = far / std::max(others, 1) - near / std::max(count, 1);
    w -= joint.axis.dot(w) * joint.axis;
    return w.norm() > kMinLength ? Vec3(w.normalized()) : Vec3(joint.axis.unitOrthogonal());
  }

  Direction childDirection(int j, const Vec3& rest) const {
    const Joint& joint = s_.joints[j];
    if (!s_.segments[joint.child].group) return boneAlong(boneFrom(joint.child, joint.parent));
    Direction d;
    if (!fixedIn(joint.child, rest, d)) fail(j, ".child", "its child's particles are in line");
    return d;
  }

  // --- rows
  void addWithin(int j, const Direction& reference, const Direction& child, double angle) {
    if (angle > M_PI - kNegligible) return;
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
      fail(j, "",
           "its directions depend on more than 8 particles; give its parent a shorter chain");
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
    if (!fixedIn(joint.parent, joint.axis, reference)) {
      if (s_.segments[joint.parent].group) fail(j, ".parent", "its parent's particles are in line");
      const std::pair<int, int> bone = parentBone(joint.parent, joint.child);
      if (restDirection(bone).cross(joint.axis).norm() > kThin ||
          restDirection(bone).dot(joint.axis) < 0)
        fail(j, ".axis",
             "nothing shows how its parent, a bone, is turned about itself; the axis must point "
             "along it, or the parent needs a joint that hangs it on a rigid group");
      reference = boneAlong(bone);
    }
    addWithin(j, reference, childDirection(j, joint.axis), joint.half_angle);
  }

  void addHinge(int j) {
    const Joint& joint = s_.joints[j];
    if (s_.segments[joint.parent].group) return addTurn(j, joint.twist);
    const std::pair<int, int> parent = parentBone(joint.parent, joint.child);
    const Vec3 u = restDirection(parent);
    if (u.cross(joint.axis).norm() < 0.1)
      fail(j, ".axis", "the axis points along the parent bone, about which nothing can bend");
    // The mirrored hinge has the same angles with other signs: let it bend the way it bends most.
    double begin = joint.range.begin, end = joint.range.end, side = 1;
    if (-begin > end) {
      std::tie(begin, end) = std::pair(-end, -begin);
      side = -1;
    }
    const Vec3 n = side * joint.axis.cross(u).normalized();
    if (begin < -M_PI / 2 || (begin > 0 && end > M_PI - begin)) return addTurn(j, joint.twist);
    const Direction child = childDirection(j, Vec3::Zero());
    addWithin(j, boneAlong(parent), child, end);
    Direction forward;
    if (!fixedIn(joint.parent, n, forward)) {
      warn(j, "nothing shows how its parent, a bone, is turned about itself: it may bend " +
                  degrees(end) + " to any side");
      return;
    }
    addWithin(j, forward, child, M_PI / 2 - begin);
    if (joint.twist > M_PI / 2 - kNegligible) return;
    for (const double t : {M_PI / 2 - joint.twist, joint.twist - M_PI / 2}) {
      fixedIn(joint.parent, turned(t, u, n), forward);
      addWithin(j, forward, child, M_PI / 2 - begin);
    }
  }

  /// A hinge by its angle about the axis alone, and how far the child may leave its plane.
  void addTurn(int j, double twist) {
    const Joint& joint = s_.joints[j];
    const Vec3 w = childRest(j), zero = hingeZero(j);
    if (!(zero.norm() > 0.5) || w.cross(joint.axis).norm() < 0.1)
      fail(j, ".axis", "the axis points along the child, which cannot turn about it");
    const double middle = (joint.range.begin + joint.range.end) / 2;
    const Vec3 m = turned(middle, joint.axis, zero);
    const Direction child = childDirection(j, w);
    Direction reference, normal, axis;
    if (!fixedIn(joint.parent, m, reference) || !fixedIn(joint.parent, joint.axis.cross(m), normal))
      fail(j, ".parent", "nothing shows how its parent is turned, so it has no angle");
    const double half = (joint.range.end - joint.range.begin) / 2;
    if (half < M_PI - kNegligible) add(j, Limit::Kind::kTurn, reference, child, normal, half);
    if (twist > M_PI / 2 - kNegligible || sharesAxis(joint)) return;
    const double tilt = std::acos(std::clamp(joint.axis.dot(w), -1.0, 1.0));
    fixedIn(joint.parent, joint.axis, axis);
    addWithin(j, axis, child, tilt + twist);
    fixedIn(joint.parent, -joint.axis, axis);
    addWithin(j, axis, child, M_PI - tilt + twist);
  }

  /// Two particles in common hold parent and child on an axis: no row need do that.
  bool sharesAxis(const Joint& joint) const {
    const Segment &parent = s_.segments[joint.parent], &child = s_.segments[joint.child];
    return std::count_if(child.particles.begin(), child.particles.end(), [&](int i) {
             return std::count(parent.particles.begin(), parent.particles.end(), i) > 0;
           }) > 1;
  }

  // --- planes
  PlaneLimit planes(int j) const {
    const Joint& joint = s_.joints[j];
    PlaneLimit limit;
    limit.joint = j;
    limit.child = boneAlong(boneFrom(joint.child, joint.parent));
    if (std::isfinite(joint.stiffness)) limit.compliance = 1 / joint.stiffness;
    limit.damping = joint.damping;
    const bool left = s_.rest(1, limit.child.base[0]) > kMinLength;
    const bool bone_parent = !s_.segments[joint.parent].group;
    for (int k = 0; k < 3; ++k)
      if (joint.planes[k])
        limit.regions[k] = planeRegion(limitPlane(k, left, bone_parent), *joint.planes[k]);
    return limit;
  }

  /// The mean of the directions that a `planes` joint allows; `rest` if they cancel.
  Vec3 meanAllowed(int j, const Vec3& rest) const {
    constexpr int kSamples = 2000;
    const PlaneLimit limit = planes(j);
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < kSamples; ++i) {  // a spiral of equal areas from pole to pole
      const double z = 1 - (2 * i + 1.0) / kSamples, r = std::sqrt(1 - z * z);
      const double angle = M_PI * (3 - std::sqrt(5.0)) * i;
      const Vec3 d(r * std::cos(angle), r * std::sin(angle), z);
      if (isAllowed(limit, d)) sum += d;
    }
    return sum.norm() > 1e-2 * kSamples ? Vec3(sum.normalized()) : rest;
  }

  void addPlanes(int j) {
    const Joint& joint = s_.joints[j];
    if (s_.segments[joint.child].group)
      fail(j, ".child",
           "planes project a bone; '" + s_.segments[joint.child].name +
               "' is a rigid group, name a bone of it as a segment");
    PlaneLimit limit = planes(j);
    for (int k = 0; k < 3; ++k)
      if (!fixedIn(joint.parent, Vec3::Unit(k), limit.axes[k]))
        fail(j, ".parent", "nothing shows how its parent is turned");
    s_.plane_limits.push_back(limit);
  }

  // --- checks
  void checkJoint(int j) {
    Joint& joint = s_.joints[j];
    const Segment &parent = s_.segments[joint.parent], &child = s_.segments[joint.child];
    if (!adjacent(parent, child))
      fail(j, "",
           "parent '" + parent.name + "' and child '" + child.name +
               "' share no particle and no stick joins them");
    for (const Segment* g : {&parent, &child})
      if (!g->group &&
          !(Vec3(s_.rest.col(g->particles[0]) - s_.rest.col(g->particles[1])).norm() > kMinLength))
        fail(j, "", "segment '" + g->name + "' has no length in the rest pose");
    if (joint.type == JointSpec::Type::kHinge) checkRange(j, joint.range, ".range_deg");
    if (joint.type == JointSpec::Type::kCone && !(joint.half_angle > 0 && joint.half_angle < M_PI))
      fail(j, ".half_angle_deg",
           "half angle is " + degrees(joint.half_angle) + "; it must be in (0, 180) deg");
    static const char* const kKeys[] = {".xy_deg", ".yz_deg", ".xz_deg"};
    if (joint.type == JointSpec::Type::kPlanes)
      for (int k = 0; k < 3; ++k)
        if (joint.planes[k] && !(joint.planes[k]->end > joint.planes[k]->begin &&
                                 joint.planes[k]->end - joint.planes[k]->begin < 2 * M_PI))
          fail(j, kKeys[k], "a region must end above its begin and be less than a full turn");
    if (!(joint.stiffness > 0))
      fail(j, ".stiffness", "stiffness must be > 0 [N m/rad]; leave it out for a hard limit");
    if (!(std::isfinite(joint.damping) && joint.damping >= 0))
      fail(j, ".damping", "damping must be >= 0 [N m s/rad]");
    const std::optional<double>& twist = spec_.joints[j].twist;
    if (twist && !(*twist > 0 && *twist <= M_PI / 2))
      fail(j, ".twist_deg", "twist is " + degrees(*twist) + "; it must be in (0, 90] deg");
    joint.twist = twist.value_or(parent.group ? kRigidTwist : M_PI / 2);
  }

  void checkRange(int j, const AngleRange& range, const char* key) const {
    if (!(range.begin < range.end && range.begin > -M_PI && range.end <= M_PI + kNegligible))
      fail(j, key,
           "range is " + degrees(range.begin) + " to " + degrees(range.end) +
               "; it must begin below its end, within (-180, 180] deg");
  }

  bool adjacent(const Segment& a, const Segment& b) const {
    if (shared(a, b) >= 0) return true;
    const auto in = [](const Segment& g, int i) {
      return std::count(g.particles.begin(), g.particles.end(), i) > 0;
    };
    return std::any_of(s_.sticks.begin(), s_.sticks.end(), [&](const Stick& k) {
      return (in(a, k.a) && in(b, k.b)) || (in(a, k.b) && in(b, k.a));
    });
  }

  double violation(const Limit& limit) const { return -limitValue(limit, s_.rest.data()); }

  /// A body that starts outside its limits jumps at the first step.
  void checkRestPose(int j, double by) {
    if (by <= kNegligible) return;
    const std::string what =
        "the rest pose is " + degrees(by) + " outside its limit, " + allowed(j);
    if (by > kTolerance) fail(j, "", what + "; change the limit or the particles' positions");
    warn(j, what);
  }

  std::string allowed(int j) const {
    const Joint& joint = s_.joints[j];
    const auto span = [](const AngleRange& r) {
      return degrees(r.begin) + " to " + degrees(r.end);
    };
    if (joint.type == JointSpec::Type::kHinge) {
      const Vec3 zero = hingeZero(j), w = childRest(j);
      const double now = std::atan2(w.dot(joint.axis.cross(zero)), w.dot(zero));
      return "bent by " + degrees(now) + " where " + span(joint.range) + " are allowed";
    }
    if (joint.type == JointSpec::Type::kCone) {
      const Vec3 w = s_.segments[joint.child].group ? joint.axis : childRest(j);
      return degrees(std::acos(std::clamp(w.dot(joint.axis), -1.0, 1.0))) +
             " off its axis where 0 to " + degrees(joint.half_angle) + " are allowed";
    }
    const PlaneLimit limit = planes(j);
    const bool left = s_.rest(1, limit.child.base[0]) > kMinLength;
    std::string text;
    for (int k = 0; k < 3; ++k) {
      if (!joint.planes[k]) continue;
      const LimitPlane plane = limitPlane(k, left, !s_.segments[joint.parent].group);
      static const char* const kNames[] = {"xy", "yz", "xz"};
      text += (text.empty() ? "" : ", ") +
              (kNames[k] + (" " + degrees(planeAngle(plane, childRest(j))))) + " where " +
              span(*joint.planes[k]) + " are allowed";
    }
    return text;
  }

  void warn(int j, const std::string& what) {
    s_.warnings.push_back(where(j) + ": joint '" + s_.joints[j].name + "': " + what);
  }

  const SkeletonSpec& spec_;
  Skeleton& s_;
};

}  // namespace

void addLimits(const SkeletonSpec& spec, Skeleton& skeleton) {
  LimitBuilder(spec, skeleton).build();
}

}  // namespace ragdoll
