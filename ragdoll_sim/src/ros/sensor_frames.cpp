#include "sensor_frames.h"

#include <utility>

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {

SensorFrames::SensorFrames(std::string frame_prefix) : frame_prefix_(std::move(frame_prefix)) {}

void SensorFrames::append(const Snapshot& world, const Posture& posture, bool whole,
                          const std_msgs::Header& header,
                          std::vector<geometry_msgs::TransformStamped>& out) {
  if (world.scene != scene_) {
    scene_ = world.scene;
    mounts_.clear();
    for (const Sensor& sensor : world.model->sensors)
      mounts_.push_back(sensorFrame(*world.model, *world.tracker, sensor));
  }
  for (std::size_t i = 0; i < mounts_.size(); ++i) {
    const SensorFrame& mount = mounts_[i];
    if (mount.frame < 0) continue;
    out.emplace_back();
    out.back().header = header;
    out.back().child_frame_id = frame_prefix_ + world.model->sensors[i].name;
    Pose pose = mount.local;
    if (whole) {
      out.back().header.frame_id = world.tracker->name(mount.frame);
    } else {
      const Pose& parent = posture.frames[mount.frame];
      pose = {parent.position + parent.orientation * mount.local.position,
              parent.orientation * mount.local.orientation};
    }
    out.back().transform = toTransform(pose);
  }
}

}  // namespace ragdoll
