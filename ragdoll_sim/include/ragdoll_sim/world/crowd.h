// Scenes of any mix that step together, on several threads: those that differ in bodies and pokes
// alone go in batches (batch.h). The bits of each are those that it has alone, whatever the threads.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "ragdoll_sim/world/batch.h"

namespace ragdoll {

class Crowd {
 public:
  /// threads: 0: all cores. All scenes have the same length of step. Throws Error.
  explicit Crowd(std::vector<Scene> scenes, int threads = 1);

  void step(std::uint64_t steps);
  void reset();

  int size() const { return static_cast<int>(places_.size()); }
  /// The batch of a scene and its number there.
  Batch& batch(int scene) { return *batches_[places_[scene].batch]; }
  const Batch& batch(int scene) const { return *batches_[places_[scene].batch]; }
  int member(int scene) const { return places_[scene].member; }
  int batches() const { return static_cast<int>(batches_.size()); }
  int threads() const { return threads_; }

 private:
  struct Place {
    int batch = 0, member = 0;
  };
  std::vector<std::unique_ptr<Batch>> batches_;
  std::vector<Place> places_;
  int threads_ = 1;
};

/// task(0) ... task(parts - 1) on so many threads, 0: all cores; the caller's is one of them. The
/// first exception that a task throws comes through when all threads have ended.
void inParallel(int threads, int parts, const std::function<void(int)>& task);

}  // namespace ragdoll
