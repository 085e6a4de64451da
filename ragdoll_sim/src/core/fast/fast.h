// Fast method: one linearised solve a step, with fixed work, for packs of bodies at a time.
//
// A body is a tree in tangent coordinates (linear/tree.h); contacts and limits are rows in them,
// pressed by a fixed number of projected Gauss-Seidel sweeps [Moreau1988] between a fixed number of
// Newton iterations. Nothing is located in time and no step is made again: what does not fit (no
// tree, a body that turns too far in a step) takes that step by shake (direct/direct_step.h) and is
// counted. Bodies that touch each other go side by side (island_run.h). The bits of a body do not
// depend on which bodies share its pack, on the pack's width, or on the number of threads.
// docs/fast.md.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/growing.h"
#include "core/contact/detect.h"
#include "core/contact/pair_detect.h"
#include "core/direct/body.h"
#include "core/fast/body.h"
#include "core/fast/border.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

namespace fast {

/// Bodies of one system that are stepped together, and what came of it.
struct Batch {
  int system = 0;
  int begin = 0, count = 0;  ///< of FastScratch::order, or `again`
  Roomy<CachedImpulse> impulses;
  Roomy<int> left;     ///< ragdolls for the direct method
  Roomy<double> hits;  ///< of these: Lane::hit
  Roomy<int> limited;  ///< ragdolls whose energy was limited
  int contacts = 0;
};

struct IslandRoom;

/// The part of a step that a body takes next.
struct PartTask {
  int ragdoll = 0;
  double done = 0, share = 1;  ///< of the step: before it, and it
  double last = 1;             ///< share of the part before
  StepBounds bounds = kOfPart;
  bool even = false;     ///< the step goes on in kParts
  bool strikes = false;  ///< the part after this one has an impact
  int found = 0;         ///< impacts whose time was found
};

/// What one pack is prepared in.
struct PackScratch {
  std::vector<char> memory;
  std::vector<double> spare;  ///< positions and velocities of lanes without a body
  Roomy<double> limit_impulses;
  Roomy<LaneImpulse> impulses;
  Roomy<LaneContact> contacts;
  Roomy<LeftOver> left_over;
  Roomy<int> slots;  ///< per feature: used ones
  Roomy<Contact> found;
  PairDetector detector;
  Points predicted;           ///< [m] 3 x N: where free motions lead; of the pack's bodies only
  Batch part;                 ///< of a step in parts
  Roomy<int> again, moving;   ///< ragdolls that are stepped in parts; that came through so far
  Roomy<PartTask> parts;      ///< of those that move
  Roomy<CachedImpulse> last;  ///< what they pressed with in the part before
  std::vector<double> start;  ///< x and v of these before: 6 n each
};

}  // namespace fast

/// Kept from step to step: bodies of each system, room.
struct FastScratch {
  std::vector<fast::FastBody> bodies;                  ///< per system
  std::vector<int> order;                              ///< awake ragdolls, system by system
  std::vector<std::pair<std::uint32_t, int>> pressed;  ///< of a system: links that did, ragdoll
  std::vector<fast::Batch> batches;
  std::vector<int> again;  ///< ragdolls that packs have left and are stepped in parts, likewise
  std::vector<double> again_hits;  ///< of these: Lane::hit
  std::vector<fast::Batch> again_batches;
  int batch_count = 0, again_count = 0;  ///< of these that are in use
  std::vector<SweptObstacle> obstacles;  ///< but planes
  std::vector<fast::Solid> solids;       ///< the same
  std::vector<SweptObstacle> moving_planes;
  std::vector<fast::StillPlane> planes;
  std::vector<int> first_impulse;        ///< per ragdoll and one more: into `cached`
  std::vector<int> cached;               ///< of State::impulses, ragdoll by ragdoll
  bool driven = false;                   ///< an obstacle moves
  std::vector<fast::PackScratch> packs;  ///< per thread
  std::vector<std::shared_ptr<fast::IslandRoom>> islands;  ///< likewise
  std::vector<int> left;                                   ///< ragdolls for the direct method
  bool packed = false;  ///< the others were in packs; else none was
  int most_lanes = 0;   ///< of a pack; 0: as many as the processor has. For tests.
};

/// Moves x and v of all awake ragdolls by the step, as stepDirect.
void stepFast(const StepContext& context, FastScratch& scratch, StepReport& report);

}  // namespace ragdoll
