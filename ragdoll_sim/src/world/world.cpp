#include "ragdoll_sim/world/world.h"

#include <utility>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "world_names.h"

namespace ragdoll {

World::World(Scene scene, std::string source, const std::string& frame_prefix)
    : source_(std::move(source)),
      scene_(std::make_shared<Scene>(std::move(scene))),
      model_(std::make_shared<Model>(buildModel(*scene_))),
      state_(startState(*model_, &energy_taken_)),
      tracker_(*model_, frame_prefix),
      start_pins_(model_->pins) {
  for (const ObstacleSpec& o : scene_->obstacles) checkForeign(o.where + ": frame", o.frame);
  for (const PinSpec& p : scene_->pins) checkForeign(p.where + ": frame", p.frame);
  checkSensorNames(*model_, tracker_);
  setPokes(model_->pokes);
  follow_.restart(*model_, state_);
  restart();
}

void World::advance() {
  for (std::size_t i = 0; i < clearings_.size();) {
    if (clearings_[i].step != state_.step) {
      ++i;
      continue;
    }
    clear(clearings_[i].order);
    clearings_.erase(clearings_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  gatherPokes();
  followFrames();
  // Each once between two looks: when it begins, or in the first step after a look.
  const double h = stepLength();
  for (const Poke& poke : inputs_.pokes)
    if (isActive(poke, state_.time, h) && (acted_taken_ || !isActive(poke, state_.time - h, h)))
      acted_.push_back(poke);
  acted_taken_ = false;
  addPulls();
  workspace_.keepContacts(contacts_ ? &contacts_->log() : nullptr);
  if (contacts_) contacts_->begin(state_);
  report_ = step(*model_, inputs_, workspace_, state_);
  if (contacts_) contacts_->end(*model_, inputs_, state_);
  if (state_.step % steps_per_follow_ == 0) {
    tracker_.update(state_);
    followed_step_ = state_.step;
  }
  if (imus_) imus_->update(*model_, state_, imu_samples_);
  ++revision_;
}

void World::followFrames() {
  const auto due = glides_.find(state_.step);
  if (due != glides_.end()) {
    for (const Glide& glide : due->second) follow_.repeat(glide, *model_, state_);
    glides_.erase(due);
  }
  for (Glide& glide : follow_.takeChanges()) {
    for (Glide::Particle& p : glide.held) p.name = particleName(*model_, p.particle);
    followed_.push_back({state_.step, run_, ++followed_count_, std::move(glide)});
  }
  follow_.apply(*model_, stepLength(), state_, inputs_);
}

void World::checkForeign(const std::string& where, const std::string& frame) const {
  if (hasFrame(!frame.empty() && frame[0] == '/' ? frame.substr(1) : frame))
    throw Error(where, "'" + frame + "' is one of the ragdolls' own; it must be another node's");
}

bool World::hasFrame(const std::string& name) const {
  for (int i = 0; i < tracker_.size(); ++i)
    if (tracker_.name(i) == name) return true;
  return false;
}

std::vector<std::string> World::frameNames() const {
  std::vector<std::string> names;
  for (int i = 0; i < tracker_.size(); ++i) names.push_back(tracker_.name(i));
  return names;
}

std::optional<Pose> World::frame(const std::string& name) const {
  for (int i = 0; i < tracker_.size(); ++i) {
    if (tracker_.name(i) != name) continue;
    if (followed_step_ == state_.step) return tracker_.now().frames[i];
    FrameTracker present = tracker_;
    present.update(state_);
    return present.now().frames[i];
  }
  return std::nullopt;
}

std::vector<FollowedFrame> World::takeFollowed() { return std::exchange(followed_, {}); }

void World::keepContacts(bool keep) {
  contacts_.reset();
  if (keep) contacts_.emplace(*model_);
}

std::optional<ContactReport> World::takeContacts() {
  if (!contacts_) return std::nullopt;
  return contacts_->take();
}

std::vector<ImuSample> World::takeImuSamples() { return std::exchange(imu_samples_, {}); }

}  // namespace ragdoll
