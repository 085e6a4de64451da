#include "publisher.h"

#include <sensor_msgs/JointState.h>

#include <chrono>

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

using Clock = Simulation::Clock;

constexpr int kEventQueue = 10000;  ///< none may be missing in a bag, and one step may have many
constexpr int kQueue = 100;  ///< messages kept for a slow listener; then the oldest are dropped

}  // namespace

Publisher::Publisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
                     const Parameters& parameters, FrameTroubles troubles)
    : simulation_(simulation),
      clock_(clock),
      parameters_(parameters),
      markers_(nh, parameters.world_frame, parameters.coat),
      metrics_(nh, std::move(troubles)) {
  markers_.showLimits(parameters.show_limits);
  model_ = nh.advertise<ragdoll_msgs::Model>("model", 1, true);
  state_ = nh.advertise<ragdoll_msgs::State>(
      "state", kQueue, [this](const ros::SingleSubscriberPublisher&) { newcomer_ = true; });
  pokes_ = nh.advertise<ragdoll_msgs::PokeEvent>("pokes", kEventQueue);
  followed_ = nh.advertise<ragdoll_msgs::FollowedFrame>("followed", kEventQueue);
  joints_ = nh.advertise<sensor_msgs::JointState>("joint_states", kQueue);
  thread_ = std::thread([this] { run(); });
}

Publisher::~Publisher() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Publisher::publishNow() {
  std::unique_lock<std::mutex> lock(mutex_);
  const std::uint64_t ticket = ++asked_;
  wake_.notify_all();
  done_.wait(lock, [&] { return answered_ >= ticket || stopping_; });
}

void Publisher::run() {
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(1 / parameters_.publish_rate));
  Clock::time_point next = Clock::now();
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    const bool demanded =
        wake_.wait_until(lock, next, [&] { return stopping_ || asked_ > answered_; });
    if (stopping_) break;
    const std::uint64_t ticket = asked_;
    lock.unlock();
    try {
      tick(demanded);
    } catch (const Error&) {
      break;  // the simulation has ended
    }
    lock.lock();
    answered_ = ticket;
    done_.notify_all();
    if (demanded) continue;
    next += period;
    if (next < Clock::now()) next = Clock::now();
  }
  if (!lock.owns_lock()) lock.lock();
  stopping_ = true;
  done_.notify_all();
}

void Publisher::tick(bool demanded) {
  simulation_.snapshot(world_);
  const ros::Time now = clock_.at(world_.progress);
  const Posture& shown = posture();
  if (world_.scene != told_scene_ || (world_.mark.run != told_run_ && world_.beginning))
    publishModel(now);
  publishEvents(now);
  publishTf(shown, now);
  publishState(now, demanded);
  publishJoints(shown, now);
  markers_.publish(world_, shown);
  metrics_.publish(world_, toHeader(parameters_.world_frame, now));
}

const Posture& Publisher::posture() {
  FrameTracker& tracker = *world_.tracker;
  if (world_.alpha) {
    tracker.interpolate(*world_.alpha, between_);
    return between_;
  }
  if (tracker.now().time != world_.state.time) tracker.update(world_.state);
  return tracker.now();
}

void Publisher::publishModel(const ros::Time& now) {
  told_scene_ = world_.scene;
  told_run_ = world_.mark.run;
  ragdoll_msgs::Model message =
      toModelMsg(*world_.scene, *world_.model, toHeader(parameters_.world_frame, now));
  message.scene = world_.source;
  message.run = world_.mark.run;
  if (world_.beginning) message.snapshot = *world_.beginning;
  model_.publish(message);
}

void Publisher::publishTf(const Posture& posture, const ros::Time& now) {
  // tf2 complains of a stamp that it has seen, and a stamp of zero means that no clock ticks.
  if (now.isZero() || now == last_stamp_) return;
  last_stamp_ = now;
  tf_.sendTransform(toTransforms(*world_.tracker, posture, toHeader(parameters_.world_frame, now)));
}

void Publisher::publishState(const ros::Time& now, bool demanded) {
  const bool changed = world_.revision != told_revision_;
  const bool newcomer = newcomer_.exchange(false);
  if (world_.paused && !changed && !demanded && !newcomer) return;
  told_revision_ = world_.revision;
  if (state_.getNumSubscribers() == 0) return;
  state_.publish(
      toStateMsg(*world_.model, world_.state, world_.mark, toHeader(parameters_.world_frame, now)));
}

void Publisher::publishEvents(const ros::Time& now) {
  for (const Event& event : world_.events)
    pokes_.publish(toPokeEvent(event, toHeader(parameters_.world_frame, now)));
  for (const FollowedFrame& followed : world_.followed)
    followed_.publish(toFollowedMsg(followed, toHeader(parameters_.world_frame, now)));
}

void Publisher::publishJoints(const Posture& posture, const ros::Time& now) {
  if (joints_.getNumSubscribers() == 0) return;
  if (world_.scene != angles_scene_) {
    angles_.emplace(*world_.model, *world_.tracker);
    angles_scene_ = world_.scene;
  }
  sensor_msgs::JointState message;
  message.header = toHeader(parameters_.world_frame, now);
  message.name = angles_->names();
  message.position.resize(message.name.size());
  angles_->compute(posture, message.position);
  joints_.publish(message);
}

}  // namespace ragdoll
