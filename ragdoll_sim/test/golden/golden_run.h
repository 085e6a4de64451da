// A run of the golden list: what it left, step by step, as a few numbers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll::golden {

/// The StepReport's fields, summed over a run; in this order.
constexpr const char* kSums[] = {"contacts", "substeps", "guarded", "limited",
                                 "implicit", "rigid",    "joining", "unresolved"};
constexpr int kSumCount = sizeof kSums / sizeof kSums[0];

struct Outcome {
  std::uint64_t state = 0;   ///< hash() of the last state: positions and velocities
  std::uint64_t memory = 0;  ///< of everything in State after every step
  std::uint64_t steps = 0;
  std::array<std::uint64_t, kSumCount> sums{};

  bool operator==(const Outcome& other) const {
    return state == other.state && memory == other.memory && steps == other.steps &&
           sums == other.sums;
  }
};

/// A world that steps and adds up what it sees. A script changes inputs (and, by its own
/// functions, pins) between steps.
class Run {
 public:
  explicit Run(const Scene& scene);

  void step();
  Outcome outcome() const;

  /// As attach and detach do: only these particles ("ben/head") are held, where they are now.
  void hold(const std::vector<std::string>& particles);
  void setGravity(const Vec3& gravity);
  void poke(const std::string& body, double duration, const Vec3& force,
            const Vec3& point = Vec3::Zero());  ///< from now on

  Model model;
  State state;
  Inputs inputs;

 private:
  Workspace workspace_;
  Outcome outcome_;
};

}  // namespace ragdoll::golden
