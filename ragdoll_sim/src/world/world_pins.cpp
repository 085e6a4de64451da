// What a world holds: pins that come, go and have names.
#include "ragdoll_sim/world/world.h"

#include <algorithm>
#include <utility>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/sleep.h"
#include "world_names.h"

namespace ragdoll {

void World::attach(const std::string& body, const std::string& frame) {
  const BodyRef ref = findParticle(*model_, body);
  if (frame.empty()) throw Error("frame", "must name a TF frame");
  checkForeign("frame", frame);
  std::vector<Pin> pins = model_->pins;
  const int p = ref.particles[0];
  pins.erase(
      std::remove_if(pins.begin(), pins.end(), [&](const Pin& q) { return q.particle == p; }),
      pins.end());
  pins.push_back({ref.ragdoll, p, state_.x.col(p), frame});
  endRun();
  changePins(pins);
  beginRun(false);
}

void World::detach(const std::string& body) {
  const int p = findParticle(*model_, body).particles[0];
  std::vector<Pin> pins;
  std::vector<std::string> held;
  for (const Pin& pin : model_->pins) {
    if (pin.particle != p) pins.push_back(pin);
    held.push_back(particleName(*model_, pin.particle));
  }
  if (pins.size() == model_->pins.size())
    throw Error("", "'" + body + "' is not held; " +
                        (held.empty() ? "nothing is" : "held are " + joined(held)));
  endRun();
  changePins(pins);
  beginRun(false);
}

void World::changePins(const std::vector<Pin>& pins) {
  auto model = std::make_shared<Model>(*model_);
  setPins(*model, pins);
  model_ = std::move(model);
  energy_taken_ = settlePins(*model_, state_);
  state_.multipliers.clear();  // those were of the sticks that could move
  wakeAll(state_);
  workspace_ = Workspace();
  if (contacts_) contacts_->restart(*model_);
  inputs_.pins.clear();
  inputs_.obstacles.clear();
  follow_.setPins(*model_);
}

std::vector<std::string> World::pinNames() const {
  std::vector<std::string> names;
  for (const Pin& pin : model_->pins) {
    const bool scenes = std::any_of(start_pins_.begin(), start_pins_.end(), [&](const Pin& other) {
      return other.particle == pin.particle && other.frame == pin.frame;
    });
    std::string name = particleName(*model_, pin.particle);
    const std::size_t slash = name.find('/');
    if (pin.ragdoll == 0)
      name = name.substr(slash + 1);
    else
      name[slash] = '_';
    names.push_back((scenes ? "pin_" : "attach_") + name);
  }
  return names;
}

}  // namespace ragdoll
