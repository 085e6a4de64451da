// Copies of the world and of how it is doing, for other threads.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/core/histogram.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/events.h"
#include "ragdoll_sim/world/imu.h"

namespace ragdoll {

/// What the simulation has done so far; differences of two give rates.
struct Progress {
  std::uint64_t steps = 0;
  double simulated = 0;  ///< [s] never goes back
  double stepping = 0;   ///< [s] wall time spent in steps
  double lost = 0;       ///< [s] of the clock to follow that it was too slow for
  std::uint64_t guarded = 0, implicit = 0, rigid = 0, joining = 0, limited = 0,
                unresolved = 0;  ///< as in StepReport, ragdolls in turn
};

/// One moment of the world, copied for other threads.
struct Snapshot {
  std::string source;  ///< of the scene, as World has it
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Model> model;
  State state;
  std::optional<FrameTracker> tracker;
  StepReport report;
  std::vector<Poke> acted;                      ///< since the last snapshot
  std::vector<Event> events;                    ///< since the last snapshot
  std::vector<FollowedFrame> followed;          ///< since the last snapshot
  std::vector<ImuSample> imu;                   ///< that ended since the last snapshot
  std::optional<ContactReport> contacts;        ///< since the last snapshot, if they are kept
  std::vector<std::string> pin_names;           ///< World::pinNames
  std::vector<std::optional<Pose>> pin_frames;  ///< of each pin that follows one, where it is
  std::vector<Pull> pulls;
  std::uint64_t revision = 0;
  RunMark mark;
  std::shared_ptr<const Bytes> beginning;  ///< of the run
  bool paused = false;
  bool waiting = false;                 ///< the clock to follow has told no time yet
  std::optional<double> clock_silence;  ///< [s] of wall time since the clock to follow has ticked
  double realtime_factor = 1;           ///< that is wanted; -1: free
  Progress progress;
  Histogram lateness;  ///< [s] how late steps began, over the last one to two minutes
  /// Where a viewer is between the tracker's last two updates, in [0, 1]; nothing: look at `state`.
  std::optional<double> alpha;
};

}  // namespace ragdoll
