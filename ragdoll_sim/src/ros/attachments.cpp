#include "attachments.h"

#include <ros/console.h>

#include <algorithm>
#include <chrono>

#include "answer.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

using Clock = Simulation::Clock;
using std::chrono::milliseconds;

constexpr milliseconds kLookPeriod{10};  ///< between two looks
constexpr double kSilence = 1;           ///< [s] a frame without news for so long is reported
constexpr double kFirst = 3;  ///< [s] one that was never heard: whoever sends it may start

/// What holding or letting go took, if it is worth telling; it goes to the log, too.
std::string energyText(const World& world) {
  const std::string text = takenText(world.energyTaken());
  if (!text.empty()) ROS_INFO("%s", text.c_str());
  return text.empty() ? text : "; " + text;
}

}  // namespace

Attachments::Attachments(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
                         const FrameLookup& frames)
    : simulation_(simulation), clock_(clock), frames_(frames) {
  servers_.push_back(nh.advertiseService("attach", &Attachments::attach, this));
  servers_.push_back(nh.advertiseService("detach", &Attachments::detach, this));
  thread_ = std::thread([this] { run(); });
  simulation_.watchFollowing([this](bool follows) {
    std::lock_guard<std::mutex> lock(mutex_);
    follows_ = follows;
    wake_.notify_all();
  });
}

Attachments::~Attachments() {
  try {
    simulation_.watchFollowing(nullptr);
  } catch (const Error&) {
    // it has ended, and tells nothing more
  }
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool Attachments::attach(ragdoll_msgs::Attach::Request& request,
                         ragdoll_msgs::Attach::Response& response) {
  const auto act = [&] {
    const std::string frame = FrameLookup::normal(request.frame);
    const std::string taken = simulation_.call([&](World& world) {
      findBody(*world.model(), request.body_name);
      if (!frame.empty() && !world.hasFrame(frame)) frames_.inWorld(frame);
      world.attach(request.body_name, frame);
      return energyText(world);
    });
    return request.body_name + " is held at " + frame + taken;
  };
  return answer(act, response.success, response.status_message);
}

bool Attachments::detach(ragdoll_msgs::Detach::Request& request,
                         ragdoll_msgs::Detach::Response& response) {
  const auto act = [&] {
    const std::string taken = simulation_.call([&](World& world) {
      world.detach(request.body_name);
      return energyText(world);
    });
    return request.body_name + " is free" + taken;
  };
  return answer(act, response.success, response.status_message);
}

std::vector<std::string> Attachments::missing() const {
  std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, heard] : heard_)
    if (heard.missing) names.push_back(name);
  return names;
}

/// Where nothing follows a frame there is nothing to look for.
void Attachments::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || follows_ || !heard_.empty(); });
    if (wake_.wait_for(lock, kLookPeriod, [this] { return stopping_; })) return;
    lock.unlock();
    try {
      look();
    } catch (const Error&) {
      return;  // the simulation has ended
    }
    lock.lock();
  }
}

/// By the steady clock or by the one that stamps frames, whichever is slower: where that stands, as
/// in a paused Gazebo, nobody sends any.
void Attachments::letTimePass() {
  const double tick = clock_.now(simulation_).toSec();
  if (tick == tick_) return;
  const Clock::time_point now = Clock::now();
  const double steady = std::chrono::duration<double>(now - ticked_).count();
  passed_ += std::max(0.0, std::min(steady, tick - tick_));
  ticked_ = now;
  tick_ = tick;
}

void Attachments::look() {
  letTimePass();
  const std::vector<std::string> wanted =
      simulation_.look([](World& world) { return world.followedFrames(); });
  struct News {
    std::string frame;
    Pose pose;
    bool back;
  };
  std::vector<News> news;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    std::map<std::string, Heard> heard;
    for (const std::string& frame : wanted) {
      Heard& h = heard[frame] = heard_[frame];
      if (!h.at) h.at = passed_;
      const std::optional<StampedPose> found = frames_.find(frame);
      if (found) {
        if (found->stamp != h.stamp || found->stamp.isZero() || !h.ever) {
          h.at = passed_;
          news.push_back({frame, found->pose, h.missing});
        }
        h.stamp = found->stamp;
        h.ever = true;
      }
      judge(frame, h);
    }
    heard_.swap(heard);
  }
  if (news.empty()) return;
  simulation_.look([&](World& world) {
    for (const News& n : news) world.hear(n.frame, n.pose, n.back);
  });
}

void Attachments::judge(const std::string& frame, Heard& heard) {
  const bool missing = passed_ - *heard.at > (heard.ever ? kSilence : kFirst);
  if (missing && !heard.missing)
    ROS_WARN("frame '%s': %s", frame.c_str(),
             heard.ever
                 ? "no news from TF; what follows it stays where it is"
                 : "not heard of in TF; until it is, obstacles that follow it are 10 km below, "
                   "and particles are held where they are");
  if (!missing && heard.missing)
    ROS_INFO("frame '%s' is %s", frame.c_str(), heard.unknown ? "there" : "back");
  heard.missing = missing;
  heard.unknown = missing && !heard.ever;
}

}  // namespace ragdoll
