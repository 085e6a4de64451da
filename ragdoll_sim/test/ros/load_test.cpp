// Many pokes a second, from several clients: each that was accepted is told in ~pokes once, with
// the step that its answer named, and the simulation keeps its pace.
#include <gtest/gtest.h>
#include <ragdoll_msgs/Metrics.h>
#include <ragdoll_msgs/Poke.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ragdoll_msgs/State.h>
#include <ros/ros.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "client.h"

namespace {

using ragdoll_msgs::Metrics;
using ragdoll_msgs::PokeEvent;
using ragdoll_msgs::State;
using ragdoll_test::Inbox;
using ragdoll_test::waitFor;
using Clock = std::chrono::steady_clock;

constexpr int kClients = 4;
constexpr double kRate = 1000;  ///< [1/s] of pokes, of all clients together

int pokes() {
  const char* text = std::getenv("RAGDOLL_POKES");
  return text ? std::atoi(text) : 3000;
}

/// Pokes at its share of the rate, or as fast as it is answered. What identifies a poke is its
/// force; steps[k] is the step that the answer names, -1 if it was not accepted.
void poke(int client, std::vector<long>& steps) {
  ros::ServiceClient service =
      ros::NodeHandle().serviceClient<ragdoll_msgs::Poke>("/ragdoll/poke", true);
  const Clock::time_point begin = Clock::now();
  for (std::size_t k = static_cast<std::size_t>(client); k < steps.size(); k += kClients) {
    std::this_thread::sleep_until(
        begin + std::chrono::duration_cast<Clock::duration>(
                    std::chrono::duration<double>(static_cast<double>(k) / kRate)));
    ragdoll_msgs::Poke call;
    call.request.body_name = "head";
    call.request.force.x = 1e-6 * static_cast<double>(k + 1);
    call.request.duration = ros::Duration(k % 2 ? 0.1 : 0.0);
    if (!service.call(call) || !call.response.success) continue;
    const std::string word = "from step ";
    const std::string& message = call.response.status_message;
    steps[k] = std::atol(message.c_str() + message.find(word) + word.size());
  }
}

TEST(Load, noPokeIsLostAndThePaceIsKept) {
  ASSERT_TRUE(ros::service::waitForService("/ragdoll/poke", 30000));
  Inbox<PokeEvent> told("/ragdoll/pokes");
  Inbox<State> states("/ragdoll/state");
  Inbox<Metrics> metrics("/ragdoll/metrics");
  ASSERT_TRUE(told.connected() && states.connected() && metrics.connected());

  std::vector<long> steps(static_cast<std::size_t>(pokes()), -1);
  const Clock::time_point begin = Clock::now();
  std::atomic<int> running{kClients};
  std::vector<std::thread> clients;
  for (int i = 0; i < kClients; ++i)
    clients.emplace_back([&, i] {
      poke(i, steps);
      --running;
    });
  // The pace, in windows of a second: a busy machine spoils some, not all.
  int kept = 0, windows = 0;
  while (running > 0 || (kept == 0 && Clock::now() - begin < std::chrono::seconds(60))) {
    const State::ConstPtr first = states.last();
    const Clock::time_point from = Clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const State::ConstPtr last = states.last();
    const double seconds = std::chrono::duration<double>(Clock::now() - from).count();
    ++windows;
    kept += first && last && std::abs((last->time - first->time) / seconds - 1) < 0.1;
  }
  for (std::thread& client : clients) client.join();
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  EXPECT_GT(kept, 0) << "of " << windows << " windows";

  ASSERT_TRUE(waitFor([&] { return told.size() >= steps.size(); }))
      << told.size() << " of " << steps.size() << " pokes are told";
  std::map<long, std::vector<long>> of_poke;  // k to the steps that were told
  for (const auto& event : told.all())
    of_poke[std::lround(event->force.x * 1e6) - 1].push_back(static_cast<long>(event->step));
  for (std::size_t k = 0; k < steps.size(); ++k) {
    ASSERT_GE(steps[k], 0) << "poke " << k << " was not accepted";
    ASSERT_EQ(of_poke[static_cast<long>(k)], std::vector<long>{steps[k]}) << "poke " << k;
  }
  ASSERT_TRUE(metrics.last());
  std::printf("%zu pokes at %.0f/s, pace kept in %d of %d windows, lateness of steps "
              "%.0f us (50 %%), %.0f us (99 %%), %.0f us (99.9 %%), %.0f us (largest)\n",
              steps.size(), static_cast<double>(steps.size()) / seconds, kept, windows,
              1e6 * metrics.last()->step_lateness_p50, 1e6 * metrics.last()->step_lateness_p99,
              1e6 * metrics.last()->step_lateness_p999, 1e6 * metrics.last()->step_lateness_max);
}

/// All that were accepted and are not over are there to be ended.
TEST(Load, pokesAtOnceAllCount) {
  ASSERT_TRUE(ragdoll_test::pause(true));
  std_srvs::Trigger clear;
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/clear_pokes", clear));  // those that still act
  ragdoll_msgs::Poke call;
  call.request.body_name = "head";
  call.request.force.z = 0.5;
  call.request.duration = ros::Duration(0.1);
  for (int i = 0; i < 200; ++i)
    ASSERT_TRUE(ragdoll_test::call("/ragdoll/poke", call) && call.response.success);
  ASSERT_TRUE(ragdoll_test::call("/ragdoll/clear_pokes", clear));
  EXPECT_EQ(clear.response.message, "200 pokes ended");
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "load_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
