#include "ragdoll_sim/world/follow.h"

#include <algorithm>

#include "ragdoll_sim/core/sleep.h"

namespace ragdoll {
namespace {

constexpr double kNewest = 0.2;    ///< share of the last interval in the smoothed one
constexpr double kLooks = 0.02;    ///< [s] shorter intervals are those of looking, not of the frame
constexpr double kPlaneReach = 1;  ///< [m] a plane's farthest point would be infinitely far

Pose between(const Pose& a, const Pose& b, double share) {
  return {a.position + share * (b.position - a.position),
          a.orientation.slerp(share, b.orientation)};
}

Pose product(const Pose& a, const Pose& b) {
  return {a.position + a.orientation * b.position, (a.orientation * b.orientation).normalized()};
}

/// [m] from the origin of the frame that it follows.
double reachOf(const Obstacle& obstacle) {
  const double arm = obstacle.pose.position.norm();
  switch (obstacle.type) {
    case ObstacleSpec::Type::kPlane:
      return arm + kPlaneReach;
    case ObstacleSpec::Type::kSphere:
      return arm + obstacle.radius;
    case ObstacleSpec::Type::kCapsule:
      return arm + obstacle.half.z() + obstacle.radius;
    default:
      return arm + obstacle.half.norm();
  }
}

/// Wakes all: the step, in which it does not move, would let sleepers stand in it, or on what is
/// gone.
void jumpTo(const Pose& pose, std::size_t obstacle, State& state) {
  Pose& old = state.obstacles[obstacle];
  if (pose.position == old.position && pose.orientation.coeffs() == old.orientation.coeffs())
    return;
  old = pose;
  wakeAll(state);
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
    Held held{use(pin.frame), pin.particle};
    for (const Held& b : before)
      if (b.particle == held.particle && b.frame >= 0 && known[b.frame].name == pin.frame)
        held.drawn = b.drawn, held.offset = b.offset, held.age = b.age;
    held_.push_back(held);
  }
  for (Frame& frame : frames_)
    for (const Frame& k : known)
      if (k.name == frame.name) frame = k;
  for (std::size_t i = 0; i < model.obstacles.size(); ++i) {
    if (obstacle_frame_[i] < 0) continue;
    Frame& frame = frames_[obstacle_frame_[i]];
    frame.reach = std::max(frame.reach, reachOf(model.obstacles[i]));
  }
}

std::vector<std::string> Follow::frames() const {
  std::vector<std::string> names;
  for (const Frame& frame : frames_) names.push_back(frame.name);
  return names;
}

/// [m] that the farthest point of what follows moves.
double Follow::span(const Frame& frame, const Pose& a, const Pose& b) {
  return (b.position - a.position).norm() +
         frame.reach * a.orientation.angularDistance(b.orientation);
}

void Follow::hear(const std::string& name, const Pose& pose, bool back) {
  for (Frame& frame : frames_) {
    if (frame.name != name) continue;
    frame.told = true;
    const bool same = pose.position == frame.to.position &&
                      pose.orientation.coeffs() == frame.to.orientation.coeffs();
    if (frame.heard && same) continue;
    const double time = std::max({kLooks, frame.interval, frame.silence});
    const bool jump =
        !frame.heard || back || span(frame, frame.stood, pose) > max_frame_speed_ * time;
    if (jump) {
      frame.fresh = true;
      frame.from = frame.now = pose;
    } else {
      glideTo(frame, pose);
    }
    frame.to = pose;
    frame.age = 0;
    frame.heard = frame.changed = true;
  }
}

/// [m/s] since it was heard before.
double Follow::speedOf(const Frame& frame, const Pose& pose) {
  return span(frame, frame.stood, pose) / std::max(kLooks / 2, frame.silence);
}

/// Within kGlides intervals, if that is not much faster than the frame moves itself: than the
/// middle one of three speeds, as news that come late or early, or a small jump, give a wrong one.
void Follow::glideTo(Frame& frame, const Pose& pose) const {
  if (frame.age > 0 && frame.age < kLongestInterval)
    frame.interval += (frame.interval > 0 ? kNewest : 1) * (frame.age - frame.interval);
  const auto [slow, fast] = std::minmax(frame.speeds[0], frame.speeds[1]);
  const double speed =
      std::min(max_frame_speed_, std::clamp(speedOf(frame, pose), slow, fast)) + kCatchUp;
  frame.glide =
      std::max({kShortestGlide, kGlides * frame.interval, span(frame, frame.now, pose) / speed});
  frame.from = frame.now;
}

std::vector<Glide> Follow::takeChanges() {
  std::vector<Glide> changes;
  for (Frame& frame : frames_) {
    if (!frame.heard || !(frame.changed || changed_all_)) continue;
    frame.changed = false;
    changes.push_back({frame.name, frame.from, frame.to, frame.age, frame.glide, frame.fresh, {}});
    if (!changed_all_) continue;
    for (const Held& held : held_)
      if (held.drawn && held.frame >= 0 && frames_[held.frame].name == frame.name)
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
        if (held.particle == p.particle)
          held.drawn = true, held.offset = p.offset, held.age = p.age;
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
    if (frame.told) {
      if (!frame.fresh) frame.speeds = {speedOf(frame, frame.to), frame.speeds[0]};
      frame.silence = 0;
      frame.told = false;
    }
    frame.silence += h;
    frame.stood = frame.to;
  }
  inputs.obstacles = state.obstacles;
  for (std::size_t i = 0; i < obstacle_frame_.size(); ++i) {
    if (obstacle_frame_[i] < 0) continue;
    inputs.obstacles[i] = poseOf(model.obstacles[i], obstacle_frame_[i]);
    if (frames_[obstacle_frame_[i]].fresh) jumpTo(inputs.obstacles[i], i, state);
  }
  inputs.pins.resize(model.pins.size());
  for (std::size_t i = 0; i < held_.size(); ++i) {
    Held& held = held_[i];
    inputs.pins[i] = state.x.col(held.particle);
    if (held.frame < 0 || !frames_[held.frame].heard) continue;
    const Frame& frame = frames_[held.frame];
    draw(held, frame, inputs.pins[i], h);
    inputs.pins[i] = frame.now.position + std::max(0.0, 1 - held.age / kDraw) * held.offset;
  }
  for (Frame& frame : frames_) frame.fresh = !frame.heard;
}

/// x: where the particle is. After a jump its way is longer than it might go within kDraw: it
/// begins at an age before 0, so that it still ends at kDraw.
void Follow::draw(Held& held, const Frame& frame, const Vec3& x, double h) {
  if (!held.drawn || frame.fresh) {
    const Vec3 offset = x - frame.now.position;
    const double seconds = held.drawn ? std::max(kDraw, offset.norm() / kDrawSpeed) : kDraw;
    held.offset = kDraw / seconds * offset;
    held.age = kDraw - seconds;
    held.drawn = true;
  }
  held.age += h;
}

std::optional<Pose> Follow::pose(const std::string& frame) const {
  for (const Frame& f : frames_)
    if (f.name == frame && f.heard) return f.now;
  return std::nullopt;
}

}  // namespace ragdoll
