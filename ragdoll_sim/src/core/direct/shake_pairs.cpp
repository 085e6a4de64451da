#include "core/direct/shake_pairs.h"

#include <algorithm>
#include <numeric>

#include "core/direct/shake.h"
#include "core/direct/shake_island.h"
#include "core/step/workspace.h"
#include "ragdoll_sim/core/sleep.h"

namespace ragdoll {
namespace {

constexpr int kRounds = 4;         ///< of islands that grow
constexpr double kMargin = 0.005;  ///< [m]
constexpr double kNear = 1e-3;     ///< [m] bodies that would come nearer make an island

class Together {
 public:
  Together(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws, State& state,
           StepReport& report)
      : model_(model),
        inputs_(inputs),
        h_(h),
        ws_(ws),
        p_(ws.together),
        state_(state),
        report_(report),
        count_(static_cast<int>(model.ragdolls.size())) {}

  void run() {
    save();
    predict();
    for (int round = 0; round < kRounds; ++round) {
      findContacts(round > 0);
      join(round == 0 ? kNear : -ShakeStep::kMissedPair);
      if (!stepIslands()) break;
      if (holdsAll()) break;
    }
    finish();
  }

 private:
  int first(int i) const { return model_.ragdolls[i].first; }
  int size(int i) const { return model_.skeletonOf(model_.ragdolls[i]).size(); }

  int headOf(int i) {
    while (p_.head[i] != i) i = p_.head[i] = p_.head[p_.head[i]];
    return i;
  }

  void save() {
    p_.x0 = state_.x;
    p_.v0 = state_.v;
    p_.multipliers0 = state_.multipliers;
    p_.own.resize(count_);
    p_.head.resize(count_);
    std::iota(p_.head.begin(), p_.head.end(), 0);
    for (ShakePairs::Own& own : p_.own) {
      own.island.clear();
      own.sleepers.clear();
      own.took.clear();
      own.presses.clear();
      own.pressing.clear();
    }
  }

  void restore(int i) {
    state_.x.middleCols(first(i), size(i)) = p_.x0.middleCols(first(i), size(i));
    state_.v.middleCols(first(i), size(i)) = p_.v0.middleCols(first(i), size(i));
    std::copy_n(p_.multipliers0.begin() + ws_.first_stick[i],
                multiplierCount(*model_.systemOf(model_.ragdolls[i]).direct.rows),
                state_.multipliers.begin() + ws_.first_stick[i]);
    ws_.pressed[i] = 0;
  }

  /// Whether it pressed on another body in the last step.
  void markPressing(std::vector<std::uint8_t>& pressing) const {
    pressing.assign(count_, 0);
    for (const Press& press : state_.presses) {
      if (press.other[0] < first(press.ragdoll) + size(press.ragdoll)) continue;
      const auto after = [](int column, const Ragdoll& r) { return column < r.first; };
      const auto other =
          std::upper_bound(model_.ragdolls.begin(), model_.ragdolls.end(), press.other[0], after);
      pressing[press.ragdoll] = pressing[other - model_.ragdolls.begin() - 1] = 1;
    }
  }

  /// Where each would go by itself: its whole step, which may stand, or its free motion, where that
  /// is unlikely.
  void predict() {
    std::vector<std::uint8_t> pressing;
    markPressing(pressing);
    for (int i = 0; i < count_; ++i) {
      if (state_.asleep[i]) continue;
      if (!pressing[i]) {
        stepAlone(i);
        continue;
      }
      StepReport report;
      ShakeStep(model_, ws_, ws_.shake, state_, i, report).predict(inputs_, h_);
    }
  }

  void stepAlone(int i) {
    restore(i);
    ShakePairs::Own& own = p_.own[i];
    ws_.presses.clear();
    own.report = StepReport();
    stepBodyShake(model_, inputs_, h_, ws_, state_, i, own.report);
    own.presses = ws_.presses;
    own.pressing.clear();
    own.island.assign(1, i);
  }

  /// Between where the bodies were and where they are now.
  void findContacts(bool overlaps_only) {
    do {
      p_.found.clear();
      if (!overlaps_only)
        ws_.pairs.appendBetween(model_, state_, p_.x0, state_.x, PairSearch::touches(kMargin),
                                p_.found);
      ws_.pairs.appendBetween(model_, state_, p_.x0, state_.x,
                              PairSearch::overlaps(ShakeStep::kMissedPair), p_.found);
      const std::vector<std::uint8_t> asleep = state_.asleep;
      if (!wakeTouched(p_.found, state_.x, state_)) break;
      for (int i = 0; i < count_; ++i)
        if (asleep[i] && !state_.asleep[i]) stepAlone(i);
    } while (true);
  }

