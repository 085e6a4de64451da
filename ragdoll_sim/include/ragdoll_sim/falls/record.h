// Falls simulated, sensed and labelled.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ragdoll_sim/falls/fall.h"
#include "ragdoll_sim/falls/judge.h"

namespace ragdoll::falls {

constexpr std::array<const char*, 4> kSensors = {"low_back", "wrist", "thigh", "head"};

struct Options {
  std::string model = "human";
  double seconds = 5;   ///< [s] of a record
  double rate = 100;    ///< [Hz] of samples
  bool positions = true;
  bool euler = false;   ///< Record::euler
  int threads = 1;      ///< 0: all cores; no effect on what comes out
  std::vector<std::string> settings;  ///< "solver.preset=fast", as --set has them
};

/// One fall, T samples at (k + 1) / rate [s] each. An IMU's sample is the mean over the time before it.
struct Record {
  Fall fall;
  Outcome outcome;
  double onset = 0;       ///< [s] when it begins to fall, a whole number of samples
  double peak_force = 0;  ///< [N] largest of a step: of all contacts together on the body
  double hic15 = 0;       ///< indicator: of the head's acceleration, step by step
  bool at_rest = false;
  std::array<std::vector<float>, kSensors.size()> imu;  ///< T x 6: [m/s^2], [rad/s]
  std::vector<float> positions;  ///< T x n x 3 [m], if wanted
  std::vector<float> euler;      ///< T x 3 [deg] roll, pitch, yaw of low_back, if wanted
};

class Recorder {
 public:
  /// Checks the options. Throws Error.
  explicit Recorder(Options options);

  /// seeds first ... first + count - 1, in their order, on the options' threads.
  std::vector<Record> record(std::uint64_t first, std::uint64_t count) const;

  const Options& options() const { return options_; }
  int samples() const { return samples_; }
  double step() const { return step_; }                               ///< [s]
  const std::vector<std::string>& particles() const { return names_; }  ///< of positions
  const std::string& scene() const { return scene_; }                 ///< text of an example, seed 0

 private:
  /// Falls of one scene.
  void recordGroup(const std::vector<std::uint64_t>& seeds, Record* const* records) const;
  FallScene sceneOf(const Fall& fall, const std::shared_ptr<const SkeletonSpec>& model) const;

  Options options_;
  std::shared_ptr<const SkeletonSpec> model_;
  double step_ = 1.0 / 200;
  int every_ = 2, samples_ = 0;
  std::vector<std::string> names_;
  std::string scene_;
};

}  // namespace ragdoll::falls
