// A coat is computed for those who listen, and for nobody else; arrows of contacts are their
// forces.
#include "../../src/ros/markers.h"

#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>
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

Snapshot standing(const char* coat = "skin") {
  Snapshot world;
  world.scene = std::make_shared<Scene>(parseScene(
      std::string("ragdolls: [{model: human}]\nobstacles: [{type: plane}]\ncoat: ") + coat + "\n"));
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

/// A publisher whose clock the test moves, and how often each marker of a standing body has come.
class Told {
 public:
  Told() : markers_(nh_, "world", ""), world_(standing("capsules")) {
    const auto hear = [this](const MarkerArray::ConstPtr& message) {
      for (const Marker& m : message->markers) {
        if (m.action == Marker::ADD) ++count_[m.ns + std::to_string(m.id)];
        if (m.action == Marker::DELETEALL) ++ends_;
      }
      bytes_ += ros::serialization::serializationLength(*message);
    };
    listener_ = nh_.subscribe<MarkerArray>("markers", 0, hear);
  }
  /// Once all has come, and what a new listener is told beside it.
  bool starts() {
    const bool come = waitFor([&] {
      advance(1);
      return count_.count("obstacles0") > 0;
    });
    for (int i = 0; i < 2; ++i) advance(50), settle();
    count_.clear();
    bytes_ = 0;
    return come;
  }
  void advance(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      now_ += std::chrono::milliseconds(34);
      markers_.publish(world_, world_.tracker->now(), now_);
      ros::getGlobalCallbackQueue()->callAvailable();
    }
  }
  /// Until what is under way has arrived.
  void settle() {
    const int seen = ends_;
    markers_.clear();
    EXPECT_TRUE(waitFor([&] { return ends_ > seen; }));
  }
  /// Of floor and coat the least and the most.
  std::pair<int, int> counts() {
    settle();
    int least = 1000000, most = 0;
    for (const auto& [name, n] : count_) {
      if (name == "sticks0") continue;
      least = std::min(least, n), most = std::max(most, n);
    }
    return {least, most};
  }
  double bytes() const { return bytes_; }
  std::size_t kinds() const { return count_.size(); }

 private:
  ros::NodeHandle nh_{"~"};
  MarkerPublisher markers_;
  Snapshot world_;
  Simulation::Clock::time_point now_ = Simulation::Clock::now();
  ros::Subscriber listener_;
  std::map<std::string, int> count_;
  double bytes_ = 0;
  int ends_ = 0;
};

TEST(Markers, WhatIsToldOnceIsToldAgainAfterAMinute) {
  Told told;
  ASSERT_TRUE(told.starts());
  told.advance(1600);  // 54 s
  told.settle();
  EXPECT_EQ(told.kinds(), 1u);  // the sticks
  told.advance(2000);           // 68 s
  const auto [least, most] = told.counts();
  EXPECT_GT(told.kinds(), 40u);
  EXPECT_EQ(least, 1);
  EXPECT_LE(most, 2);
  EXPECT_LT(told.bytes(), 20e3 * 122);
}

TEST(Markers, AreAllToldWhenTheClockGoesBack) {
  Told told;
  ros::Time::setNow(ros::Time(20));
  ASSERT_TRUE(told.starts());
  ros::Time::setNow(ros::Time(30));
  told.advance(3);
  told.settle();
  EXPECT_LE(told.kinds(), 1u);
  ros::Time::setNow(ros::Time(10));
  told.advance(1);
  EXPECT_EQ(told.counts(), std::make_pair(1, 1));
  EXPECT_GT(told.kinds(), 40u);
  told.advance(60);  // once more, for who has noticed late
  EXPECT_EQ(told.counts(), std::make_pair(2, 2));
  ros::Time::init();
}

/// What has come of a crowd of `count` bodies 2 m apart once each has been told of.
class Crowd {
 public:
  static constexpr int kMore = 10;  ///< pictures after that
  Crowd(int count, bool frames) : count_(count), markers_(nh_, "world", "capsules") {
    const std::string model = "model: human, count: " + std::to_string(count);
    Snapshot world = standing();
    world.scene = std::make_shared<Scene>(parseScene(
        "ragdolls: [{name: r, " + model + ", spacing: [2, 0, 0]}]\nobstacles: [{type: plane}]\n"));
    world.model = std::make_shared<Model>(buildModel(*world.scene));
    world.state = startState(*world.model);
    world.tracker.emplace(*world.model);
    world.tracker->reset(world.state);
    markers_.useFrames(frames);
    const auto listen = [&](const char* topic, int& floors) {
      return nh_.subscribe<MarkerArray>(
          topic, 0, [this, &floors](const MarkerArray::ConstPtr& m) { hear(*m, floors); });
    };
    listener_ = listen("markers", floors_);
    scenery_listener_ = listen("scenery", scenery_floors_);
    auto now = Simulation::Clock::now();
    const auto draw = [&] {
      markers_.publish(world, world.tracker->now(), now += std::chrono::milliseconds(34));
    };
    all_ = waitFor([&] {
      draw();
      return static_cast<int>(bodies_.size()) == count_ && scenery_floors_ > 0;
    });
    floors_ = scenery_floors_ = 0;
    for (int i = 0; i < kMore; ++i) draw();
    all_ = all_ && waitFor([&] { return frames || floors_ >= kMore; });
    for (int i = 0; i < count; ++i)
      pelvises_.push_back(world.tracker->now().frames[world.tracker->firstFrame(i)]);
  }
  bool all() const { return all_; }
  /// [bytes] of a message, at most.
  std::size_t largest() const { return largest_; }
  const std::vector<Marker>& body(int i) { return bodies_[i]; }
  const Pose& pelvis(int i) const { return pelvises_[i]; }
  /// How often ~scenery had the floor in kMore pictures.
  int sceneryFloors() const { return scenery_floors_; }

 private:
  void hear(const MarkerArray& message, int& floors) {
    largest_ = std::max<std::size_t>(largest_, ros::serialization::serializationLength(message));
    for (const Marker& m : message.markers) {
      floors += m.ns == "obstacles";
      if (m.ns == "coat") bodies_[(m.id - 1) / BodyMarkers::kIds].push_back(m);
    }
  }
  ros::NodeHandle nh_{"~"};
  int count_;
  MarkerPublisher markers_;
  ros::Subscriber listener_, scenery_listener_;
  int floors_ = 0, scenery_floors_ = 0;
  std::map<int, std::vector<Marker>> bodies_;
  std::vector<Pose> pelvises_;
  std::size_t largest_ = 0;
  bool all_ = false;
};

/// roscpp keeps a number of messages for who reads slowly, of whatever size.
TEST(Markers, OfManyBodiesAreInManyMessages) {
  for (const bool frames : {false, true}) {
    Crowd crowd(50, frames);
    ASSERT_TRUE(crowd.all());
    EXPECT_LT(crowd.largest(), 1000100u);
    EXPECT_LT(crowd.sceneryFloors(), 3);
    for (const Marker& m : crowd.body(49)) {
      EXPECT_EQ(m.lifetime.toSec(), frames ? 0 : 1.25);  // three pictures tell of all
      if (frames) continue;
      for (const geometry_msgs::Point& p : m.points)
        ASSERT_LT(std::abs(p.x - crowd.pelvis(49).position.x()), 1);
    }
  }
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
