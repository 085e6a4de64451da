// A coat is computed for those who listen, and for nobody else; arrows of contacts are their forces.
#include "../../src/ros/markers.h"

#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <functional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace {

using namespace ragdoll;
using visualization_msgs::Marker;
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

/// A particle that an obstacle gives so many newtons over 0.01 s.
Touch touch(int particle, const Vec3& force) {
  Touch t;
  t.contact.particle = {particle, -1};
  t.contact.obstacle = 0;
  t.contact.point = Vec3(particle, 2, 0);
  t.contact.impulse = 0.01 * force;
  return t;
}

ContactReport report(const std::vector<Touch>& touches, double interval = 0.01) {
  ContactReport r;
  r.interval = interval;
  r.touches = touches;
  return r;
}

/// Of one namespace.
std::vector<Marker> drawn(ContactMarkers& markers, const std::string& ns) {
  Marker empty;
  empty.header.frame_id = "earth";
  std::vector<Marker> all, some;
  markers.append(empty, all);
  for (const Marker& m : all) {
    EXPECT_EQ(m.header.frame_id, "earth");
    if (m.ns == ns) some.push_back(m);
  }
  return some;
}

Vec3 arrow(const Marker& m) {
  return {m.points[1].x - m.points[0].x, m.points[1].y - m.points[0].y,
          m.points[1].z - m.points[0].z};
}

TEST(ContactMarkers, ArrowsAreMeanForcesFromThePointsThatTouch) {
  ContactMarkers markers;
  EXPECT_TRUE(drawn(markers, "forces").empty());
  // Two reports between two pictures: 100 N and 300 N are 200 N, 80 N and nothing 40 N.
  markers.hear(report({touch(0, {0, 0, 100}), touch(3, {80, 0, 0})}));
  markers.hear(report({touch(0, {0, 0, 300})}));
  ContactMarkers points = markers;
  const auto contacts = drawn(points, "contacts");
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].type, Marker::SPHERE_LIST);
  ASSERT_EQ(contacts[0].points.size(), 2u);
  EXPECT_EQ(contacts[0].points[1].x, 3);
  EXPECT_EQ(contacts[0].points[1].y, 2);
  auto forces = drawn(markers, "forces");
  ASSERT_EQ(forces.size(), 2u);
  EXPECT_EQ(forces[0].type, Marker::ARROW);
  EXPECT_NE(forces[0].id, forces[1].id);
  EXPECT_EQ(forces[0].points[0].x, 0);
  EXPECT_LT((arrow(forces[0]) - Vec3(0, 0, 0.4)).norm(), 1e-12);
  EXPECT_LT((arrow(forces[1]) - Vec3(0.08, 0, 0)).norm(), 1e-12);

  // While the world stands still the picture stays; the next step begins another.
  markers.hear(report({}, 0));
  EXPECT_EQ(drawn(markers, "forces").size(), 2u);
  markers.hear(report({touch(1, {0, -50, 0})}));
  forces = drawn(markers, "forces");
  ASSERT_EQ(forces.size(), 1u);
  EXPECT_LT((arrow(forces[0]) - Vec3(0, -0.1, 0)).norm(), 1e-12);
  markers.hear(report({}));
  EXPECT_TRUE(drawn(markers, "contacts").empty());
}

TEST(ContactMarkers, ALargeForceFitsAndASmallOneIsAPointAlone) {
  ContactMarkers markers;
  markers.hear(report({touch(0, {0, 0, 1e6}), touch(1, {0, 0, 1e-3}), touch(2, {0, 0, 0})}));
  ContactMarkers points = markers;
  EXPECT_EQ(drawn(points, "contacts")[0].points.size(), 3u);
  const auto forces = drawn(markers, "forces");
  ASSERT_EQ(forces.size(), 1u);
  EXPECT_LT((arrow(forces[0]) - Vec3(0, 0, ContactMarkers::kLongestArrow)).norm(), 1e-12);
}

TEST(ContactMarkers, AreAtMostTwoHundredArrowsOfTheLargestForces) {
  ContactMarkers markers;
  std::vector<Touch> touches;
  for (int i = 0; i < 300; ++i) touches.push_back(touch(i, {0, 0, 10.0 + i}));
  markers.hear(report(touches));
  const auto forces = drawn(markers, "forces");
  ASSERT_EQ(forces.size(), ContactMarkers::kMostArrows);
  for (const Marker& m : forces) EXPECT_GE(m.points[0].x, 100);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "markers_test");
  return RUN_ALL_TESTS();
}
