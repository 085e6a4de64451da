// Tells what listens: a thread of its own ticks at ~publish_rate, copies the world between two
// steps, and publishes from the copy.
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "contact_publisher.h"
#include "handles.h"
#include "imu_publisher.h"
#include "markers.h"
#include "metrics.h"
#include "outbox.h"
#include "parameters.h"
#include "ragdoll_sim/body/angles.h"
#include "ragdoll_sim/world/simulation.h"
#include "ros_clock.h"
#include "sensor_frames.h"
#include "topic.h"

namespace ragdoll {

class Publisher {
 public:
  Publisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
            const Parameters& parameters, Troubles troubles, Handles& handles);
  ~Publisher();

  /// Draw the joints' limits, or no more.
  void showLimits(bool show) { markers_.showLimits(show); }
  /// Draw contacts and their forces, or no more.
  void showContacts(bool show) { markers_.showContacts(show); }
  /// What bodies wear; empty: what the scene says.
  void setCoat(const std::string& coat) { markers_.setCoat(coat); }

  /// The end of publishing: what rviz shows has no lifetime, so it is taken away.
  void clearMarkers();

  /// Returns once the present state has been published, whatever the tick.
  void publishNow();

 private:
  void stop();
  void run();
  /// When it is due, because someone waits for it, or as nothing has been due for long.
  enum class Why { kDue, kDemanded, kIdle };
  void tick(Why why);
  void publishDue(bool demanded, bool idle);
  const Posture& posture();  ///< what is shown at this moment, from world_
  void fitQueues(const Posture& posture);
  void publishModel(const ros::Time& now);
  void publishTf(const Posture& posture, const ros::Time& now);
  const std::string& tfBodies();  ///< ~tf_bodies, or what this scene's number of bodies asks for
  void publishState(const ros::Time& now, Why why);
  void publishEvents(const ros::Time& now);
  void publishContacts(const ros::Time& now);
  tf2_msgs::TFMessage tfMessage(const Posture& posture, const std_msgs::Header& header);
  sensor_msgs::JointState jointMessage(const Posture& posture, const std_msgs::Header& header);
  void publishJoints(const Posture& posture, const ros::Time& now);

  Simulation& simulation_;
  const RosClock& clock_;
  const Parameters parameters_;
  ros::Publisher model_, pokes_, followed_;
  Topic state_, joints_, tf_;
  ImuPublisher imus_;
  SensorFrames sensor_frames_;
  ContactPublisher contacts_;
  bool keeps_contacts_ = false;  ///< the world does
  MarkerPublisher markers_;
  Handles& handles_;
  Metrics metrics_;

  Outbox out_;
  Snapshot world_;
  Posture between_;
  std::shared_ptr<const Scene> told_scene_, fitted_scene_;
  std::uint64_t told_revision_ = 0;
  std::uint32_t told_run_ = 0;
  std::shared_ptr<const Scene> tf_scene_;  ///< that tf_bodies_ is of
  std::string tf_bodies_;
  std::vector<double> angles_before_, angles_after_;
  std::optional<JointAngles> angles_;
  std::shared_ptr<const Scene> angles_scene_;
  ros::Time last_stamp_;
  std::atomic<bool> newcomer_{false};  ///< someone new listens to ~state

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::uint64_t asked_ = 0, answered_ = 0;  ///< publishNow
  bool sampled_ = false;                    ///< the simulation has samples (~publish_every)
  bool stopping_ = false;
  std::thread thread_;  // last
};

}  // namespace ragdoll
