// Checks of the joints of a model file. Private to the core.
#pragma once

#include <string>

#include "ragdoll_sim/core/joint_frames.h"

namespace ragdoll {

constexpr double kNegligibleAngle = 1e-3 * M_PI / 180;  ///< [rad] rounding in a file

class JointChecks {
 public:
  JointChecks(const SkeletonSpec& spec, Skeleton& skeleton)
      : spec_(spec), s_(skeleton), frames_(skeleton) {}

  /// What the file says of it. Throws Error.
  void checkJoint(int joint) const;
  /// A rest pose outside its limits by an angle [rad] is an Error; by little it is corrected
  /// (start_pose.h).
  void checkRestPose(int joint, double by) const;

  /// key: of the joint in the file, as ".axis".
  [[noreturn]] void fail(int joint, const char* key, const std::string& what) const;
  void warn(int joint, const std::string& what) const;

 private:
  void checkRange(int joint, const AngleRange& range, const char* key) const;
  bool adjacent(const Segment& a, const Segment& b) const;
  std::string allowed(int joint) const;  ///< its rest pose and its limit, in words

  const SkeletonSpec& spec_;
  Skeleton& s_;
  JointFrames frames_;
};

/// An angle [rad] as "12.3 deg".
std::string degrees(double angle);

}  // namespace ragdoll
