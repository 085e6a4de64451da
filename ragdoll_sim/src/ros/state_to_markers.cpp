#include "state_to_markers.h"

#include <ros/this_node.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

constexpr double kPicturePeriod = 1.0 / 60;  ///< [s] between two pictures
constexpr double kMaxGap = 0.1;              ///< [s] of simulation; a longer one is a jump
constexpr double kIgnoredPeriod = 5;         ///< [s]
constexpr double kRecordedTfHolds = 1;   ///< [s] without a recorded frame, then they are drawn anew
constexpr std::size_t kMaxEarly = 1000;  ///< pokes kept until their model comes

}  // namespace

StateToMarkers::StateToMarkers(ros::NodeHandle& nh, const std::string& coat,
                               const std::string& frame_prefix)
    : nh_(nh), coat_(coat), frame_prefix_(frame_prefix), sensor_frames_(frame_prefix) {
  subscribers_.push_back(nh_.subscribe("model", 10, &StateToMarkers::hearModel, this));
  subscribers_.push_back(nh_.subscribe("state", 100, &StateToMarkers::state, this));
  subscribers_.push_back(nh_.subscribe("pokes", 1000, &StateToMarkers::poke, this));
  subscribers_.push_back(nh_.subscribe("followed", 1000, &StateToMarkers::followed, this));
  subscribers_.push_back(nh_.subscribe("/tf", 100, &StateToMarkers::transforms, this));
  timer_ = nh_.createWallTimer(ros::WallDuration(kPicturePeriod),
                               [this](const ros::WallTimerEvent&) { draw(); });
}

void StateToMarkers::hearModel(const ros::MessageEvent<AnyModel const>& event) {
  try {
    model(toModel(*event.getConstMessage(), event.getConnectionHeader()["md5sum"]));
  } catch (const Error& e) {
    ROS_ERROR("~model ignored: %s", e.what());
  }
}

void StateToMarkers::model(const ragdoll_msgs::Model& message) {
  if (world_.scene && message.scene_yaml == world_.scene->text) return;
  try {
    auto scene = std::make_shared<Scene>(parseScene(message.scene_yaml, "~model"));
    world_.model = std::make_shared<Model>(buildModel(*scene));
    world_.scene = std::move(scene);
  } catch (const Error& e) {
    ROS_ERROR("~model ignored: %s", e.what());
    return;
  }
  world_.state = startState(*world_.model);
  world_.tracker.emplace(*world_.model, frame_prefix_);
  world_.tracker->reset(world_.state);
  follow_ = Follow();
  follow_.restart(*world_.model, world_.state);
  told_glides_.clear();
  heard_ = false;
  if (!markers_ || world_frame_ != message.header.frame_id) {
    world_frame_ = message.header.frame_id;
    markers_.reset();
    markers_ = std::make_unique<MarkerPublisher>(nh_, world_frame_, coat_);
    frames_ = std::make_unique<FrameLookup>(world_frame_);
  }
  hearEarly();
}

/// Topics come in no common order: what came before the first model is heard now.
void StateToMarkers::hearEarly() {
  for (const ragdoll_msgs::PokeEvent& message : early_pokes_) poke(message);
  early_pokes_.clear();
  if (early_state_) state(*early_state_);
  early_state_.reset();
}

void StateToMarkers::state(const ragdoll_msgs::State& message) {
  if (!world_.model) early_state_ = message;
  if (!world_.model || !fits(*world_.model, message)) {
    ROS_WARN_THROTTLE(kIgnoredPeriod, "~state ignored: %s",
                      world_.model ? "it is not of the scene that ~model told"
                                   : "no ~model has come yet; was it recorded?");
    return;
  }
  State& state = world_.state;
  const double passed = message.time - state.time;
  const bool jump = !heard_ || message.run != world_.mark.run || passed < 0 || passed > kMaxGap;
  const std::uint64_t before = jump ? message.step : state.step;
  putState(*world_.model, message, state);
  if (jump)
    world_.tracker->reset(state);
  else if (passed > 0)
    world_.tracker->update(state);
  const bool other_run = !heard_ || message.run != world_.mark.run;
  world_.mark = {message.run, message.told, message.followed};
  if (other_run)
    for (const Poke& poke : world_.model->pokes) tell(poke, message.run);
  heard_ = true;
  gatherActed(before, state.step);
}

