// /use_sim_time: services answer although no clock ticks; with one, the simulation follows it.
// The tests run in the order in which they stand here: first there is no clock.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ragdoll_msgs/Metrics.h>
#include <ragdoll_msgs/Poke.h>
#include <ragdoll_msgs/State.h>
#include <ragdoll_msgs/Step.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <tf2_msgs/TFMessage.h>

#include <string>

#include "client.h"

namespace {

using ragdoll_msgs::State;
using ragdoll_test::Inbox;
using ragdoll_test::pause;
using ragdoll_test::reset;
using ragdoll_test::waitFor;

class SimTime : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(waitFor([] { return ros::service::exists("/ragdoll/step", false); }));
    ASSERT_TRUE(states_.connected());
  }
  static std::uint64_t step(std::uint32_t steps) {
    ragdoll_msgs::Step call;
    call.request.steps = steps;
    EXPECT_TRUE(ragdoll_test::call("/ragdoll/step", call) && call.response.success);
    return call.response.step;
  }
  /// Ticks for so many seconds of this clock. A running simulation is waited for, as it does not
  /// make up for more than a second; false if it does not follow.
  bool runClock(double from, double seconds, bool running = true) {
    if (!clock_) clock_ = ros::NodeHandle().advertise<rosgraph_msgs::Clock>("/clock", 10);
    if (!waitFor([] { return clock_.getNumSubscribers() > 0; })) return false;
    if (!waitFor([this] { return states_.last() != nullptr; })) return false;
    const double begin = states_.last()->time;
    rosgraph_msgs::Clock now;
    for (double t = 0; t <= seconds; t += 0.01) {
      if (running && !waitFor([&] { return states_.last()->time > begin + t - 0.2; })) return false;
      now.clock.fromSec(from + t);
      clock_.publish(now);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  Inbox<State> states_{"/ragdoll/state"};
  static ros::Publisher clock_;
};

ros::Publisher SimTime::clock_;

TEST_F(SimTime, servicesAnswerWithoutAClock) {
  ASSERT_TRUE(pause(true));
  ASSERT_TRUE(reset());
  ragdoll_msgs::Poke poke;
  poke.request.body_name = "head";
  poke.request.force.x = 1;
  poke.request.duration = ros::Duration(-1);
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", poke));
  EXPECT_TRUE(poke.response.success) << poke.response.status_message;
  poke.request.reference_frame = "ragdoll/head";
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", poke));
  EXPECT_TRUE(poke.response.success) << poke.response.status_message;
  poke.request.reference_frame = "nowhere";
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", poke));
  EXPECT_FALSE(poke.response.success);
  EXPECT_EQ(step(25), 25u);
  EXPECT_TRUE(waitFor([&] { return states_.last() && states_.last()->step == 25; }));
}

TEST_F(SimTime, standsStillWithoutAClock) {
  Inbox<tf2_msgs::TFMessage> tf("/tf");
  ASSERT_TRUE(reset());
  ASSERT_TRUE(pause(false));
  const std::size_t seen = states_.size();
  ASSERT_TRUE(waitFor([&] { return states_.size() > seen + 30; }));
  EXPECT_EQ(states_.last()->step, 0u);
  EXPECT_EQ(tf.size(), 0u);  // a stamp of zero would mean something else
}

TEST_F(SimTime, saysThatItWaits) {
  Inbox<ragdoll_msgs::Metrics> metrics("/ragdoll/metrics");
  Inbox<diagnostic_msgs::DiagnosticArray> reports("/diagnostics");
  EXPECT_TRUE(waitFor([&] { return metrics.last() && metrics.last()->waiting; }));
  EXPECT_TRUE(waitFor([&] {
    return reports.last() && reports.last()->status[0].level == 1 &&
           reports.last()->status[0].message.find("waiting for /clock") != std::string::npos;
  }));
}

TEST_F(SimTime, followsTheClock) {
  ASSERT_TRUE(pause(true));
  ASSERT_TRUE(reset());
  ASSERT_TRUE(runClock(100, 0.2, false));
  ASSERT_TRUE(waitFor([&] { return states_.last()->step == 0; }));
  ASSERT_TRUE(pause(false));
  Inbox<tf2_msgs::TFMessage> tf("/tf");
  ASSERT_TRUE(tf.connected());
  ASSERT_TRUE(runClock(100.2, 2));
  ASSERT_TRUE(waitFor([&] { return states_.last()->header.stamp.toSec() > 102.15; }));
  Inbox<ragdoll_msgs::Metrics> metrics("/ragdoll/metrics");
  EXPECT_TRUE(waitFor([&] { return metrics.last() && !metrics.last()->waiting; }));
  EXPECT_GT(states_.last()->time, 1.8);
  EXPECT_LT(states_.last()->time, 2.25);
  EXPECT_LT(states_.last()->header.stamp.toSec(), 102.25);
  ros::Time last;
  EXPECT_GT(tf.size(), 10u);
  for (const auto& message : tf.all()) {
    EXPECT_GT(message->transforms[0].header.stamp, last);
    last = message->transforms[0].header.stamp;
  }
}

TEST_F(SimTime, goesOnWhenTheClockIsSetBack) {
  ASSERT_TRUE(waitFor([&] { return states_.last() != nullptr; }));
  const double before = states_.last()->time;
  ASSERT_TRUE(runClock(10, 1));
  EXPECT_TRUE(waitFor([&] { return states_.last() && states_.last()->time > before + 0.8; }));
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sim_time_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
