#include "ragdoll_sim/ros/frame_lookup.h"

#include <ros/console.h>
#include <ros/this_node.h>

#include <map>
#include <sstream>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

/// Of the YAML text in which tf2 tells what it has heard: {frame: who has published it}.
std::map<std::string, std::string> broadcasters(const tf2_ros::Buffer& buffer) {
  std::map<std::string, std::string> found;
  std::istringstream text(buffer.allFramesAsYAML());
  std::string line, frame;
  while (std::getline(text, line)) {
    if (!line.empty() && line[0] != ' ') frame = line.substr(0, line.rfind(':'));
    const std::size_t at = line.find("broadcaster: '");
    if (at == std::string::npos) continue;
    const std::size_t begin = line.find('\'', at) + 1;
    found[frame] = line.substr(begin, line.rfind('\'') - begin);
  }
  return found;
}

/// TF lets infinite numbers through.
bool isFinite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite();
}

}  // namespace

FrameLookup::FrameLookup(const std::string& world_frame) : world_frame_(world_frame) {
  node_.setCallbackQueue(&queue_);
  listener_.emplace(buffer_, node_, false);
  thread_ = std::thread(&FrameLookup::listen, this);
}

FrameLookup::~FrameLookup() {
  ends_ = true;
  thread_.join();
}

void FrameLookup::listen() {
  constexpr double kPatience = 0.01;  // [s] after which it looks whether to end
  while (!ends_) {
    try {
      queue_.callAvailable(ros::WallDuration(kPatience));
    } catch (const std::exception& e) {
      ROS_WARN_THROTTLE(1, "/tf ignored: %s", e.what());
    }
  }
}

std::string FrameLookup::normal(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

bool FrameLookup::isWorld(const std::string& frame) const {
  return frame.empty() || normal(frame) == world_frame_;
}

std::vector<std::string> FrameLookup::others() const {
  std::vector<std::string> names;
  for (const auto& [frame, broadcaster] : broadcasters(buffer_))
    if (broadcaster != ros::this_node::getName()) names.push_back(frame);
  return names;
}

Pose FrameLookup::inWorld(const std::string& frame, const Names& own) const {
  if (isWorld(frame)) return Pose();
  try {
    const Pose pose = fromTransform(
        buffer_.lookupTransform(world_frame_, normal(frame), ros::Time(0)).transform);
    if (!isFinite(pose))
      throw Error("", "frame '" + frame + "' is at no finite pose in TF; it must be finite numbers");
    return pose;
  } catch (const tf2::LookupException&) {
    const std::vector<std::string> others = this->others();
    throw Error("", "unknown frame '" + frame + "'; there are " + world_frame_ +
                        "; of other nodes: " + (others.empty() ? "none" : listed(others)) +
                        (own ? "; of the ragdolls: " + listed(own()) : ""));
  } catch (const tf2::TransformException& e) {
    throw Error("",
                "frame '" + frame + "' is not connected to '" + world_frame_ + "': " + e.what());
  }
}

std::optional<StampedPose> FrameLookup::find(const std::string& frame) const {
  if (isWorld(frame)) return StampedPose();
  try {
    const auto t = buffer_.lookupTransform(world_frame_, normal(frame), ros::Time(0));
    const StampedPose found{fromTransform(t.transform), t.header.stamp};
    if (!isFinite(found.pose)) return std::nullopt;
    return found;
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

}  // namespace ragdoll
