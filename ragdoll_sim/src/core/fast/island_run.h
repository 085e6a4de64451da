// Bodies that touch each other, or one that touches itself, through a step of the fast method.
// docs/fast.md#together. Private to the fast method.
#pragma once

#include <deque>
#include <vector>

#include "core/contact/pair_detect.h"
#include "core/direct/outcome.h"
#include "core/fast/pack_run.h"

namespace ragdoll::fast {

/// What one thread steps islands in.
struct IslandRoom {
  std::deque<PackScratch> packs;  ///< per body; a deque, as what is in use must not move
  std::vector<PackRun> runs;      ///< likewise
  std::vector<Batch> batches;
  std::vector<Partner> partners;
  Roomy<int> all;           ///< ragdolls: the bodies and sleepers, ascending
  Roomy<int> alone;         ///< one of them
  Points predicted, tried;  ///< [m] 3 x N, of their columns: free motions; where they end
  Roomy<double> start;      ///< x and v of each, before parts of the step
  Outcome parts[2];         ///< of a step in parts, in turn
  PairDetector detector;
  Roomy<Contact> found, overlaps;
  Roomy<PairContact> pairs;
  Roomy<char> memory;
};

/// Gives the room its size, for islands of up to kRoomForBodies: no step but the first asks for
/// memory.
void makeRoom(const StepContext& context, const FastScratch& scratch, IslandRoom& room);

/// Moves the bodies by the step, beside sleepers, which stand still, and fills their outcome.
/// False: they are for the direct method, and stay where they are.
bool stepIsland(const StepContext& context, const FastScratch& scratch, IslandRoom& room,
                const std::vector<int>& bodies, const std::vector<int>& sleepers, Outcome& outcome);

}  // namespace ragdoll::fast
