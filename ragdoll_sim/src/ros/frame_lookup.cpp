#include "ragdoll_sim/ros/frame_lookup.h"

#include <algorithm>
#include <vector>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

constexpr std::size_t kMaxNames = 40;  ///< in a message; more helps nobody

std::string frameNames(const tf2_ros::Buffer& buffer) {
  std::vector<std::string> names;
  buffer._getFrameStrings(names);
  std::sort(names.begin(), names.end());
  const bool more = names.size() > kMaxNames;
  if (more) names.resize(kMaxNames);
  return names.empty() ? "none" : joined(names) + (more ? ", ..." : "");
}

}  // namespace

std::string FrameLookup::normal(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

bool FrameLookup::isWorld(const std::string& frame) const {
  return frame.empty() || normal(frame) == world_frame_;
}

Pose FrameLookup::inWorld(const std::string& frame) const {
  if (isWorld(frame)) return Pose();
  try {
    return fromTransform(
        buffer_.lookupTransform(world_frame_, normal(frame), ros::Time(0)).transform);
  } catch (const tf2::LookupException&) {
    throw Error("", "unknown frame '" + frame + "'; there are " + world_frame_ +
                        " (or \"\") and, of TF, " + frameNames(buffer_));
  } catch (const tf2::TransformException& e) {
    throw Error("",
                "frame '" + frame + "' is not connected to '" + world_frame_ + "': " + e.what());
  }
}

std::optional<StampedPose> FrameLookup::find(const std::string& frame) const {
  if (isWorld(frame)) return StampedPose();
  try {
    const auto t = buffer_.lookupTransform(world_frame_, normal(frame), ros::Time(0));
    return StampedPose{fromTransform(t.transform), t.header.stamp};
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

}  // namespace ragdoll
