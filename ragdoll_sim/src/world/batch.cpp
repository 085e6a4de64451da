#include "ragdoll_sim/world/batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/sleep.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

/// A body's name without its ragdoll's.
std::string withoutRagdoll(const std::string& body) {
  const std::size_t slash = body.find('/');
  return slash == std::string::npos ? body : body.substr(slash + 1);
}

/// What several one-body scenes are together.
Scene merged(const std::vector<Scene>& scenes) {
  Scene all = scenes.front();
  all.ragdolls.clear();
  all.pins.clear();
  all.pokes.clear();
  all.sensors.clear();
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene& scene = scenes[i];
    RagdollSpec ragdoll = scene.ragdolls.front();
    const std::string prefix = "b" + std::to_string(i);
    for (PokeSpec poke : scene.pokes) {
      const std::size_t slash = poke.body.find('/');
      if (slash != std::string::npos && poke.body.substr(0, slash) != ragdoll.name)
        throw Error(poke.where, "body '" + poke.body + "' is of no ragdoll; there is " + ragdoll.name);
      poke.body = prefix + "/" + withoutRagdoll(poke.body);
      all.pokes.push_back(std::move(poke));
    }
    for (PinSpec pin : scene.pins) {
      pin.particle = prefix + "/" + withoutRagdoll(pin.particle);
      all.pins.push_back(std::move(pin));
    }
    for (SensorSpec sensor : scene.sensors) {
      sensor.segment = prefix + "/" + withoutRagdoll(sensor.segment);
      all.sensors.push_back(std::move(sensor));
    }
    ragdoll.name = prefix;
    all.ragdolls.push_back(std::move(ragdoll));
  }
  return all;
}

void sortPokes(const Model& model, std::vector<Poke>& pokes) {
  std::stable_sort(pokes.begin(), pokes.end(), [h = model.solver.step](const Poke& a, const Poke& b) {
    return actsBefore(a, b, h);
  });
}

}  // namespace

std::string batchKey(const Scene& scene) {
  if (scene.ragdolls.size() != 1 || scene.ragdolls[0].count > 0 || !scene.pins.empty()) return "";
  if (scene.ragdolls[0].compliant) return "";  // another method would take the others, too
  for (const ObstacleSpec& o : scene.obstacles)
    if (!o.frame.empty()) return "";
  Scene bare = scene;
  bare.ragdolls.clear();
  bare.pokes.clear();
  return toYaml(bare);
}

Batch::Batch(const std::vector<Scene>& scenes) {
  if (scenes.empty()) throw Error("scenes", "there is none; at least one is expected");
  model_ = buildModel(scenes.size() == 1 ? scenes.front() : merged(scenes));
  if (scenes.size() == 1) {
    members_ = {0};
    for (const Ragdoll& r : model_.ragdolls) ragdoll_names_.push_back(r.name);
  } else {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      members_.push_back(static_cast<int>(i));
      ragdoll_names_.push_back(scenes[i].ragdolls.front().name);
    }
  }
  reset();
}

void Batch::reset() {
  state_ = startState(model_);
  inputs_ = startInputs(model_);
  sortPokes(model_, inputs_.pokes);
  workspace_ = Workspace();
  report_ = StepReport();
}

void Batch::advance() { report_ = step(model_, inputs_, workspace_, state_); }

void Batch::letGo() {
  for (const Pin& pin : model_.pins) state_.v.col(pin.particle).setZero();
  setPins(model_, {});
  settlePins(model_, state_);
  // Multipliers belong to the sticks that can move, and those are others now.
  state_.multipliers = startState(model_).multipliers;
  wakeAll(state_);
  workspace_ = Workspace();
}

void Batch::addPoke(Poke poke) {
  checkForce(model_, poke);
  const double h = model_.solver.step;
  const double wait = std::max(0.0, std::round((poke.start - state_.time) / h));
  poke.start = state_.time + wait * h;
  const auto over = [&](const Poke& p) {
    return p.duration >= 0 && p.start + std::max(h, p.duration) < state_.time - h;
  };
  inputs_.pokes.erase(std::remove_if(inputs_.pokes.begin(), inputs_.pokes.end(), over),
                      inputs_.pokes.end());
  inputs_.pokes.push_back(std::move(poke));
  sortPokes(model_, inputs_.pokes);
}

void Batch::clearPokes() { inputs_.pokes.clear(); }

int Batch::ragdolls(int scene) const {
  const int next = scene + 1 < size() ? members_[scene + 1] : static_cast<int>(model_.ragdolls.size());
  return next - members_[scene];
}

int Batch::firstColumn(int scene) const { return model_.ragdolls[members_[scene]].first; }

int Batch::columns(int scene) const {
  return (scene + 1 < size() ? firstColumn(scene + 1) : model_.size()) - firstColumn(scene);
}

BodyRef Batch::find(int scene, const std::string& body) const {
  if (size() == 1) return findBody(model_, body);
  const std::string& own = ragdoll_names_[members_[scene]];
  const std::size_t slash = body.find('/');
  if (slash != std::string::npos && body.substr(0, slash) != own)
    throw Error("", "there is no ragdoll '" + body.substr(0, slash) + "'; there is " + own);
  return findBody(model_, model_.ragdolls[members_[scene]].name + "/" + withoutRagdoll(body));
}

Points Batch::named(int scene, const Points& of) const {
  Points all(3, 0);
  for (int i = members_[scene]; i < members_[scene] + ragdolls(scene); ++i) {
    const Ragdoll& r = model_.ragdolls[i];
    const int n = model_.skeletonOf(r).named;
    all.conservativeResize(3, all.cols() + n);
    all.rightCols(n) = of.middleCols(r.first, n);
  }
  return all;
}

Points Batch::positions(int scene) const { return named(scene, state_.x); }
Points Batch::velocities(int scene) const { return named(scene, state_.v); }

std::vector<std::string> Batch::names(int scene) const {
  std::vector<std::string> all;
  for (int i = members_[scene]; i < members_[scene] + ragdolls(scene); ++i) {
    const Skeleton& s = model_.skeletonOf(model_.ragdolls[i]);
    const std::string prefix = i == members_[scene] ? "" : ragdoll_names_[i] + "/";
    for (int p = 0; p < s.named; ++p) all.push_back(prefix + s.particles[p]);
  }
  return all;
}

std::uint64_t Batch::hash(int scene) const {
  State own;
  own.x = state_.x.middleCols(firstColumn(scene), columns(scene));
  own.v = state_.v.middleCols(firstColumn(scene), columns(scene));
  return ragdoll::hash(own);
}

double Batch::time() const { return static_cast<double>(state_.step) * model_.solver.step; }

std::vector<std::string> particleNames(const Model& model) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    const Skeleton& s = model.skeletonOf(model.ragdolls[i]);
    const std::string prefix = i == 0 ? "" : model.ragdolls[i].name + "/";
    for (int p = 0; p < s.named; ++p) all.push_back(prefix + s.particles[p]);
  }
  return all;
}

}  // namespace ragdoll
