// The node as a client in C++ uses it: pokes, forces, scenes, snapshots, frames, settings. What
// each does in detail is for the tests in python.
#include "client.h"

#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ragdoll_msgs/Attach.h>
#include <ragdoll_msgs/Detach.h>
#include <ragdoll_msgs/GetState.h>
#include <ragdoll_msgs/LoadScene.h>
#include <ragdoll_msgs/Metrics.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/Poke.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ragdoll_msgs/SetState.h>
#include <ragdoll_msgs/Step.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace {

using ragdoll_msgs::State;
using ragdoll_test::bits;
using ragdoll_test::Inbox;
using ragdoll_test::waitFor;

constexpr const char* kFloating =
    "gravity: [0, 0, 0]\nragdolls: [{name: anna, model: human, position: [0, 0, 2]}]\n";

class Client : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/set_state", 30000));
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/set_parameters", 30000));
    std_srvs::SetBool pause;
    pause.request.data = true;
    ASSERT_TRUE(ros::service::call("/ragdoll/pause", pause) && pause.response.success);
    load(kFloating);
    model_ = std::make_unique<Inbox<ragdoll_msgs::Model>>("/ragdoll/model");
    ASSERT_TRUE(
        waitFor([this] { return model_->last() && model_->last()->ragdolls[0].name == "anna"; }));
  }

  static ragdoll_msgs::LoadScene::Response load(const std::string& yaml) {
    ragdoll_msgs::LoadScene call;
    call.request.yaml = yaml;
    EXPECT_TRUE(ros::service::call("/ragdoll/load_scene", call));
    return call.response;
  }
  static State step(std::uint32_t steps) {
    ragdoll_msgs::Step call;
    call.request.steps = steps;
    EXPECT_TRUE(ros::service::call("/ragdoll/step", call) && call.response.success)
        << call.response.status_message;
    return get().state;
  }
  static ragdoll_msgs::GetState::Response get() {
    ragdoll_msgs::GetState call;
    EXPECT_TRUE(ros::service::call("/ragdoll/get_state", call));
    return call.response;
  }
  /// [m/s] the particles' mean velocity along x; needs no masses.
  static double meanVelocity(const State& state) {
    double sum = 0;
    for (const auto& v : state.ragdolls[0].velocities) sum += v.x;
    return sum / static_cast<double>(state.ragdolls[0].velocities.size());
  }
  geometry_msgs::Point positionOf(const std::string& particle) const {
    const auto& names = model_->last()->ragdolls[0].particles;
    const auto i = std::find(names.begin(), names.end(), particle) - names.begin();
    return get().state.ragdolls[0].positions[static_cast<std::size_t>(i)];
  }

  std::unique_ptr<Inbox<ragdoll_msgs::Model>> model_;
};

TEST_F(Client, pokesABodyAndHearsOfIt) {
  Inbox<ragdoll_msgs::PokeEvent> events("/ragdoll/pokes");
  ASSERT_TRUE(events.connected());
  ragdoll_msgs::Poke call;
  call.request.body_name = "torso";
  call.request.force.x = 100;
  call.request.duration = ros::Duration(0.5);
  ASSERT_TRUE(ros::service::call("/ragdoll/poke", call));
  ASSERT_TRUE(call.response.success) << call.response.status_message;
  ASSERT_TRUE(waitFor([&] { return events.size() > 0; }));
  EXPECT_EQ(events.last()->body_name, "anna/torso");
  EXPECT_GT(meanVelocity(step(20)), 0.01);

  std_srvs::Trigger clear;
  ASSERT_TRUE(ros::service::call("/ragdoll/clear_pokes", clear) && clear.response.success);
  call.request.body_name = "paw";
  ASSERT_TRUE(ros::service::call("/ragdoll/poke", call));
  EXPECT_FALSE(call.response.success);
  EXPECT_NE(call.response.status_message.find("left_hand"), std::string::npos);
}