  double gapAt(const Contact& c) const {
    double gap = -c.offset + ShakeStep::overlapLeft(c, h_, h_);
    for (int k = 0; k < 4; ++k) gap += c.weight[k] * c.normal.dot(state_.x.col(c.particle[k]));
    return gap;
  }

  /// Bodies whose gap is below `near` share an island.
  void join(double near) {
    for (const Contact& c : p_.found) {
      if (gapAt(c) > near) continue;
      if (c.moves[0] && c.moves[1]) {
        p_.head[headOf(c.ragdoll)] = headOf(c.other);
        continue;
      }
      std::vector<int>& sleepers = p_.own[c.moves[0] ? c.ragdoll : c.other].sleepers;
      sleepers.push_back(c.moves[0] ? c.other : c.ragdoll);
    }
  }

  /// Steps what has not been stepped with just those bodies; whether there was any.
  bool stepIslands() {
    std::vector<std::vector<int>> bodies(count_), sleepers(count_);
    for (int i = 0; i < count_; ++i) {
      if (state_.asleep[i]) continue;
      const int head = headOf(i);
      bodies[head].push_back(i);
      const std::vector<int>& own = p_.own[i].sleepers;
      sleepers[head].insert(sleepers[head].end(), own.begin(), own.end());
    }
    bool any = false;
    for (int head = 0; head < count_; ++head) {
      if (bodies[head].empty()) continue;
      std::vector<int>& still = sleepers[head];
      std::sort(still.begin(), still.end());
      still.erase(std::unique(still.begin(), still.end()), still.end());
      if (bodies[head].size() == 1 && still.empty()) {
        if (!p_.own[head].island.empty()) continue;
        stepAlone(head);
        any = true;
        continue;
      }
      any = stepIsland(bodies[head], still) || any;
    }
    return any;
  }

  bool stepIsland(const std::vector<int>& bodies, const std::vector<int>& sleepers) {
    ShakePairs::Own& front = p_.own[bodies[0]];
    if (front.island == bodies && front.took == sleepers) return false;
    for (const int i : bodies) {
      restore(i);
      p_.own[i].presses.clear();
      p_.own[i].pressing.clear();
      p_.own[i].report = StepReport();
      p_.own[i].island = bodies;
    }
    front.took = sleepers;
    ws_.presses.clear();
    ShakeIsland island(model_, ws_, p_.island, state_, bodies, sleepers, front.report);
    island.run(inputs_, h_);
    front.presses = ws_.presses;
    front.presses.insert(front.presses.end(), island.presses().begin(), island.presses().end());
    front.pressing = island.pressing();
    return true;
  }

  /// Whether one island has every body, so that nothing is left to meet.
  bool holdsAll() const {
    for (int i = 0; i < count_; ++i)
      if (!state_.asleep[i])
        return static_cast<int>(p_.own[i].island.size() + p_.own[i].took.size()) == count_;
    return true;
  }

  void finish() {
    ws_.presses.clear();
    for (int i = 0; i < count_; ++i) {
      if (state_.asleep[i]) continue;
      const ShakePairs::Own& own = p_.own[i];
      ws_.presses.insert(ws_.presses.end(), own.presses.begin(), own.presses.end());
      ws_.pressing.insert(ws_.pressing.end(), own.pressing.begin(), own.pressing.end());
      report_.contacts += own.report.contacts;
      report_.substeps = std::max(report_.substeps, own.report.substeps);
      report_.guarded += own.report.guarded;
      report_.limited += own.report.limited;
      report_.implicit += own.report.implicit;
      report_.rigid += own.report.rigid;
      report_.joining += own.report.joining;
      report_.unresolved += own.report.unresolved;
    }
  }

  const Model& model_;
  const Inputs& inputs_;
  const double h_;
  Workspace::Impl& ws_;
  ShakePairs& p_;
  State& state_;
  StepReport& report_;
  const int count_;
};

}  // namespace

void stepTogether(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                  State& state, StepReport& report) {
  Together(model, inputs, h, ws, state, report).run();
}

}  // namespace ragdoll
