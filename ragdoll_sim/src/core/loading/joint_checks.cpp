#include "core/loading/joint_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

constexpr double kTolerance = M_PI / 180;  ///< [rad] of a rest pose outside its own limits

}  // namespace

std::string degrees(double angle) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f deg", angle * 180 / M_PI);
  return text;
}

void JointChecks::fail(int j, const char* key, const std::string& what) const {
  const JointSpec& joint = spec_.joints[j];
  throw Error(joint.where + key, "joint '" + joint.name + "': " + what);
}

void JointChecks::warn(int j, const std::string& what) const {
  const JointSpec& joint = spec_.joints[j];
  s_.warnings.push_back(joint.where + ": joint '" + joint.name + "': " + what);
}

void JointChecks::checkJoint(int j) const {
  const Joint& joint = s_.joints[j];
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
}

void JointChecks::checkRange(int j, const AngleRange& range, const char* key) const {
  if (!(range.begin < range.end && range.begin > -M_PI && range.end <= M_PI + kNegligibleAngle))
    fail(j, key,
         "range is " + degrees(range.begin) + " to " + degrees(range.end) +
             "; it must begin below its end, within (-180, 180] deg");
}

bool JointChecks::adjacent(const Segment& a, const Segment& b) const {
  if (JointFrames::shared(a, b) >= 0) return true;
  const auto in = [](const Segment& g, int i) {
    return std::count(g.particles.begin(), g.particles.end(), i) > 0;
  };
  return std::any_of(s_.sticks.begin(), s_.sticks.end(), [&](const Stick& k) {
    return (in(a, k.a) && in(b, k.b)) || (in(a, k.b) && in(b, k.a));
  });
}

void JointChecks::checkRestPose(int j, double by) const {
  if (by <= kTolerance) return;
  fail(j, "",
       "the rest pose is " + degrees(by) + " outside its limit, " + allowed(j) +
           "; change the limit or the particles' positions");
}

std::string JointChecks::allowed(int j) const {
  const Joint& joint = s_.joints[j];
  const auto span = [](const AngleRange& r) { return degrees(r.begin) + " to " + degrees(r.end); };
  if (joint.type == JointSpec::Type::kHinge) {
    const Vec3 zero = frames_.hingeZero(j), w = frames_.childRest(j);
    const double now = std::atan2(w.dot(joint.axis.cross(zero)), w.dot(zero));
    const std::string bend =
        "bent by " + degrees(now) + " where " + span(joint.range) + " are allowed";
    const double least = joint.range.begin - kTolerance, most = joint.range.end + kTolerance;
    if (now < least || now > most) return bend;
    return bend + ", but farther out of the hinge's plane than twist_deg (" + degrees(joint.twist) +
           ") allows";
  }
  if (joint.type == JointSpec::Type::kCone) {
    const Vec3 w = s_.segments[joint.child].group ? joint.axis : frames_.childRest(j);
    return degrees(std::acos(std::clamp(w.dot(joint.axis), -1.0, 1.0))) +
           " off its axis where 0 to " + degrees(joint.half_angle) + " are allowed";
  }
  const PlaneLimit limit = frames_.planes(j);
  const bool left = s_.rest(1, limit.child.base[0]) > kMinLength;
  std::string text;
  for (int k = 0; k < 3; ++k) {
    if (!joint.planes[k]) continue;
    const LimitPlane plane = limitPlane(k, left, !s_.segments[joint.parent].group);
    static const char* const kNames[] = {"xy", "yz", "xz"};
    text += (text.empty() ? "" : ", ") +
            (kNames[k] + (" " + degrees(planeAngle(plane, frames_.childRest(j))))) + " where " +
            span(*joint.planes[k]) + " are allowed";
  }
  return text;
}

}  // namespace ragdoll