TEST_F(Client, pushesByAStreamOfWrenches) {
  ros::Publisher publisher =
      ros::NodeHandle().advertise<geometry_msgs::WrenchStamped>("/ragdoll/wrench", 10);
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  geometry_msgs::WrenchStamped wrench;
  wrench.header.frame_id = "anna/pelvis";
  wrench.wrench.force.x = 50;
  EXPECT_TRUE(waitFor([&] {
    publisher.publish(wrench);
    return meanVelocity(step(1)) > 0.05;
  }));
}

TEST_F(Client, goesOnFromASnapshotToTheSameBits) {
  step(30);
  const auto kept = get();
  const std::string then = bits(step(50));
  step(20);
  ragdoll_msgs::SetState call;
  call.request.snapshot = kept.snapshot;
  ASSERT_TRUE(ros::service::call("/ragdoll/set_state", call));
  ASSERT_TRUE(call.response.success) << call.response.status_message;
  EXPECT_EQ(bits(get().state), bits(kept.state));
  EXPECT_EQ(bits(step(50)), then);

  call.request.snapshot[100] ^= 1;
  ASSERT_TRUE(ros::service::call("/ragdoll/set_state", call));
  EXPECT_FALSE(call.response.success);
}

TEST_F(Client, loadsAScene) {
  const auto wrong = load("ragdolls: [{model: human, mass: 3}]");
  EXPECT_FALSE(wrong.success);
  EXPECT_NE(wrong.status_message.find("mass"), std::string::npos) << wrong.status_message;
  EXPECT_EQ(get().state.ragdolls[0].name, "anna");
  ASSERT_TRUE(load("ragdolls: [{name: ben, model: human}, {name: cleo, model: human}]").success);
  EXPECT_EQ(get().state.ragdolls.at(1).name, "cleo");
}

TEST_F(Client, holdsAHandAtAFrameOfItsOwn) {
  const geometry_msgs::Point hand = positionOf("right_hand");
  geometry_msgs::TransformStamped gripper;
  gripper.header.frame_id = "world";
  gripper.child_frame_id = "gripper";
  gripper.transform.translation.x = hand.x + 0.2;
  gripper.transform.translation.y = hand.y;
  gripper.transform.translation.z = hand.z;
  gripper.transform.rotation.w = 1;
  tf2_ros::TransformBroadcaster tf;
  const auto tell = [&] {
    gripper.header.stamp = ros::Time::now();
    tf.sendTransform(gripper);
  };
  ragdoll_msgs::Attach attach;
  attach.request.body_name = "right_hand";
  attach.request.frame = "gripper";
  ASSERT_TRUE(waitFor([&] {
    tell();
    return ros::service::call("/ragdoll/attach", attach) && attach.response.success;
  })) << attach.response.status_message;
  EXPECT_TRUE(waitFor([&] {
    tell();
    step(10);
    return std::abs(positionOf("right_hand").x - hand.x - 0.2) < 1e-3;
  }));
  ragdoll_msgs::Detach detach;
  detach.request.body_name = "right_hand";
  ASSERT_TRUE(ros::service::call("/ragdoll/detach", detach));
  EXPECT_TRUE(detach.response.success) << detach.response.status_message;
}

TEST_F(Client, changesGravityAndHearsMeasures) {
  Inbox<ragdoll_msgs::Metrics> metrics("/ragdoll/metrics");
  Inbox<sensor_msgs::JointState> joints("/ragdoll/joint_states");
  dynamic_reconfigure::Reconfigure call;
  call.request.config.doubles.resize(1);
  call.request.config.doubles[0].name = "gravity_x";
  call.request.config.doubles[0].value = 3;
  ASSERT_TRUE(ros::service::call("/ragdoll/set_parameters", call));
  const State state = step(60);
  EXPECT_NEAR(meanVelocity(state), 3 * state.time, 1e-6);
  EXPECT_TRUE(waitFor([&] { return metrics.last() && metrics.last()->kinetic_energy > 1; }));
  EXPECT_TRUE(waitFor([&] { return joints.last() && !joints.last()->name.empty(); }));
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "client_test");
  testing::InitGoogleTest(&argc, argv);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  const ros::NodeHandle keep;  // the node ends with its last handle
  return RUN_ALL_TESTS();
}