void StateToMarkers::poke(const ragdoll_msgs::PokeEvent& message) {
  if (!world_.model) {
    if (early_pokes_.size() < kMaxEarly) early_pokes_.push_back(message);
    return;
  }
  try {
    Event event = fromPokeEvent(*world_.model, message);
    if (message.body_name.empty()) {
      for (Told& t : told_)
        if (t.event.run == message.run) t.end = std::min(t.end, message.step);
      return;
    }
    event.poke.start = static_cast<double>(message.step) * world_.model->solver.step;
    tell(event.poke, message.run);
    // Shown late: what a ~wrench did is told when it has been done, and topics come in no common
    // order.
    if (message.run == world_.mark.run && told_.back().event.step < world_.state.step)
      world_.acted.push_back(event.poke);
  } catch (const Error& e) {
    ROS_WARN_THROTTLE(kIgnoredPeriod, "~pokes ignored: %s", e.what());
  }
}

void StateToMarkers::followed(const ragdoll_msgs::FollowedFrame& message) {
  if (!world_.model) return;
  try {
    told_glides_[message.frame] = fromFollowedMsg(*world_.model, message);
  } catch (const Error& e) {
    ROS_WARN_THROTTLE(kIgnoredPeriod, "~followed ignored: %s", e.what());
  }
}

void StateToMarkers::tell(const Poke& poke, std::uint32_t run) {
  const double h = world_.model->solver.step;
  const auto step = static_cast<std::uint64_t>(std::max(0.0, std::round(poke.start / h)));
  Told told{{step, poke, run}, std::numeric_limits<std::uint64_t>::max()};
  if (poke.duration >= 0)
    told.end = step + static_cast<std::uint64_t>(std::max(1.0, std::round(poke.duration / h)));
  told_.push_back(std::move(told));
}

/// The pokes that acted in a step of [before, now).
void StateToMarkers::gatherActed(std::uint64_t before, std::uint64_t now) {
  const std::uint32_t run = world_.mark.run;
  const auto over = [&](const Told& t) {
    return t.event.run < run || (t.event.run == run && t.end <= before);
  };
  told_.erase(std::remove_if(told_.begin(), told_.end(), over), told_.end());
  for (const Told& t : told_)
    if (t.event.run == run && t.event.step < now && !contains(world_.acted, t.event.poke))
      world_.acted.push_back(t.event.poke);
}

void StateToMarkers::transforms(const ros::MessageEvent<tf2_msgs::TFMessage const>& event) {
  if (event.getPublisherName() == ros::this_node::getName() || !world_.tracker) return;
  // The last one: the first may be there without the others, with ~tf_bodies: roots.
  const int last = world_.tracker->size() - 1;
  for (const auto& transform : event.getConstMessage()->transforms)
    if (last >= 0 && transform.child_frame_id == world_.tracker->name(last))
      recorded_tf_ = ros::WallTime::now();
}

void StateToMarkers::draw() {
  if (!heard_) return;
  placeObstacles();
  markers_->publish(world_, world_.tracker->now());
  world_.acted.clear();
  publishTf();
}

/// Those that follow a frame of someone else's: as ~followed tells, else as TF does.
void StateToMarkers::placeObstacles() {
  if (follow_.empty()) return;
  for (const std::string& frame : follow_.frames()) {
    const auto told = told_glides_.find(frame);
    if (told != told_glides_.end()) {
      const FollowedFrame& followed = told->second;
      const auto steps =
          static_cast<double>(world_.state.step) - static_cast<double>(followed.step);
      const bool same_run = followed.run == world_.mark.run;
      follow_.hear(frame, followed.glide.at(
                              same_run ? std::max(0.0, steps) * world_.model->solver.step : 0));
    } else if (const std::optional<StampedPose> found = frames_->find(frame)) {
      follow_.hear(frame, found->pose);
    }
  }
  follow_.restart(*world_.model, world_.state);
}

void StateToMarkers::publishTf() {
  const ros::Time now = ros::Time::now();
  if (now.isZero() || now == last_stamp_) return;
  if ((ros::WallTime::now() - recorded_tf_).toSec() < kRecordedTfHolds) return;
  last_stamp_ = now;
  const Posture& posture = world_.tracker->now();
  const std_msgs::Header header = toHeader(world_frame_, now);
  auto transforms = toTransforms(*world_.tracker, posture, header);
  sensor_frames_.append(world_, posture, true, header, transforms);
  tf_.sendTransform(transforms);
}

}  // namespace ragdoll
