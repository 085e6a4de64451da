#include "core/direct/island_builder.h"

#include <algorithm>
#include <numeric>

#include "core/contact/constants.h"
#include "core/direct/constants.h"
#include "core/direct/direct_step.h"
#include "core/direct/mode_constants.h"
#include "core/direct/motion.h"
#include "core/direct/penetration.h"
#include "core/direct/workspace.h"
#include "ragdoll_sim/core/sleep.h"

namespace ragdoll {
namespace {

int sizeOf(const Model& model, int ragdoll) {
  return model.skeletonOf(model.ragdolls[ragdoll]).size();
}

/// Which bodies pressed on another one in the last step.
void markPressedPairs(const StepContext& step, std::vector<std::uint8_t>& marked) {
  const std::vector<Ragdoll>& ragdolls = step.model.ragdolls;
  marked.assign(ragdolls.size(), 0);
  for (const CachedImpulse& impulse : step.state.impulses) {
    if (impulse.other[0] < ragdolls[impulse.ragdoll].first + sizeOf(step.model, impulse.ragdoll))
      continue;
    const auto after = [](int column, const Ragdoll& r) { return column < r.first; };
    const auto other = std::upper_bound(ragdolls.begin(), ragdolls.end(), impulse.other[0], after);
    marked[impulse.ragdoll] = marked[other - ragdolls.begin() - 1] = 1;
  }
}

/// [m] A spring that overlapped at the start pressed, wherever the bodies would have gone.
double gapLeft(const StepContext& step, const Contact& c, const Points& x) {
  const double gap = c.gapAt(x);
  return c.isSoft() ? std::min(gap, c.gap_start) : gap + allowedPenetration(c, step.h, step.h);
}

/// [m] What may overlap by less was pushed together by an island: it touches.
double overlapOf(const StepContext& step, const Stepper* stepper) {
  if (stepper) return stepper->overlap();
  return step.events ? kClosedGap : step.tolerances.touching;
}
/// [m] Bodies that go from event to event are one island when they come near, as what lies between
/// their ends is looked at by none else.
double nearOf(const StepContext& step) { return step.events ? kNearBody : kClose; }

/// Positions <- where the body would go but for what holds it together.
void fall(const StepContext& context, const SavedMotion& start, int i) {
  const double h = context.h;
  context.state.x.middleCols(context.model.ragdolls[i].first, sizeOf(context.model, i)) =
      (start.x + h * start.v).colwise() + 0.5 * h * h * context.model.gravity;
}

}  // namespace

void IslandBuilder::step(const StepContext& context, StepReport& report, Stepper* stepper) {
  stepper_ = stepper;
  begin(context);
  predict(context);
  double near = nearOf(context);
  do {  // each time islands are fewer and larger, or sleepers awake
    findContacts(context);
    unite(near);
    near = -overlapOf(context, stepper_);
  } while (stepIslands(context) && !holdsAll(context.state));
  end(context, report);
}

int IslandBuilder::root(int i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void IslandBuilder::begin(const StepContext& context) {
  const std::size_t count = context.model.ragdolls.size();
  start_x_ = context.state.x;
  makeRoom(context.model, start_);
  for (std::size_t i = 0; i < count; ++i) save(context, static_cast<int>(i), start_[i]);
  parent_.resize(count);
  std::iota(parent_.begin(), parent_.end(), 0);
  outcomes_.resize(count);
  for (std::vector<int>* list : {&parts_, &left_}) list->reserve(count);
  for (IslandOutcome& outcome : outcomes_) {
    outcome.clear();
    outcome.island.clear();
    outcome.near_sleepers.clear();
    outcome.sleepers.clear();
    outcome.direct = false;
  }
  turns_ = 0;
}

void IslandBuilder::reset(const StepContext& context, int i) {
  restore(context, i, start_[i]);
  context.supports.pressed[i] = context.supports.gripped[i] = 0;
  outcomes_[i].clear();
}

/// Where each would go by itself: its whole step, which may stand, or its free motion, where that
/// is unlikely.
void IslandBuilder::predict(const StepContext& context) {
  markPressedPairs(context, pressed_pair_);
  parts_.clear();
  left_.clear();
  for (std::size_t i = 0; i < outcomes_.size(); ++i) {
    if (context.state.asleep[i]) continue;
    const int ragdoll = static_cast<int>(i);
    takeTurn(ragdoll);
    if (stepper_ && pressed_pair_[i])
      fall(context, start_[i], ragdoll);
    else
      (stepper_ ? left_ : parts_).push_back(ragdoll);
  }
  if (stepper_) {
    outcome_of_.clear();
    for (IslandOutcome& outcome : outcomes_) outcome_of_.push_back(&outcome);
    stepper_->stepApart(context, left_, outcome_of_, parts_);
    for (const int i : left_) outcomes_[i].island.assign(1, i);
    for (const int i : parts_) outcomes_[i].island.clear();
  }
  forEachPart(context, static_cast<int>(parts_.size()), [this](StepContext& own, int k) {
    if (pressed_pair_[parts_[k]])
      predictFreely(own, parts_[k]);
    else
      stepAlone(own, parts_[k]);
  });
}

void IslandBuilder::stepAlone(StepContext& context, int i) {
  reset(context, i);
  IslandOutcome& outcome = outcomes_[i];
  outcome.island.assign(1, i);
  std::vector<int>& alone = scratchOf(context).lone_body;
  alone.assign(1, i);
  stepBy(context, alone, no_sleepers_, outcome);
}

void IslandBuilder::stepBy(StepContext& context, const std::vector<int>& bodies,
                           const std::vector<int>& sleepers, IslandOutcome& front) {
  const bool direct = !stepper_ || !stepper_->stepTogether(context, bodies, sleepers, front);
  for (const int i : bodies) outcomes_[i].direct = direct;
  if (!direct) return;
  if (context.log) context.log = &front.log;
  stepBodies(context, bodies, sleepers, front.impulses, front.pressing, front.report);
}

void IslandBuilder::findContacts(const StepContext& context) {
  root_of_.resize(outcomes_.size());
  for (std::size_t i = 0; i < root_of_.size(); ++i) root_of_[i] = root(static_cast<int>(i));
  State& state = context.state;
  do {
    contacts_.clear();
    gaps_.clear();
    woken_.clear();
    search(context, start_x_, state.x);
    if (stepper_ || !findLegs(context)) continue;
    search(context, start_x_, first_leg_);
    search(context, last_leg_, state.x);
  } while (stepWoken(context));
}

bool IslandBuilder::findLegs(const StepContext& context) {
  const State& state = context.state;
  first_leg_ = state.x;
  last_leg_ = start_x_;
  bool any = false;
  for (std::size_t i = 0; i < outcomes_.size(); ++i) {
    if (state.asleep[i]) continue;
    const int first = context.model.ragdolls[i].first;
    const int n = sizeOf(context.model, static_cast<int>(i));
    const auto x = state.x.middleCols(first, n), v = state.v.middleCols(first, n);
    auto leg = first_leg_.middleCols(first, n);
    leg = start_[i].x + context.h * start_[i].v;
    const bool bends = (leg - x).cwiseAbs().maxCoeff() > kClose;
    if (bends)
      last_leg_.middleCols(first, n) = x - context.h * v;
    else
      leg = x;
    any = any || bends;
  }
  return any;
}

void IslandBuilder::search(const StepContext& context, const Points& from, const Points& to) {
  State& state = context.state;
  found_.clear();
  detector_.appendBetween(context.model, state, from, to, PairSearch::touches(kNearBody), found_,
                          &root_of_);
  if (&to == &state.x && !stepper_)
    detector_.appendBetween(context.model, state, from, to,
                            PairSearch::overlaps(overlapOf(context, stepper_)), found_, &root_of_);
  for (const Contact& c : found_) gaps_.push_back(gapLeft(context, c, to));
  append(found_, contacts_);
  was_asleep_ = state.asleep;
  wakeTouched(found_, to, state);
  for (std::size_t i = 0; i < outcomes_.size(); ++i)
    if (was_asleep_[i] && !state.asleep[i]) woken_.push_back(static_cast<int>(i));
}

bool IslandBuilder::stepWoken(const StepContext& context) {
  for (const int i : woken_) takeTurn(i);
  forEachPart(context, static_cast<int>(woken_.size()),
              [this](StepContext& own, int k) { stepAlone(own, woken_[k]); });
  return !woken_.empty();
}

void IslandBuilder::unite(double near) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = contacts_[k];
    if (gaps_[k] > near) continue;
    if (c.moves[0] && c.moves[1]) {
      parent_[root(c.ragdoll)] = root(c.other);
      continue;
    }
    outcomes_[c.moves[0] ? c.ragdoll : c.other].near_sleepers.push_back(c.moves[0] ? c.other
                                                                                   : c.ragdoll);
  }
}

