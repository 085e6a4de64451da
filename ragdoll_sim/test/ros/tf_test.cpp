// /tf: the whole tree in every message, no stamp twice, frames where ~state says the particles are.
#include <gtest/gtest.h>
#include <ragdoll_msgs/GetState.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/State.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "client.h"

namespace {

using ragdoll_test::Inbox;
using ragdoll_test::pause;
using ragdoll_test::reset;
using ragdoll_test::waitFor;

const std::map<std::string, std::string> kParents{{"pelvis", "world"},
                                                  {"left_hip", "pelvis"},
                                                  {"right_hip", "pelvis"},
                                                  {"left_leg", "pelvis"},
                                                  {"right_leg", "pelvis"},
                                                  {"neck", "pelvis"},
                                                  {"left_knee", "left_leg"},
                                                  {"right_knee", "right_leg"},
                                                  {"left_foot", "left_knee"},
                                                  {"right_foot", "right_knee"},
                                                  {"head", "neck"},
                                                  {"left_shoulder", "neck"},
                                                  {"right_shoulder", "neck"},
                                                  {"left_elbow", "left_shoulder"},
                                                  {"right_elbow", "right_shoulder"},
                                                  {"left_hand", "left_elbow"},
                                                  {"right_hand", "right_elbow"}};

std::map<std::string, std::string> expectedTree() {
  std::map<std::string, std::string> tree;
  for (const std::string ragdoll : {"anna/", "ben/"})
    for (const auto& [child, parent] : kParents)
      tree[ragdoll + child] = parent == "world" ? parent : ragdoll + parent;
  return tree;
}

class Tf : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/reset", 30000));
    ASSERT_TRUE(reset());
    ASSERT_TRUE(pause(false));
  }
};

TEST_F(Tf, everyMessageHasTheWholeTree) {
  Inbox<tf2_msgs::TFMessage> tf("/tf");
  ASSERT_TRUE(waitFor([&] { return tf.size() >= 100; }));
  for (const auto& message : tf.all()) {
    std::map<std::string, std::string> tree;
    std::set<ros::Time> stamps;
    for (const auto& t : message->transforms) {
      tree[t.child_frame_id] = t.header.frame_id;
      stamps.insert(t.header.stamp);
      const auto& q = t.transform.rotation;
      EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-9);
    }
    EXPECT_EQ(tree, expectedTree());
    EXPECT_EQ(message->transforms.size(), 2u * 17u);
    EXPECT_EQ(stamps.size(), 1u);
  }
}

TEST_F(Tf, noStampTwiceRunningPausedOrReset) {
  Inbox<tf2_msgs::TFMessage> tf("/tf");
  ASSERT_TRUE(waitFor([&] { return tf.size() >= 200; }));
  ASSERT_TRUE(pause(true));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(reset());
  const std::size_t before = tf.size();
  ASSERT_TRUE(waitFor([&] { return tf.size() >= before + 200; }));  // goes on while paused
  ros::Time last;
  for (const auto& message : tf.all()) {
    ASSERT_FALSE(message->transforms.empty());
    EXPECT_GT(message->transforms[0].header.stamp, last);
    last = message->transforms[0].header.stamp;
  }
}

TEST_F(Tf, orientationsNeitherJumpNorFlip) {
  Inbox<tf2_msgs::TFMessage> tf("/tf");
  ASSERT_TRUE(waitFor([&] { return tf.size() >= 400; }));
  std::map<std::string, geometry_msgs::TransformStamped> last;
  int compared = 0;
  for (const auto& message : tf.all()) {
    for (const auto& t : message->transforms) {
      const auto found = last.find(t.child_frame_id);
      if (found != last.end() && (t.header.stamp - found->second.header.stamp).toSec() < 0.01) {
        const auto &a = found->second.transform.rotation, &b = t.transform.rotation;
        // The cosine of half the turn: negative after a flip of sign, small after a jump.
        EXPECT_GT(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w, std::cos(0.35))
            << t.child_frame_id;
        ++compared;
      }
      last[t.child_frame_id] = t;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST_F(Tf, framesAreWhereTheParticlesAre) {
  Inbox<ragdoll_msgs::Model> models("/ragdoll/model");
  Inbox<ragdoll_msgs::State> states("/ragdoll/state");
  ASSERT_TRUE(waitFor([&] { return states.size() >= 50 && models.size() > 0; }));
  ASSERT_TRUE(pause(true));
  ragdoll_msgs::GetState get;
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/get_state", get));
  // Paused, the state stays; a frame that is stamped later shows it.
  const ros::Time paused = ros::Time::now() + ros::Duration(0.1);
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  const auto model = models.last();
  for (std::size_t r = 0; r < model->ragdolls.size(); ++r) {
    for (std::size_t p = 0; p < model->ragdolls[r].particles.size(); ++p) {
      const std::string frame = model->ragdolls[r].name + "/" + model->ragdolls[r].particles[p];
      geometry_msgs::TransformStamped t;
      ASSERT_TRUE(waitFor([&] {
        if (!buffer.canTransform("world", frame, ros::Time(0))) return false;
        t = buffer.lookupTransform("world", frame, ros::Time(0));
        return t.header.stamp > paused;
      })) << frame;
      const auto& at = get.response.state.ragdolls[r].positions[p];
      EXPECT_NEAR(t.transform.translation.x, at.x, 1e-9) << frame;
      EXPECT_NEAR(t.transform.translation.y, at.y, 1e-9) << frame;
      EXPECT_NEAR(t.transform.translation.z, at.z, 1e-9) << frame;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "tf_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
