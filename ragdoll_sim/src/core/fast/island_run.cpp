#include "core/fast/island_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/fast/constants.h"

namespace ragdoll::fast {
namespace {

void growTo(std::size_t bodies, IslandRoom& room) {
  while (room.packs.size() < bodies) room.packs.emplace_back();
  if (room.batches.size() < bodies) room.batches.resize(bodies);
  room.runs.clear();
  room.runs.reserve(bodies);
}

class IslandRun {
 public:
  /// last: impulses of the part of the step before; null: those of the state.
  IslandRun(const StepContext& context, const FastScratch& scratch, IslandRoom& room,
            const std::vector<int>& bodies, double h, int left,
            const std::vector<CachedImpulse>* last)
      : context_(context),
        model_(context.model),
        state_(context.state),
        scratch_(scratch),
        room_(room),
        bodies_(bodies) {
    task_.h = h;
    task_.left = left;
    task_.order = bodies.data();
    task_.last = last;
    task_.together = true;
  }

  bool run(Outcome& outcome) {
    predict();
    if (!findPairs()) return false;
    finish();
    if (!holds()) return false;
    accept(outcome);
    return true;
  }

 private:
  /// A pack of its own for each; where all would go by themselves, and the obstacles there.
  void predict() {
    const std::size_t count = bodies_.size();
    growTo(count, room_);
    for (Points* poses : {&room_.predicted, &room_.tried}) {
      poses->resize(3, model_.size());
      for (const int i : room_.all) columnsOf(i, *poses) = columnsOf(i, state_.x);
    }
    for (std::size_t k = 0; k < count; ++k) {
      Batch& batch = room_.batches[k];
      clear(batch);
      batch.system = model_.ragdolls[bodies_[k]].system;
      batch.begin = static_cast<int>(k);
      batch.count = 1;
      room_.runs.emplace_back(context_, task_, scratch_, room_.predicted, room_.tried,
                              room_.packs[k], batch);
      room_.runs[k].predict();
      room_.runs[k].endSearch();
    }
  }

  Points::ColsBlockXpr columnsOf(int ragdoll, Points& of) const {
    const Ragdoll& r = model_.ragdolls[ragdoll];
    return of.middleCols(r.first, model_.skeletonOf(r).size());
  }

  int placeOf(int ragdoll) const {
    const auto at = std::lower_bound(bodies_.begin(), bodies_.end(), ragdoll);
    return at == bodies_.end() || *at != ragdoll ? -1 : static_cast<int>(at - bodies_.begin());
  }

  void search(const Points& to, PairSearch search, Roomy<Contact>& found) {
    found.clear();
    if (room_.all.size() > 1)
      room_.detector.appendBetween(model_, state_, room_.all, state_.x, to, search, found);
    if (!model_.self_collision) return;
    for (const int i : bodies_) room_.detector.appendSelf(model_, state_.x, to, i, search, found);
  }

  /// False: one of them is no stick of a body's tree.
  bool findPairs() {
    margin_ = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      margin_ = std::max(margin_, room_.runs[k].searchMargin(0));
    search(room_.predicted, PairSearch::touches(margin_), room_.found);
    room_.pairs.clear();
    for (std::size_t k = 0; k < room_.found.size(); ++k)
      if (!addPair(static_cast<int>(k))) return false;
    return true;
  }

  bool addPair(int index) {
    const Contact& c = room_.found[index];
    PairContact pair;
    for (int side = 0; side < 2; ++side) {
      const int ragdoll = side == 0 || c.other < 0 ? c.ragdoll : c.other;
      pair.body[side] = placeOf(ragdoll);
      if (pair.body[side] < 0) continue;
      const int a = c.particle[2 * side] - model_.ragdolls[ragdoll].first,
                b = c.particle[2 * side + 1] - model_.ragdolls[ragdoll].first;
      pair.feature[side] = room_.runs[pair.body[side]].featureOf(a, a == b ? -1 : b);
      if (pair.feature[side] < 0) return false;
      pair.weight[side] = std::abs(c.weight[2 * side + 1]);
    }
    for (int k = 0; k < 3; ++k) pair.normal[k] = c.normal[k];
    pair.gap = c.gapAt(state_.x);
    pair.reach = pair.gap + c.offset;
    pair.friction = c.friction;
    if (const CachedImpulse* last = lastOf(index))
      for (int k = 0; k < 3; ++k) pair.impulse[k] = last->impulse[k] / kKept;
    room_.pairs.push_back(pair);
    return true;
  }

