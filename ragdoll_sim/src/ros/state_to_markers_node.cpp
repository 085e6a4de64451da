// The node state_to_markers: draws what a bag plays. Named like the node that was recorded.
#include <ros/ros.h>

#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/core/error.h"
#include "state_to_markers.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "ragdoll");
  ros::NodeHandle nh("~");
  try {
    const auto coat = nh.param<std::string>("coat", "");
    if (!coat.empty()) ragdoll::coatKind(coat);
    ragdoll::StateToMarkers relay(nh, coat, nh.param<std::string>("frame_prefix", ""));
    ros::spin();
  } catch (const ragdoll::Error& e) {
    ROS_FATAL("parameter %s: %s", nh.resolveName("coat").c_str(), e.what());
    return 1;
  }
  return 0;
}