bool IslandBuilder::stepIslands(const StepContext& context) {
  const int count = static_cast<int>(outcomes_.size());
  members_.resize(count);
  sleepers_.resize(count);
  for (int i = 0; i < count; ++i) {
    members_[i].clear();
    sleepers_[i].clear();
  }
  for (int i = 0; i < count; ++i) {
    if (context.state.asleep[i]) continue;
    const int r = root(i);
    members_[r].push_back(i);
    append(outcomes_[i].near_sleepers, sleepers_[r]);
  }
  parts_.clear();
  for (int r = 0; r < count; ++r) {
    if (members_[r].empty()) continue;
    std::vector<int>& still = sleepers_[r];
    std::sort(still.begin(), still.end());
    still.erase(std::unique(still.begin(), still.end()), still.end());
    if (!isNew(members_[r], still)) continue;
    parts_.push_back(r);
    takeTurn(members_[r][0]);
  }
  forEachPart(context, static_cast<int>(parts_.size()), [this](StepContext& own, int k) {
    stepTogether(own, members_[parts_[k]], sleepers_[parts_[k]]);
  });
  return !parts_.empty();
}

bool IslandBuilder::isNew(const std::vector<int>& bodies, const std::vector<int>& sleepers) const {
  const IslandOutcome& front = outcomes_[bodies[0]];
  if (bodies.size() == 1 && sleepers.empty()) return front.island.empty();
  return front.island != bodies || front.sleepers != sleepers;
}

