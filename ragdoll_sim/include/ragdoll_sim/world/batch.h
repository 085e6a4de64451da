// Scenes of one body each that differ in the body, its start and its pokes alone, as one model: what
// the fast method takes in packs. Bodies of a batch do not see each other, and the bits of each are
// those that it has alone. Knows nothing of threads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

/// Scenes with the same key can share a batch; empty: this one has to be alone, since it has more
/// than one body, pins, or frames of others.
std::string batchKey(const Scene& scene);

class Batch {
 public:
  /// One scene, or several with the same key. Bodies with the same skeleton (the same pointer) share
  /// packs. Throws Error.
  explicit Batch(const std::vector<Scene>& scenes);

  void advance();  ///< one step
  void reset();    ///< back to the start

  /// Lets go of all pins, as World::detach of each of them.
  void letGo();

  /// Begins at poke.start, or now if that is past; whole steps. Throws Error.
  void addPoke(Poke poke);
  void clearPokes();  ///< those that act and those to come

  int size() const { return static_cast<int>(members_.size()); }  ///< scenes
  /// Ragdolls of a scene: first ... first + count - 1.
  int firstRagdoll(int scene) const { return members_[scene]; }
  int ragdolls(int scene) const;
  int firstColumn(int scene) const;  ///< of the state
  int columns(int scene) const;

  /// The body of a scene by its name there. Throws Error that lists the names.
  BodyRef find(int scene, const std::string& body) const;
  Points positions(int scene) const;            ///< [m] 3 x n of the particles that have names
  Points velocities(int scene) const;           ///< [m/s] likewise
  std::vector<std::string> names(int scene) const;  ///< of them, as CSV files name them
  std::uint64_t hash(int scene) const;          ///< as hash(State) of the scene alone

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const StepReport& report() const { return report_; }  ///< of the last step
  double time() const;                                  ///< [s] steps times step length

 private:
  Points named(int scene, const Points& of) const;

  Model model_;
  State state_;
  Inputs inputs_;
  Workspace workspace_;
  StepReport report_;
  std::vector<int> members_;                ///< per scene: its first ragdoll
  std::vector<std::string> ragdoll_names_;  ///< in their own scenes
};

/// Names of the particles that a user sees, all ragdolls in turn: those of the first as they are,
/// others with "<ragdoll>/" before them.
std::vector<std::string> particleNames(const Model& model);

}  // namespace ragdoll
