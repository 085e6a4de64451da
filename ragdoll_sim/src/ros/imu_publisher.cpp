#include "imu_publisher.h"

#include <ros/master.h>
#include <sensor_msgs/Imu.h>

#include <algorithm>
#include <utility>

#include "ragdoll_sim/ros/convert.h"
#include "topic_names.h"

namespace ragdoll {
namespace {

constexpr int kSampleQueue = 10000;  ///< a slow tick has many samples, and none is to be missing

void setVariance(double deviation, boost::array<double, 9>& covariance) {
  covariance.fill(0);
  for (int axis = 0; axis < 3; ++axis) covariance[4 * axis] = deviation * deviation;
}

sensor_msgs::Imu toImu(const Sensor& sensor, const ImuSample& sample,
                       const std_msgs::Header& header) {
  sensor_msgs::Imu m;
  m.header = header;
  m.orientation = toQuaternion(sample.pose.orientation);
  m.angular_velocity = toVector3(sample.angular_velocity);
  m.linear_acceleration = toVector3(sample.acceleration);
  setVariance(sensor.gyroscope_noise, m.angular_velocity_covariance);
  setVariance(sensor.accelerometer_noise, m.linear_acceleration_covariance);
  return m;
}

}  // namespace

ImuPublisher::ImuPublisher(ros::NodeHandle& nh, std::string frame_prefix)
    : nh_(nh), frame_prefix_(std::move(frame_prefix)) {}

void ImuPublisher::follow(const Snapshot& world) {
  if (world.scene == scene_) return;
  // To advertise would wait for the master; the next state tries again.
  if (!world.model->sensors.empty() && !ros::master::check()) return;
  scene_ = world.scene;
  topics_.clear();
  std::vector<std::string> names;
  for (const Sensor& sensor : world.model->sensors) names.push_back("imu/" + sensor.name);
  for (const std::string& topic : topicNames(names))
    topics_.push_back(nh_.advertise<sensor_msgs::Imu>(topic, kSampleQueue));
}

/// Between the last moment told and now, which is that of the state: however fast time passes,
/// stamps rise.
ros::Time ImuPublisher::stampOf(const Snapshot& world, double time, const ros::Time& now) const {
  const double age = std::max(0.0, world.state.time - time);
  if (last_.stamp.isZero() || now < last_.stamp)
    return now - ros::Duration(std::min(age, now.toSec()));
  const double passed = world.progress.simulated - last_.simulated;
  const double share = passed > 0 ? std::min(1.0, age / passed) : 0;
  return now - ros::Duration(share * (now - last_.stamp).toSec());
}

void ImuPublisher::publish(const Snapshot& world, const ros::Time& now) {
  follow(world);
  for (const ImuSample& sample : world.imu) {
    if (sample.sensor >= static_cast<int>(topics_.size())) continue;  // of another scene
    if (topics_[sample.sensor].getNumSubscribers() == 0) continue;
    const Sensor& sensor = world.model->sensors[sample.sensor];
    const ros::Time stamp = stampOf(world, sample.time, now);
    topics_[sample.sensor].publish(
        toImu(sensor, sample, toHeader(frame_prefix_ + sensor.name, stamp)));
  }
  last_ = {world.progress.simulated, now};
}

}  // namespace ragdoll
