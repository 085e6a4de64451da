#include "ragdoll_sim/world/follow.h"

#include <algorithm>

namespace ragdoll {
namespace {

constexpr double kNewest = 0.2;  ///< share of the last interval in the smoothed one

Pose between(const Pose& a, const Pose& b, double share) {
  return {a.position + share * (b.position - a.position),
          a.orientation.slerp(share, b.orientation)};
}

Pose product(const Pose& a, const Pose& b) {
  return {a.position + a.orientation * b.position, (a.orientation * b.orientation).normalized()};
}

}  // namespace

Pose Glide::at(double passed) const {
  return between(from, to, std::min(1.0, (age + passed) / duration));
}

int Follow::use(const std::string& name) {
  if (name.empty()) return -1;
  for (std::size_t i = 0; i < frames_.size(); ++i)
    if (frames_[i].name == name) return static_cast<int>(i);
  frames_.emplace_back();
  frames_.back().name = name;
  return static_cast<int>(frames_.size()) - 1;
}

void Follow::restart(const Model& model, State& state) {
  held_.clear();
  obstacle_frame_.assign(model.obstacles.size(), -1);
  setPins(model);
  for (Frame& frame : frames_) {
    frame.from = frame.now = frame.to;
    frame.fresh = true;
  }
  tellAll();
  for (std::size_t i = 0; i < obstacle_frame_.size(); ++i)
    if (obstacle_frame_[i] >= 0)
      state.obstacles[i] = poseOf(model.obstacles[i], obstacle_frame_[i]);
}

Pose Follow::poseOf(const Obstacle& obstacle, int frame) const {
  if (frames_[frame].heard) return product(frames_[frame].now, obstacle.pose);
  Pose away = obstacle.pose;
  away.position.z() = kAway;
  return away;
}

void Follow::setPins(const Model& model) {
  const std::vector<Frame> known = std::exchange(frames_, {});
  const std::vector<Held> before = std::exchange(held_, {});
  for (std::size_t i = 0; i < model.obstacles.size(); ++i)
    obstacle_frame_[i] = use(model.obstacles[i].frame);
  for (const Pin& pin : model.pins) {
    Held held{use(pin.frame), pin.particle, Vec3::Zero(), -1};
    for (const Held& b : before)
      if (b.particle == held.particle && b.frame >= 0 && known[b.frame].name == pin.frame)
        held.offset = b.offset, held.age = b.age;
    held_.push_back(held);
  }
  for (Frame& frame : frames_)
    for (const Frame& k : known)
      if (k.name == frame.name) frame = k;
}

std::vector<std::string> Follow::frames() const {
  std::vector<std::string> names;
  for (const Frame& frame : frames_) names.push_back(frame.name);
  return names;
}

void Follow::hear(const std::string& name, const Pose& pose) {
  for (Frame& frame : frames_) {
    if (frame.name != name) continue;
    if (frame.heard && pose.position == frame.to.position &&
        pose.orientation.coeffs() == frame.to.orientation.coeffs())
      continue;
    if (frame.heard && frame.age > 0 && frame.age < kLongestInterval)
      frame.interval += (frame.interval > 0 ? kNewest : 1) * (frame.age - frame.interval);
    frame.glide = std::max(kShortestGlide, kGlides * frame.interval);
    frame.from = frame.heard ? frame.now : pose;
    frame.to = pose;
    frame.age = 0;
    if (!frame.heard) frame.now = pose;
    frame.heard = frame.changed = true;
  }
}

std::vector<Glide> Follow::takeChanges() {
  std::vector<Glide> changes;
  for (Frame& frame : frames_) {
    if (!frame.heard || !(frame.changed || changed_all_)) continue;
    frame.changed = false;
    changes.push_back({frame.name, frame.from, frame.to, frame.age, frame.glide, frame.fresh, {}});
    if (!changed_all_) continue;
    for (const Held& held : held_)
      if (held.age >= 0 && frames_[held.frame].name == frame.name)
        changes.back().held.push_back({held.particle, "", held.offset, held.age});
  }
  changed_all_ = false;
  return changes;
}

void Follow::repeat(const Glide& glide, const Model& model, State& state) {
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    Frame& frame = frames_[f];
    if (frame.name != glide.frame) continue;
    frame.heard = true;
    frame.fresh = glide.jump;
    frame.from = glide.from;
    frame.to = glide.to;
    frame.age = glide.age;
    frame.glide = glide.duration;
    frame.now = glide.at(0);
    for (const Glide::Particle& p : glide.held)
      for (Held& held : held_)
        if (held.particle == p.particle) held.offset = p.offset, held.age = p.age;
    for (std::size_t i = 0; i < obstacle_frame_.size(); ++i)
      if (!frame.fresh && obstacle_frame_[i] == static_cast<int>(f))
        state.obstacles[i] = poseOf(model.obstacles[i], obstacle_frame_[i]);
  }
}

void Follow::apply(const Model& model, double h, State& state, Inputs& inputs) {
  if (frames_.empty()) return;
  for (Frame& frame : frames_) {
    frame.age += h;
    frame.now = between(frame.from, frame.to, std::min(1.0, frame.age / frame.glide));
  }
  inputs.obstacles = state.obstacles;
  for (std::size_t i = 0; i < obstacle_frame_.size(); ++i) {
    if (obstacle_frame_[i] < 0) continue;
    inputs.obstacles[i] = poseOf(model.obstacles[i], obstacle_frame_[i]);
    if (frames_[obstacle_frame_[i]].fresh) state.obstacles[i] = inputs.obstacles[i];
  }
  inputs.pins.resize(model.pins.size());
  for (std::size_t i = 0; i < held_.size(); ++i) {
    Held& held = held_[i];
    inputs.pins[i] = state.x.col(held.particle);
    if (held.frame < 0 || !frames_[held.frame].heard) continue;
    const Vec3& at = frames_[held.frame].now.position;
    if (held.age < 0) {
      held.offset = state.x.col(held.particle) - at;
      held.age = 0;
    }
    held.age += h;
    inputs.pins[i] = at + std::max(0.0, 1 - held.age / kDraw) * held.offset;
  }
  for (Frame& frame : frames_) frame.fresh = !frame.heard;
}

}  // namespace ragdoll
