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

#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "client.h"

namespace {

using ragdoll_msgs::State;
using ragdoll_test::bits;
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

/// Forward, back, none at all, and to the last but one second of ros::Time (in the last one
/// roscpp's timers overflow): each is taken as it is, the steps are the same as by any other clock,
/// and the next clock is followed.
TEST_F(SimTime, TakesAnyClock) {
  Inbox<diagnostic_msgs::DiagnosticArray> reports("/diagnostics");
  ASSERT_TRUE(pause(true));
  ASSERT_TRUE(reset());
  ASSERT_TRUE(runClock(20, 0.1, false));
  ASSERT_TRUE(pause(false));
  std::mt19937 random(5);
  const std::uint32_t most = std::numeric_limits<std::uint32_t>::max() - 1;
  const std::uint32_t seconds[] = {0, 1, 2, 30, 31, 1u << 31, most};
  const std::uint32_t nanoseconds[] = {0, 1, 500000000, 999999999};
  rosgraph_msgs::Clock now;
  const auto told = [&] { return states_.last() && states_.last()->header.stamp == now.clock; };
  for (int i = 0; i < 60; ++i) {
    now.clock.sec = seconds[random() % std::size(seconds)];
    now.clock.nsec = nanoseconds[random() % std::size(nanoseconds)];
    clock_.publish(now);
    ASSERT_TRUE(waitFor(told)) << now.clock.sec << " s " << now.clock.nsec << " ns";
  }
  ASSERT_TRUE(pause(true));
  const std::uint64_t reached = step(0);
  ASSERT_GT(reached, 0u);
  ASSERT_TRUE(waitFor([&] { return states_.last()->step == reached; }));
  const std::string after = bits(*states_.last());
  ASSERT_TRUE(reset());
  ASSERT_TRUE(waitFor([&] { return states_.last()->step == 0; }));
  ASSERT_EQ(step(static_cast<std::uint32_t>(reached)), reached);
  ASSERT_TRUE(waitFor([&] { return states_.last()->step == reached; }));
  EXPECT_EQ(bits(*states_.last()), after);
  ASSERT_TRUE(pause(false));
  const std::size_t seen = reports.size();
  EXPECT_TRUE(runClock(40, 2));
  EXPECT_TRUE(waitFor([&] { return reports.size() > seen; }));
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
