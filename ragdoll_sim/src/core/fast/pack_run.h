// One pack of bodies through a step, or a part of one. Private to the fast method.
#pragma once

#include <vector>

#include "core/fast/dispatch.h"
#include "core/fast/fast.h"

namespace ragdoll::fast {

/// What a pack's bodies take.
struct PackTask {
  double h = 0;  ///< [s]
  int left = 1;  ///< parts like this one, it too, until the step's end
  StepBounds bounds = kOfPart;
  const PartTask* parts = nullptr;                   ///< of each of `order`; null: all as above
  const int* order = nullptr;                        ///< ragdolls, of which the batch has some
  const std::vector<CachedImpulse>* last = nullptr;  ///< of the part before; null: the state's
  bool together = false;  ///< its one body takes the step with others (island_run.h)
};

/// Of a force, in the state: what the direct methods keep, whose position stage gives it over half
/// a step. So a body that goes from one to the other starts with what pressed.
constexpr double kKept = 0.5;

class PackRun {
 public:
  /// predicted, tried: [m] 3 x N, of which it uses its bodies' columns; may be the same.
  PackRun(const StepContext& context, const PackTask& task, const FastScratch& scratch,
          Points& predicted, Points& tried, PackScratch& pack, Batch& batch);

  /// Moves its bodies by the step, but for those that it leaves.
  void run();

  // The parts of that, for a pack of one body that takes the step with others (island_run.h).
  void prepare();
  void predict();
  void endSearch();
  Lane& firstLane() { return lanes_[0]; }
  PackStep& step() { return step_; }
  void* memory() { return pack_.memory.data(); }
  const FastBody& body() const { return body_; }
  const PackMethod& method() const { return method_; }
  int featureOf(int a, int b) const;
  /// [m] What is as near may touch: as the packs' own.
  double searchMargin(int l) const;
  /// Whether something is deep in an obstacle that no row has kept out; the body is at `tried`.
  bool sinks(int l) const;
  /// The body is where it has gone on trial; its impulses.
  void accept(int l);

 private:
  int ragdollOf(int l) const { return task_.order[batch_.begin + l]; }
  void setStep();
  void fill(int l);
  void setTime(int l);
  void takeImpulse(const CachedImpulse& last, double share, const Ragdoll& r, Lane& lane) const;
  void endSearch(int l);
  void addContact(const Contact& c, int first, Lane& lane) const;
  void sortContacts(Lane& lane);
  Bounds boundsOf(const Skeleton& s, int first, int a, int b) const;
  bool particlesSink(const Ragdoll& r, const StepBounds& bounds, const SweptObstacle& m) const;
  bool sticksSink(const Ragdoll& r, const StepBounds& bounds, const SweptObstacle& m) const;
  bool touchesItself(int index);
  void keep(int l);

  const Model& model_;
  const Inputs& inputs_;
  PackTask task_;
  const Points* force_;
  const FastScratch& scratch_;
  PackScratch& pack_;
  Points &predicted_, &tried_;
  State& state_;
  Supports& supports_;
  Batch& batch_;
  const FastBody& body_;
  const PackMethod& method_;
  PackStep step_;
  Lane lanes_[kMaxLanes];
  int room_ = 0, contact_room_ = 0;
};

void clear(Batch& batch);

/// Adds a ragdoll's (-1: all) impulses of a part of a step, of which it is a share: contacts press
/// with their mean, limits as at its end, in the last part.
void addPart(const std::vector<CachedImpulse>& part, int ragdoll, double share, bool last,
             std::vector<CachedImpulse>& all);

/// Whether an obstacle moves: what happens in parts of a step is known of none.
inline bool isDriven(const FastScratch& scratch) {
  return scratch.driven || !scratch.moving_planes.empty();
}

/// Whether bodies that a pack has left are stepped in parts.
bool stepsInParts(const StepContext& context, const FastScratch& scratch);

/// Moves the bodies of a batch by the step, but for those that it leaves.
void stepPack(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
              Batch& batch);

/// The same in parts of the step, of a batch of FastScratch::again (part_run.cpp).
void stepParts(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
               Batch& batch);

}  // namespace ragdoll::fast
