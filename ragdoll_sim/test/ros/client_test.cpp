// The node as a client in C++ uses it: pokes, forces, scenes, snapshots, frames, settings. What
// each does in detail is for the tests in python.
#include "client.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ragdoll_msgs/Attach.h>
#include <ragdoll_msgs/Detach.h>
#include <ragdoll_msgs/FollowedFrame.h>
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
#include <tf2_ros/transform_broadcaster.h>
#include <visualization_msgs/InteractiveMarkerFeedback.h>
#include <visualization_msgs/InteractiveMarkerInit.h>
#include <visualization_msgs/InteractiveMarkerUpdate.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace {

using ragdoll_msgs::State;
using ragdoll_test::bits;
using ragdoll_test::Inbox;
using ragdoll_test::pause;
using ragdoll_test::reset;
using ragdoll_test::waitFor;

constexpr const char* kFloating =
    "gravity: [0, 0, 0]\nragdolls: [{name: anna, model: human, position: [0, 0, 2]}]\n";

class Client : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/set_state", 30000));
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/set_parameters", 30000));
    ASSERT_TRUE(pause(true));
    load(kFloating);
    model_ = std::make_unique<Inbox<ragdoll_msgs::Model>>("/ragdoll/model");
    ASSERT_TRUE(
        waitFor([this] { return model_->last() && model_->last()->ragdolls[0].name == "anna"; }));
  }

  static ragdoll_msgs::LoadScene::Response load(const std::string& yaml) {
    ragdoll_msgs::LoadScene call;
    call.request.yaml = yaml;
    EXPECT_TRUE(ragdoll_test::call("/ragdoll/load_scene", call));
    return call.response;
  }
  static State step(std::uint32_t steps) {
    ragdoll_msgs::Step call;
    call.request.steps = steps;
    EXPECT_TRUE(ragdoll_test::call("/ragdoll/step", call) && call.response.success)
        << call.response.status_message;
    return get().state;
  }
  static ragdoll_msgs::GetState::Response get() {
    ragdoll_msgs::GetState call;
    EXPECT_TRUE(ragdoll_test::call("/ragdoll/get_state", call));
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

  /// The last poke of a body; null if there is none. ~pokes may still tell what was before.
  static ragdoll_msgs::PokeEvent::ConstPtr told(const Inbox<ragdoll_msgs::PokeEvent>& events,
                                                const std::string& body) {
    ragdoll_msgs::PokeEvent::ConstPtr found;
    for (const auto& event : events.all())
      if (event->body_name == body) found = event;
    return found;
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
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", call));
  ASSERT_TRUE(call.response.success) << call.response.status_message;
  EXPECT_TRUE(waitFor([&] { return told(events, "anna/torso") != nullptr; }));
  EXPECT_GT(meanVelocity(step(20)), 0.01);

  std_srvs::Trigger clear;
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/clear_pokes", clear) && clear.response.success);
  call.request.body_name = "paw";
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", call));
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
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/set_state", call));
  ASSERT_TRUE(call.response.success) << call.response.status_message;
  EXPECT_EQ(bits(get().state), bits(kept.state));
  EXPECT_EQ(bits(step(50)), then);

  call.request.snapshot[100] ^= 1;
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/set_state", call));
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
    return ragdoll_test::call("/ragdoll/attach", attach) && attach.response.success;
  })) << attach.response.status_message;
  EXPECT_TRUE(waitFor([&] {
    tell();
    step(10);
    return std::abs(positionOf("right_hand").x - hand.x - 0.2) < 1e-3;
  }));
  ragdoll_msgs::Detach detach;
  detach.request.body_name = "right_hand";
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/detach", detach));
  EXPECT_TRUE(detach.response.success) << detach.response.status_message;
}

