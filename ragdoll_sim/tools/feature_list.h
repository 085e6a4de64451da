// What a scene may ask for, each thing alone on top of the same bare scene: one body with lumped
// masses and free joints that falls and tumbles, with nothing to touch, nothing to draw, and nobody
// listening.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll::lab {

/// What is done beside the steps: every step, or as often as the node publishes.
class Follower {
 public:
  virtual ~Follower() = default;
  virtual void begin(Workspace&) {}  ///< of a run
  virtual void beforeStep(const State&) {}
  virtual void stepped(const State& state) = 0;
  virtual void publish(const State& state) = 0;
};

struct Feature {
  std::string group, name;  ///< "obstacle", "box"
  std::string scene;        ///< YAML but for its solver
  bool limits = false;      ///< else its joints are taken away
  /// nullptr: steps alone.
  std::function<std::unique_ptr<Follower>(const Model&, const State&)> follower;
};

/// The first is the bare scene.
std::vector<Feature> features();

/// Messages, where ROS is; else none.
std::vector<Feature> publishingFeatures();

/// The bare scene's text, for those that do something beside it.
const std::string& bareScene();

}  // namespace ragdoll::lab