  static CachedImpulse keyOf(const Contact& c) {
    CachedImpulse key;
    key.ragdoll = c.ragdoll;
    key.a = c.particle[0];
    key.b = c.particle[1];
    key.other = {c.particle[2], c.particle[3]};
    return key;
  }

  /// What the same two sticks pressed with in the last step, their contacts in turn; null: nothing.
  const CachedImpulse* lastOf(int index) const {
    const CachedImpulse key = keyOf(room_.found[index]);
    const auto same = [&key](const CachedImpulse& q) {
      return q.obstacle < 0 && q.a == key.a && q.b == key.b && q.other == key.other;
    };
    int nth = 0;
    for (int k = index; k-- > 0 && same(keyOf(room_.found[k]));) ++nth;
    if (task_.last) {
      for (const CachedImpulse& last : *task_.last)
        if (last.ragdoll == key.ragdoll && same(last) && nth-- == 0) return &last;
      return nullptr;
    }
    const int end = scratch_.first_impulse[key.ragdoll + 1];
    for (int k = scratch_.first_impulse[key.ragdoll]; k < end; ++k) {
      const CachedImpulse& last = state_.impulses[scratch_.cached[k]];
      if (same(last) && nth-- == 0) return &last;
    }
    return nullptr;
  }

  void finish() {
    room_.partners.clear();
    for (PackRun& run : room_.runs)
      room_.partners.push_back({&run.body(), &run.firstLane(), run.memory()});
    const PackMethod& method = room_.runs[0].method();
    const int count = static_cast<int>(room_.partners.size());
    const int pairs = static_cast<int>(room_.pairs.size());
    room_.memory.resize(method.partners_memory(count, pairs) + 64);
    const auto address = reinterpret_cast<std::uintptr_t>(room_.memory.data());
    void* const aligned = room_.memory.data() + (63 - (address + 63) % 64);
    method.finish_together(room_.runs[0].step(),
                           {room_.partners.data(), count, room_.pairs.data(), pairs, aligned});
  }

  /// Whether all came through.
  bool holds() {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Lane& lane = room_.runs[k].firstLane();
      if (!lane.good || (lane.deep && room_.runs[k].sinks(0))) return false;
    }
    if (!wentAstray()) return true;
    search(room_.tried, PairSearch::overlaps(kOfPart.particle), room_.overlaps);
    return std::none_of(room_.overlaps.begin(), room_.overlaps.end(), [this](const Contact& c) {
      return c.gapAt(room_.tried) < c.gap_start - kDeeper * kOfPart.particle;
    });
  }

  /// Whether some went so far from where they would have gone that they may have met what was not
  /// looked for.
  bool wentAstray() {
    return std::any_of(bodies_.begin(), bodies_.end(), [this](int i) {
      return (columnsOf(i, room_.tried) - columnsOf(i, room_.predicted)).cwiseAbs().maxCoeff() >
             0.5 * margin_;
    });
  }

  void accept(Outcome& outcome) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      room_.runs[k].accept(0);
      const Batch& batch = room_.batches[k];
      append(batch.impulses, outcome.impulses);
      outcome.report.contacts += batch.contacts;
      outcome.report.limited += static_cast<int>(batch.limited.size());
    }
    for (std::size_t k = 0; k < room_.pairs.size(); ++k) {
      const PairContact& pair = room_.pairs[k];
      CachedImpulse impulse = keyOf(room_.found[k]);
      impulse.impulse = kKept * Vec3(pair.impulse[0], pair.impulse[1], pair.impulse[2]);
      if (impulse.impulse == Vec3::Zero()) continue;
      outcome.impulses.push_back(impulse);
      ++outcome.report.contacts;
      if (room_.found[k].other >= 0)
        outcome.pressing.push_back({impulse.ragdoll, room_.found[k].other, pair.holds});
    }
  }

  const StepContext& context_;
  const Model& model_;
  State& state_;
  const FastScratch& scratch_;
  IslandRoom& room_;
  const std::vector<int>& bodies_;  ///< ascending
  PackTask task_;
  double margin_ = 0;  ///< [m] what is as near may touch
};

