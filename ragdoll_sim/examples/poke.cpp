#include <ragdoll_msgs/Poke.h>
#include <ragdoll_msgs/State.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "poke_example");
  ros::NodeHandle nh;
  ros::service::waitForService("/ragdoll/poke");

  ragdoll_msgs::Poke poke;
  poke.request.body_name = "head";
  poke.request.force.x = 100;  // N; reference_frame is empty: the world's axes
  poke.request.duration = ros::Duration(0.2);
  if (!ros::service::call("/ragdoll/poke", poke)) return 1;
  ROS_INFO("%s", poke.response.status_message.c_str());  // the step it begins at, or what was wrong

  const auto state = ros::topic::waitForMessage<ragdoll_msgs::State>("/ragdoll/state", nh);
  if (!state) return 1;
  for (const ragdoll_msgs::RagdollState& ragdoll : state->ragdolls)
    ROS_INFO("%s: first particle at z = %g m", ragdoll.name.c_str(), ragdoll.positions[0].z);
  return poke.response.success ? 0 : 1;
}