TEST_F(Client, replaysAPokeToTheSameBits) {
  Inbox<ragdoll_msgs::PokeEvent> events("/ragdoll/pokes");
  ASSERT_TRUE(events.connected());
  ros::Publisher replay =
      ros::NodeHandle().advertise<ragdoll_msgs::PokeEvent>("/ragdoll/poke_replay", 10);
  ASSERT_TRUE(waitFor([&] { return replay.getNumSubscribers() > 0; }));
  step(10);
  ragdoll_msgs::Poke call;
  call.request.body_name = "left_forearm";
  call.request.force.z = 80;
  call.request.duration = ros::Duration(0.2);
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", call) && call.response.success);
  ASSERT_TRUE(waitFor([&] { return told(events, "anna/left_forearm") != nullptr; }));
  const ragdoll_msgs::PokeEvent event = *told(events, "anna/left_forearm");
  EXPECT_EQ(event.step, 10u);
  const std::string then = bits(step(60));
  ASSERT_TRUE(reset());
  replay.publish(event);
  ASSERT_TRUE(waitFor([&] {
    const auto last = told(events, "anna/left_forearm");
    return last->run > event.run;
  }));
  EXPECT_EQ(bits(step(70)), then);
}

TEST_F(Client, dragsAHandle) {
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;
  Inbox<visualization_msgs::InteractiveMarkerUpdate> updates("/ragdoll/handles/update");
  Inbox<visualization_msgs::InteractiveMarkerInit> init("/ragdoll/handles/update_full");
  const auto handle = [&](const std::string& name) {
    if (!init.last()) return false;
    const auto& markers = init.last()->markers;
    return std::any_of(markers.begin(), markers.end(),
                       [&](const auto& m) { return m.name == name; });
  };
  ASSERT_TRUE(waitFor([&] { return handle("anna/right_hand"); }));
  ros::Publisher mouse = ros::NodeHandle().advertise<Feedback>("/ragdoll/handles/feedback", 10);
  ASSERT_TRUE(waitFor([&] { return mouse.getNumSubscribers() > 0; }));
  Feedback drag;
  drag.client_id = "client";
  drag.marker_name = "anna/right_hand";
  drag.event_type = Feedback::POSE_UPDATE;
  drag.header.frame_id = "world";
  drag.pose.position = positionOf("right_hand");
  drag.pose.position.x += 0.2;
  // Said again and again: what is not heard of for a second is let go.
  EXPECT_TRUE(waitFor([&] {
    mouse.publish(drag);
    step(10);
    return std::abs(positionOf("right_hand").x - drag.pose.position.x) < 0.01;
  }));
  drag.event_type = Feedback::MOUSE_UP;
  mouse.publish(drag);
}

TEST_F(Client, hearsHowFramesMoveWhatFollowsThem) {
  const auto loaded = load(
      "ragdolls: [{name: anna, model: human}]\n"
      "obstacles: [{type: box, frame: paddle, position: [0, 0, 0], size: [1, 1, 1]}]\n");
  ASSERT_TRUE(loaded.success) << loaded.status_message;
  Inbox<ragdoll_msgs::FollowedFrame> followed("/ragdoll/followed");
  ASSERT_TRUE(followed.connected());
  geometry_msgs::TransformStamped paddle;
  paddle.header.frame_id = "world";
  paddle.child_frame_id = "paddle";
  paddle.transform.rotation.w = 1;
  paddle.transform.translation.x = 7;
  tf2_ros::TransformBroadcaster tf;
  ASSERT_TRUE(waitFor([&] {
    paddle.header.stamp = ros::Time::now();
    tf.sendTransform(paddle);
    step(1);
    return followed.size() > 0;
  }));
  const ragdoll_msgs::FollowedFrame first = *followed.all()[0];
  EXPECT_EQ(first.frame, "paddle");
  EXPECT_EQ(first.number, 1u);
  EXPECT_EQ(first.goal.position.x, 7);
  EXPECT_TRUE(first.jump);
  EXPECT_LT(first.step, get().state.step);
  EXPECT_EQ(get().state.followed, 1u);  // the same pose again is no news
}

TEST_F(Client, measuresAreThoseOfFreeFall) {
  ASSERT_TRUE(load("ragdolls: [{name: anna, model: human_lumped, position: [0, 0, 5]}]\n").success);
  ASSERT_TRUE(waitFor([this] {
    return model_->last()->scene_yaml.find("gravity: [0, 0, -9") != std::string::npos;
  }));
  double mass = 0;
  for (const double m : model_->last()->ragdolls[0].masses) mass += m;
  Inbox<ragdoll_msgs::Metrics> metrics("/ragdoll/metrics");
  ASSERT_TRUE(waitFor([&] { return metrics.last() && metrics.last()->kinetic_energy == 0; }));
  const double before = metrics.last()->potential_energy;
  const double speed = 9.81 * step(60).time;
  const double energy = mass * speed * speed / 2;
  // Some may be of a moment within the steps.
  ASSERT_TRUE(
      waitFor([&] { return std::abs(metrics.last()->kinetic_energy - energy) < 1e-3 * energy; }));
  EXPECT_NEAR(before - metrics.last()->potential_energy, energy, 0.02 * energy);
  EXPECT_TRUE(metrics.last()->paused);
  EXPECT_EQ(metrics.last()->ragdolls, 1u);
}

