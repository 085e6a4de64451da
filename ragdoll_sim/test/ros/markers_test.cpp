// A coat is computed for those who listen, and for nobody else.
#include "../../src/ros/markers.h"

#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <functional>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace {

using namespace ragdoll;
using visualization_msgs::MarkerArray;

constexpr double kLimit = 30;  ///< [s]

bool waitFor(const std::function<bool()>& condition) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kLimit);
  while (!condition()) {
    if (ros::WallTime::now() > end) return false;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return true;
}

Snapshot standing() {
  Snapshot world;
  world.scene = std::make_shared<Scene>(parseScene("ragdolls: [{model: human}]\ncoat: skin\n"));
  world.model = std::make_shared<Model>(buildModel(*world.scene));
  world.state = startState(*world.model);
  world.tracker.emplace(*world.model);
  world.tracker->reset(world.state);
  return world;
}

TEST(Markers, AreComputedOnlyWhileSomeoneListens) {
  ros::NodeHandle nh("~");
  MarkerPublisher markers(nh, "world", "");
  const Snapshot world = standing();
  const auto publish = [&] { markers.publish(world, world.tracker->now()); };
  for (int i = 0; i < 100; ++i) publish();
  EXPECT_EQ(markers.drawn(), 0u);

  std::size_t received = 0;
  ros::Subscriber listener =
      nh.subscribe<MarkerArray>("markers", 10, [&](const MarkerArray::ConstPtr& message) {
        received += message->markers.size() > 1;  // not that which clears
      });
  ASSERT_TRUE(waitFor([&] { return markers.wanted(); }));
  ASSERT_TRUE(waitFor([&] {
    publish();
    return received > 0;
  }));
  EXPECT_GT(markers.drawn(), 0u);

  listener.shutdown();
  ASSERT_TRUE(waitFor([&] { return !markers.wanted(); }));
  const std::size_t before = markers.drawn();
  ros::WallDuration(0.1).sleep();  // longer than the shortest time between two messages
  for (int i = 0; i < 100; ++i) publish();
  EXPECT_EQ(markers.drawn(), before);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "markers_test");
  return RUN_ALL_TESTS();
}