/// The step in parts, after each of which the bodies are where it has led; or back at the start.
bool stepInParts(const StepContext& context, const FastScratch& scratch, IslandRoom& room,
                 const std::vector<int>& bodies, Outcome& outcome) {
  Roomy<double>& start = room.start;
  start.clear();
  const auto forAll = [&](const auto& to) {
    for (const int i : bodies) {
      const Ragdoll& r = context.model.ragdolls[i];
      const int n = 3 * context.model.skeletonOf(r).size();
      to(context.state.x.data() + 3 * r.first, n);
      to(context.state.v.data() + 3 * r.first, n);
    }
  };
  forAll([&start](const double* values, int n) { start.insert(start.end(), values, values + n); });
  const std::vector<CachedImpulse>* last = nullptr;
  for (int part = 0; part < kParts; ++part) {
    Outcome& own = room.parts[part % 2];
    own.clear();
    IslandRun run(context, scratch, room, bodies, context.h / kParts, kParts - part, last);
    if (!run.run(own)) {
      auto from = start.begin();
      forAll([&from](double* values, int n) {
        std::copy_n(std::exchange(from, from + n), n, values);
      });
      outcome.clear();
      return false;
    }
    last = &own.impulses;
    addPart(own.impulses, -1, 1.0 / kParts, part + 1 == kParts, outcome.impulses);
  }
  Outcome& end = room.parts[(kParts - 1) % 2];
  outcome.report = end.report;
  append(end.pressing, outcome.pressing);
  return true;
}

}  // namespace

void makeRoom(const StepContext& context, const FastScratch& scratch, IslandRoom& room) {
  const std::size_t count = std::min<std::size_t>(kRoomForBodies, context.model.ragdolls.size());
  growTo(count, room);
  room.alone.clear();
  for (std::size_t k = 0; k < count; ++k) room.alone.push_back(static_cast<int>(k));
  PackTask task;
  task.h = context.h;
  task.order = room.alone.data();
  task.together = true;
  std::size_t bytes = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Batch& batch = room.batches[k];
    batch.system = context.model.ragdolls[k].system;
    batch.begin = static_cast<int>(k);
    batch.count = 1;
    if (!scratch.bodies[batch.system].why_not.empty()) continue;
    PackRun run(context, task, scratch, room.predicted, room.tried, room.packs[k], batch);
    run.prepare();
    bytes = run.method().partners_memory(kRoomForBodies, kRoomForRows) + 64;
  }
  const State& state = context.state;
  room.detector.appendBetween(context.model, state, room.alone, state.x, state.x,
                              PairSearch::touches(kMargin), room.found);
  room.memory.reserve(bytes);
  room.partners.reserve(count);
  room.start.reserve(6 * static_cast<std::size_t>(context.model.size()));
}

bool stepIsland(const StepContext& context, const FastScratch& scratch, IslandRoom& room,
                const std::vector<int>& bodies, const std::vector<int>& sleepers,
                Outcome& outcome) {
  for (const int i : bodies)
    if (!scratch.bodies[context.model.ragdolls[i].system].why_not.empty()) return false;
  room.all.assign(bodies.begin(), bodies.end());
  append(sleepers, room.all);
  std::sort(room.all.begin(), room.all.end());
  return IslandRun(context, scratch, room, bodies, context.h, 1, nullptr).run(outcome) ||
         (!isDriven(scratch) && stepInParts(context, scratch, room, bodies, outcome));
}

}  // namespace ragdoll::fast