/// Weightless bodies, each pushed at a hand for 0.2 s.
TEST_F(Client, massesTellTheMassItsCentreAndMomentum) {
  ASSERT_TRUE(load("gravity: [0, 0, 0]\nragdolls:\n"
                   "  - {name: anna, model: human_lumped, position: [0, 0, 2]}\n"
                   "  - {name: ben, model: human, position: [3, 0, 2]}\n")
                  .success);
  ASSERT_TRUE(waitFor([this] { return model_->last()->ragdolls.size() == 2; }));
  const State before = get().state;
  for (const char* hand : {"anna/right_hand", "ben/right_hand"}) {
    ragdoll_msgs::Poke call;
    call.request.body_name = hand;
    call.request.force.x = 30;
    call.request.duration = ros::Duration(0.2);
    ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", call));
    ASSERT_TRUE(call.response.success) << call.response.status_message;
  }
  const State after = step(120);
  // Of `human` within what the pelvis's centre of mass is off its plane: 1 mm of the whole.
  const double within[] = {1e-9, 2e-3};  // [m], [m/s]
  for (std::size_t k = 0; k < 2; ++k) {
    const ragdoll_msgs::RagdollModel& model = model_->last()->ragdolls[k];
    double mass = 0, momentum = 0, moved = 0;
    for (std::size_t i = 0; i < model.masses.size(); ++i) {
      mass += model.masses[i];
      momentum += model.masses[i] * after.ragdolls[k].velocities[i].x;
      moved +=
          model.masses[i] * (after.ragdolls[k].positions[i].x - before.ragdolls[k].positions[i].x);
    }
    const double speed = 30 * 0.2 / mass;
    EXPECT_NEAR(mass, model.mass, 1e-9 * mass) << model.name;
    EXPECT_NEAR(momentum / mass, speed, within[k]) << model.name;
    EXPECT_NEAR(moved / mass, speed * (after.time - before.time - 0.1), within[k]) << model.name;
  }
}

TEST_F(Client, hearsWhatIsForWatching) {
  Inbox<visualization_msgs::MarkerArray> markers("/ragdoll/markers");
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics("/diagnostics");
  Inbox<dynamic_reconfigure::Config> settings("/ragdoll/parameter_updates");
  Inbox<dynamic_reconfigure::ConfigDescription> knobs("/ragdoll/parameter_descriptions");
  const geometry_msgs::Point head = positionOf("head");
  EXPECT_TRUE(waitFor([&] {
    for (const auto& message : markers.all())
      for (const auto& marker : message->markers)
        for (const auto& p : marker.points)
          if (marker.ns == "sticks" && p.x == head.x && p.y == head.y && p.z == head.z) return true;
    return false;
  }));
  EXPECT_TRUE(waitFor(
      [&] { return diagnostics.last() && diagnostics.last()->status[0].message == "paused"; }));
  ASSERT_TRUE(waitFor([&] { return settings.last() && knobs.last(); }));
  std::size_t names = 0;
  for (const auto& group : knobs.last()->groups) names += group.parameters.size();
  const auto& c = *settings.last();
  EXPECT_EQ(c.bools.size() + c.ints.size() + c.strs.size() + c.doubles.size(), names);
}

TEST_F(Client, changesGravityAndHearsMeasures) {
  Inbox<ragdoll_msgs::Metrics> metrics("/ragdoll/metrics");
  Inbox<sensor_msgs::JointState> joints("/ragdoll/joint_states");
  dynamic_reconfigure::Reconfigure call;
  call.request.config.doubles.resize(1);
  call.request.config.doubles[0].name = "gravity_x";
  call.request.config.doubles[0].value = 3;
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/set_parameters", call));
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
