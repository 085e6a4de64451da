// Bodies that touch each other, taken through a step as one. A lone body is an island of one.
//
// Every stage is taken by all bodies in turn; contacts between them are rows beside each body's own
// contacts and limits (joint_schur.h), so that everything that presses is solved for at once. They
// share the substeps. Sleepers that they touch stand still.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/growing.h"
#include "core/contact/pair_detect.h"
#include "core/direct/body.h"
#include "core/direct/mode.h"
#include "core/linear/joint_schur.h"
#include "core/mechanics/energy_removal.h"

namespace ragdoll {

/// The contacts between the bodies of an island.
struct PairSet : ContactSet {
  TouchingContacts touching;  ///< at the motion's end
  ImpulseCache cache, saved;  ///< saved: before the present substep
  Roomy<BodyPair> pressing;   ///< in the last motion
  Roomy<BodyPair> met;        ///< in an impact of the step
  Roomy<BodyPair> pushed;     ///< by a row of any stage since the bodies were saved

  /// No contacts; nothing pressed yet.
  void clear() {
    contacts.clear();
    touching.clear();
    cache.clear();
    pressing.clear();
    met.clear();
    pushed.clear();
  }
};

/// How bodies turn, each as one with all that press on each other, nothing outside on them; else
/// not at all. Slip between and within bodies is measured against it (angular_momentum.h).
struct CommonTurns {
  Roomy<Vec3, kRoomForBodies> turn;  ///< [rad] of the motion, or [rad/s]; of each body
  Roomy<int, kRoomForBodies> first;  ///< of each body: place of the first of those it turns with
  int pressing = 0;                  ///< in motions: what counted as pressing; -1: nothing rubs

  /// Whether some do.
  bool any() const {
    return std::any_of(turn.begin(), turn.end(), [](const Vec3& t) { return !t.isZero(0); });
  }
};

/// Memory of islands, as large as the largest.
struct IslandScratch {
  std::vector<std::vector<Body>> places;  ///< by skeleton, so that buffers keep their sizes
  Roomy<Body*> bodies;                    ///< awake, ascending
  Roomy<int> all;  ///< ragdolls: the bodies, and sleepers near them, ascending
  PairSet pairs;
  PairDetector detector;
  JointSchur joint;
  Mode mode;  ///< of rk, while something touches
  RemovalScratch removal;
  RowValues total;  ///< [kg m] what the position stage's rows have pressed with in the motion
  // Room for what a stage works with; from one function to the next it goes by argument.
  RowValues b, p;  ///< of all rows: gaps or rates; impulses, to begin with and found
  RowValues change, start;
  Roomy<double> energies;  ///< [J] of each body
  Roomy<double> loads;     ///< [N] of the rows of a mode
  RowValues rates;         ///< [m/s] where contacts are logged: before the velocity stage
  CommonTurns turns;
  std::size_t logged = 0;  ///< entries of the contact log before the present substep
  double defect = 0;       ///< [m] of the motions of a part of a step that stood, together
  std::vector<RowValues> parts;
  Roomy<int> ragdolls;     ///< of the bodies
  std::vector<int> place;  ///< of each ragdoll among them; of others: anything
  std::vector<int> used;   ///< places of each skeleton
  Roomy<int> group;        ///< of each body: those that pressed on each other
  Roomy<Body*> grouped;    ///< the bodies of a group
  Roomy<int> drained;      ///< ragdolls that energy is taken out of
};

struct Island {
  const StepContext& context;
  IslandScratch& s;
  std::vector<Body*>& bodies;
  PairSet& pairs;

  Island(const StepContext& step, IslandScratch& scratch)
      : context(step), s(scratch), bodies(scratch.bodies), pairs(scratch.pairs) {}

  /// One body that has nothing to do with others: all that it is treated by alone is rk without
  /// events (one trajectory), leave to give up an overlap with obstacles (others would be left in
  /// between), no substeps while it is squeezed, and a rigid motion as the last resort, before
  /// which an island is taken apart.
  bool isLone() const { return s.all.size() == 1; }
  /// Whether no overlap is given up: what presses there from both sides contradicts itself.
  bool opensOverlaps() const;
  /// Place of a ragdoll among the bodies; -1: it does not move.
  int placeOf(int ragdoll) const {
    if (ragdoll < 0) return -1;
    const int place = s.place[ragdoll], count = static_cast<int>(s.ragdolls.size());
    return place < count && s.ragdolls[place] == ragdoll ? place : -1;
  }
};

/// Poses (3 x N) of sleepers near the island <- where they are; others may move at the same time.
void placeSleepers(const Island& island, Points& poses);

/// Room for an island of up to kRoomForBodies of the model's bodies; larger ones grow as they come.
void makeRoom(const Model& model, IslandScratch& scratch);

/// Places for `bodies` are there afterwards, and none is taken: room for them all, as those that
/// are bound must not move.
void makePlaces(const Model& model, const std::vector<int>& bodies, IslandScratch& scratch);
/// A place that is not taken yet.
Body& takePlace(const Model& model, int ragdoll, IslandScratch& scratch);

/// Binds the island's places to bodies (awake, ascending); others: sleepers near them.
void bindIsland(Island& island, const std::vector<int>& bodies, const std::vector<int>& others);
/// Binds an island to a body that is a place of another one.
void bindLone(Island& island, Body& body);

/// What changes in a trial; and back to it. Impulses of a rejected trial are forgotten.
void save(Island& island);
void restore(Island& island);

}  // namespace ragdoll
