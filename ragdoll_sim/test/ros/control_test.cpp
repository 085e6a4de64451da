// ~pause, ~step and ~reset, and what ~state says of them.
#include <gtest/gtest.h>
#include <ragdoll_msgs/State.h>
#include <ragdoll_msgs/Step.h>
#include <ros/ros.h>

#include <cmath>
#include <future>
#include <memory>
#include <string>

#include "client.h"

namespace {

using ragdoll_msgs::State;
using ragdoll_test::bits;
using ragdoll_test::Inbox;
using ragdoll_test::pause;
using ragdoll_test::reset;
using ragdoll_test::waitFor;

constexpr std::uint32_t kLong = 10000000;  ///< steps; as many as one call may ask for

class Control : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/step", 30000));
    states_ = std::make_unique<Inbox<State>>("/ragdoll/state");
    ASSERT_TRUE(states_->connected());
    ASSERT_TRUE(pause(true));
    ASSERT_TRUE(reset());
    at(0);  // all that was told before it has been heard
  }

  static ragdoll_msgs::Step::Response step(std::uint32_t steps) {
    ragdoll_msgs::Step call;
    call.request.steps = steps;
    EXPECT_TRUE(ragdoll_test::call("/ragdoll/step", call));
    return call.response;
  }
  /// The published state of that step.
  State at(std::uint64_t step) {
    const bool came = waitFor([&] { return states_->last() && states_->last()->step == step; });
    EXPECT_TRUE(came) << "no state of step " << step;
    return came ? *states_->last() : State();
  }
  bool reaches(std::uint64_t step) {
    return waitFor([&] { return states_->last() && states_->last()->step > step; });
  }

  std::unique_ptr<Inbox<State>> states_;
};

TEST_F(Control, stepMakesThatManySteps) {
  EXPECT_EQ(at(0).time, 0);
  EXPECT_EQ(step(1).step, 1u);
  const double h = at(1).time;
  EXPECT_GT(h, 0);
  EXPECT_EQ(step(7).step, 8u);
  EXPECT_NEAR(at(8).time, 8 * h, 1e-12);
  EXPECT_EQ(step(0).step, 8u);
  EXPECT_EQ(step(2000).step, 2008u);
  EXPECT_NEAR(at(2008).time, 2008 * h, 1e-9);
}

TEST_F(Control, stepIsRefusedWhileRunning) {
  ASSERT_TRUE(pause(false));
  const auto answer = step(1);
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.status_message.find("pause"), std::string::npos) << answer.status_message;
}

TEST_F(Control, absurdStepCountsAreRefused) {
  const auto answer = step(4294967295u);  // what -1 becomes
  EXPECT_FALSE(answer.success);
  EXPECT_NE(answer.status_message.find("4294967295"), std::string::npos) << answer.status_message;
  EXPECT_EQ(step(0).step, 0u);
}

TEST_F(Control, resetReturnsToTheStartBitForBitAndSoDoesWhatFollows) {
  const std::string start = bits(at(0));
  step(300);
  const std::string then = bits(at(300));
  EXPECT_NE(then.substr(16), start.substr(16));
  ASSERT_TRUE(reset());
  EXPECT_EQ(bits(at(0)), start);
  step(100);
  step(200);
  EXPECT_EQ(bits(at(300)), then);
}

TEST_F(Control, runningGivesTheSameBitsAsStepping) {
  ASSERT_TRUE(pause(false));
  ASSERT_TRUE(reaches(100));
  ASSERT_TRUE(pause(true));
  const std::uint64_t reached = step(0).step;
  const std::string ran = bits(at(reached));
  ASSERT_TRUE(reset());
  step(static_cast<std::uint32_t>(reached));
  EXPECT_EQ(bits(at(reached)), ran);
}

TEST_F(Control, pauseStopsAndSurvivesReset) {
  ASSERT_TRUE(pause(false));
  ASSERT_TRUE(reaches(10));
  ASSERT_TRUE(pause(true));
  ASSERT_TRUE(reset());
  at(0);
  // Were it running, these calls would see it move on.
  for (int i = 0; i < 50; ++i) EXPECT_EQ(step(0).step, 0u);
  ASSERT_TRUE(pause(false));
  EXPECT_TRUE(reaches(10));
}

TEST_F(Control, rosTimeGoesOnOverAReset) {
  step(10);
  const ros::Time before = at(10).header.stamp;
  ASSERT_TRUE(reset());
  EXPECT_GT(at(0).header.stamp, before);
}

TEST_F(Control, aLateListenerHearsThePausedState) {
  step(5);
  at(5);
  states_.reset();  // a process connects once, however many subscribers it has
  Inbox<State> late("/ragdoll/state");
  ASSERT_TRUE(waitFor([&] { return late.size() > 0; }));
  EXPECT_EQ(late.last()->step, 5u);
}

TEST_F(Control, aResetEndsALongStep) {
  const std::size_t seen = states_->size();  // none of them is of the long step
  auto answer = std::async(std::launch::async, [] { return step(kLong); });
  // It is under way once its steps are seen.
  ASSERT_TRUE(waitFor([&] {
    for (std::size_t i = seen; i < states_->size(); ++i)
      if (states_->all()[i]->step > 0) return true;
    return false;
  }));
  ASSERT_TRUE(reset());
  const auto response = answer.get();
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.status_message.find("reset"), std::string::npos) << response.status_message;
  EXPECT_EQ(step(0).step, 0u);
}

TEST_F(Control, runsInRealTime) {
  ASSERT_TRUE(pause(false));
  ASSERT_TRUE(reaches(20));
  // A busy machine holds a message up, now and then; it does not do so every time.
  EXPECT_TRUE(waitFor([&] {
    const State a = *states_->last();
    EXPECT_TRUE(waitFor([&] { return states_->last()->time > a.time + 2; }));
    const State b = *states_->last();
    return std::abs((b.time - a.time) / (b.header.stamp - a.header.stamp).toSec() - 1) < 0.02;
  }));
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "control_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