void IslandBuilder::stepTogether(StepContext& context, const std::vector<int>& bodies,
                                 const std::vector<int>& sleepers) {
  if (bodies.size() == 1 && sleepers.empty()) return stepAlone(context, bodies[0]);
  IslandOutcome& front = outcomes_[bodies[0]];
  for (const int i : bodies) {
    reset(context, i);
    outcomes_[i].island = bodies;
  }
  front.sleepers = sleepers;
  stepBy(context, bodies, sleepers, front);
}

bool IslandBuilder::holdsAll(const State& state) const {
  for (std::size_t i = 0; i < outcomes_.size(); ++i)
    if (!state.asleep[i])
      return outcomes_[i].island.size() + outcomes_[i].sleepers.size() == outcomes_.size();
  return true;
}

void IslandBuilder::mergeLogs(ContactLog& log) {
  order_.resize(outcomes_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::sort(order_.begin(), order_.end(),
            [this](int a, int b) { return outcomes_[a].turn < outcomes_[b].turn; });
  for (const int i : order_) append(outcomes_[i].log.impulses, log.impulses);
}

void IslandBuilder::end(const StepContext& context, StepReport& report) {
  context.ws.impulses.clear();
  for (std::size_t i = 0; i < outcomes_.size(); ++i) {
    if (context.state.asleep[i]) continue;
    const IslandOutcome& outcome = outcomes_[i];
    append(outcome.impulses, context.ws.impulses);
    append(outcome.pressing, context.supports.pressing);
    report += outcome.report;
  }
  if (context.log) mergeLogs(*context.log);
}

}  // namespace ragdoll
