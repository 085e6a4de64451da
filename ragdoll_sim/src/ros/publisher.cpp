#include "publisher.h"

#include <ros/console.h>
#include <ros/serialization.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

using Clock = Simulation::Clock;

constexpr int kEventQueue = 10000;  ///< none may be missing in a bag, and one step may have many
constexpr double kWholeTurn = 2 * M_PI;
constexpr int kManyBodies = 50;  ///< with more, all their frames would fill /tf
constexpr Clock::duration kIdlePeriod = std::chrono::milliseconds(100);
constexpr std::chrono::milliseconds kHandlesEarly{8};  ///< so as to go with a tick
constexpr int kStateQueue =
    100;  ///< messages kept for a slow listener; then the oldest are dropped

}  // namespace

Publisher::Publisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
                     const Parameters& parameters, Troubles troubles, Handles& handles)
    : simulation_(simulation),
      clock_(clock),
      parameters_(parameters),
      imus_(nh, parameters.frame_prefix),
      sensor_frames_(parameters.frame_prefix),
      contacts_(nh, parameters.world_frame),
      markers_(nh, parameters.world_frame, parameters.coat),
      handles_(handles),
      metrics_(nh, std::move(troubles)) {
  markers_.showLimits(parameters.show_limits);
  markers_.showContacts(parameters.show_contacts);
  model_ = nh.advertise<ragdoll_msgs::Model>("model", 1, true);
  state_ = Topic::advertise<ragdoll_msgs::State>(
      nh, "state", parameters.publish_every > 0 ? kEventQueue : kStateQueue, [this] {
        newcomer_ = true;
        // It may be the display Ragdolls after a reset of rviz, which forgets markers, too.
        markers_.tellAll();
      });
  pokes_ = nh.advertise<ragdoll_msgs::PokeEvent>("pokes", kEventQueue);
  followed_ = nh.advertise<ragdoll_msgs::FollowedFrame>("followed", kEventQueue);
  tf_ = Topic::advertise<tf2_msgs::TFMessage>(nh, "/tf", kStateQueue);
  joints_ = Topic::advertise<sensor_msgs::JointState>(nh, "joint_states", kStateQueue);
  // Before someone listens: with ~publish_every none of the first messages may be missing.
  state_.fit(simulation.call([](World& world) {
    return ros::serialization::serializationLength(
        toStateMsg(*world.model(), world.state(), world.mark(), std_msgs::Header()));
  }));
  thread_ = std::thread([this] { run(); });
}

Publisher::~Publisher() { stop(); }

void Publisher::stop() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Publisher::clearMarkers() {
  constexpr double kUntilSent = 0.05;  // [s]
  stop();                              // else the next tick might draw again
  if (!markers_.wanted()) return;
  markers_.clear();
  ros::WallDuration(kUntilSent).sleep();
}

void Publisher::publishNow() {
  std::unique_lock<std::mutex> lock(mutex_);
  const std::uint64_t ticket = ++asked_;
  wake_.notify_all();
  done_.wait(lock, [&] { return answered_ >= ticket || stopping_; });
}

void Publisher::run() {
  const bool sampling = parameters_.publish_every > 0;
  const auto period = sampling ? kIdlePeriod
                               : std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(1 / parameters_.publish_rate));
  if (sampling)
    simulation_.sample(parameters_.publish_every, [this] {
      std::lock_guard<std::mutex> lock(mutex_);
      sampled_ = true;
      wake_.notify_all();
    });
  Clock::time_point next = Clock::now();
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    const bool woken = wake_.wait_until(lock, std::min(next, handles_.due()), [&] {
      return stopping_ || asked_ > answered_ || sampled_;
    });
    if (stopping_) break;
    const bool due = Clock::now() >= next;
    const std::uint64_t ticket = asked_;
    const bool demanded = asked_ > answered_;
    sampled_ = false;
    lock.unlock();
    try {
      if (woken || due)
        publishDue(demanded, !woken);
      else
        handles_.update();
    } catch (const Error&) {
      break;  // the simulation has ended
    }
    lock.lock();
    answered_ = ticket;
    done_.notify_all();
    if (!woken && !due) continue;
    if (sampling) {
      next = Clock::now() + period;
      continue;
    }
    if (demanded) continue;
    next += period;
    if (next < Clock::now()) next = Clock::now();
  }
  if (!lock.owns_lock()) lock.lock();
  stopping_ = true;
  done_.notify_all();
}

void Publisher::publishDue(bool demanded, bool idle) {
  if (parameters_.publish_every > 0) {
    while (simulation_.takeSample(world_)) tick(Why::kDue);
    if (!demanded && !idle) return;
  }
  simulation_.snapshot(world_);
  const bool due = !demanded && parameters_.publish_every <= 0;
  tick(due ? Why::kDue : demanded ? Why::kDemanded : Why::kIdle);
}

