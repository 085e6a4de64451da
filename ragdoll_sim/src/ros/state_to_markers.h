// Draws recorded runs: ~markers and /tf from ~model, ~state, ~pokes and ~followed, as the node
// that simulated them published them. Bears that node's name, so that what a bag plays arrives here
// and what is drawn goes where rviz expects it.
#pragma once

#include <ragdoll_msgs/FollowedFrame.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ragdoll_msgs/State.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/transform_broadcaster.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame_lookup.h"
#include "markers.h"
#include "ragdoll_sim/ros/any_model.h"
#include "ragdoll_sim/world/follow.h"
#include "ragdoll_sim/world/simulation.h"
#include "sensor_frames.h"

namespace ragdoll {

class StateToMarkers {
 public:
  /// coat: overrides the scene's unless empty. frame_prefix: of the node that was recorded. Needs a
  /// spinner of one thread.
  StateToMarkers(ros::NodeHandle& nh, const std::string& coat, const std::string& frame_prefix);

 private:
  struct Told {
    Event event;
    std::uint64_t end = 0;  ///< the first step without it
  };

  void hearModel(const ros::MessageEvent<AnyModel const>& event);
  void model(const ragdoll_msgs::Model& message);
  void state(const ragdoll_msgs::State& message);
  void poke(const ragdoll_msgs::PokeEvent& message);
  void followed(const ragdoll_msgs::FollowedFrame& message);
  void transforms(const ros::MessageEvent<tf2_msgs::TFMessage const>& event);
  void draw();

  void hearEarly();
  void tell(const Poke& poke, std::uint32_t run);
  void gatherActed(std::uint64_t before, std::uint64_t now);
  void placeObstacles();
  void publishTf();

  ros::NodeHandle nh_;
  std::string coat_, frame_prefix_, world_frame_;
  std::vector<ros::Subscriber> subscribers_;
  ros::WallTimer timer_;
  tf2_ros::TransformBroadcaster tf_;
  std::unique_ptr<MarkerPublisher> markers_;
  std::unique_ptr<FrameLookup> frames_;
  SensorFrames sensor_frames_;
  Snapshot world_;  ///< its state is the last that was heard
  Follow follow_;
  std::vector<Told> told_;
  std::map<std::string, FollowedFrame> told_glides_;  ///< the last of each frame
  bool heard_ = false;                                ///< a state of the present model
  std::vector<ragdoll_msgs::PokeEvent> early_pokes_;  ///< before the first model
  std::optional<ragdoll_msgs::State> early_state_;    ///< the last before the first model
  ros::Time last_stamp_;
  ros::WallTime recorded_tf_;  ///< when /tf last brought the ragdolls' frames from elsewhere
};

}  // namespace ragdoll