void Publisher::tick(Why why) {
  const ros::Time now = clock_.at(world_.progress);
  const Posture& shown = posture();
  if (world_.scene != fitted_scene_) {
    fitQueues(shown);
    handles_.follow();
  }
  if (world_.scene != told_scene_ || (world_.mark.run != told_run_ && world_.beginning))
    publishModel(now);
  publishEvents(now);
  imus_.publish(world_, now);
  publishContacts(now);
  const bool between = why == Why::kIdle && !world_.paused;  // two samples
  if (!between) publishTf(shown, now);
  if (!between) publishState(now, why);
  if (!between) publishJoints(shown, now);
  if (Clock::now() + kHandlesEarly >= handles_.due()) handles_.update();
  markers_.useFrames(tfBodies() == "all");
  markers_.publish(world_, shown);
  out_.send();
  metrics_.publish(world_, toHeader(parameters_.world_frame, now));
}

const Posture& Publisher::posture() {
  FrameTracker& tracker = *world_.tracker;
  // By its own clock a stamp is the state's time, and samples are of steps.
  if (world_.alpha && !clock_.own() && !(parameters_.publish_every > 0)) {
    tracker.interpolate(*world_.alpha, between_);
    return between_;
  }
  if (tracker.now().time != world_.state.time) tracker.update(world_.state);
  return tracker.now();
}

/// A scene's messages have one size.
void Publisher::fitQueues(const Posture& posture) {
  using ros::serialization::serializationLength;
  fitted_scene_ = world_.scene;
  const std_msgs::Header header = toHeader(parameters_.world_frame, ros::Time());
  state_.fit(serializationLength(toStateMsg(*world_.model, world_.state, world_.mark, header)));
  tf_.fit(serializationLength(tfMessage(posture, header)));
  joints_.fit(serializationLength(jointMessage(posture, header)));
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
  if (tfBodies() == "none") return;
  out_.add(tf_, tfMessage(posture, toHeader(parameters_.world_frame, now)));
}

tf2_msgs::TFMessage Publisher::tfMessage(const Posture& posture, const std_msgs::Header& header) {
  const std::string& bodies = tfBodies();
  tf2_msgs::TFMessage message;
  message.transforms = toTransforms(*world_.tracker, posture, header, bodies == "roots");
  sensor_frames_.append(world_, posture, bodies == "all", header, message.transforms);
  return message;
}

const std::string& Publisher::tfBodies() {
  if (world_.scene == tf_scene_) return tf_bodies_;
  tf_scene_ = world_.scene;
  tf_bodies_ = parameters_.tf_bodies;
  if (!tf_bodies_.empty()) return tf_bodies_;
  const bool many = world_.tracker->ragdolls() > kManyBodies;
  tf_bodies_ = many ? "roots" : "all";
  if (many)
    ROS_INFO("%d bodies: /tf has one frame of each; ~tf_bodies: all gives all",
             world_.tracker->ragdolls());
  return tf_bodies_;
}

void Publisher::publishState(const ros::Time& now, Why why) {
  const bool changed = world_.revision != told_revision_;
  const bool newcomer = newcomer_.exchange(false);
  const bool sampled = parameters_.publish_every > 0;  // then each moment is told once
  if ((world_.paused || sampled) && !changed && (why != Why::kDemanded || sampled) && !newcomer)
    return;
  told_revision_ = world_.revision;
  if (!state_.isHeard()) return;
  out_.add(state_, toStateMsg(*world_.model, world_.state, world_.mark,
                              toHeader(parameters_.world_frame, now)));
}

void Publisher::publishEvents(const ros::Time& now) {
  for (const Event& event : world_.events)
    pokes_.publish(toPokeEvent(event, toHeader(parameters_.world_frame, now)));
  for (const FollowedFrame& followed : world_.followed)
    followed_.publish(toFollowedMsg(followed, toHeader(parameters_.world_frame, now)));
}

void Publisher::publishContacts(const ros::Time& now) {
  contacts_.publish(world_, now, out_);
  contacts_.follow(world_, world_.pin_names);
  const bool wanted = contacts_.wanted() || markers_.wantsContacts();
  if (wanted == keeps_contacts_) return;
  keeps_contacts_ = wanted;
  simulation_.call([wanted](World& world) { world.keepContacts(wanted); });
}

void Publisher::publishJoints(const Posture& posture, const ros::Time& now) {
  if (joints_.isHeard())
    out_.add(joints_, jointMessage(posture, toHeader(parameters_.world_frame, now)));
}

sensor_msgs::JointState Publisher::jointMessage(const Posture& posture,
                                                const std_msgs::Header& header) {
  if (world_.scene != angles_scene_) {
    angles_.emplace(*world_.model, *world_.tracker);
    angles_scene_ = world_.scene;
  }
  sensor_msgs::JointState message;
  message.header = header;
  message.name = angles_->names();
  message.position.resize(message.name.size());
  angles_->compute(posture, message.position);
  message.velocity.assign(message.name.size(), 0);
  const Posture &before = world_.tracker->previous(), &after = world_.tracker->now();
  if (const double passed = after.time - before.time; passed > 0) {
    angles_before_.resize(message.name.size());
    angles_after_.resize(message.name.size());
    angles_->compute(before, angles_before_);
    angles_->compute(after, angles_after_);
    for (std::size_t i = 0; i < message.velocity.size(); ++i)
      message.velocity[i] =
          std::remainder(angles_after_[i] - angles_before_[i], kWholeTurn) / passed;
  }
  return message;
}

}  // namespace ragdoll
