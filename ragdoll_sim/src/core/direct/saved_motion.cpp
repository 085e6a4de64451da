#include "core/direct/saved_motion.h"

#include <algorithm>

#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

/// From and to a state and what is saved of it.
template <class From, class To>
void copyRagdoll(const StepContext& step, int ragdoll, const From& from, To& to) {
  const Ragdoll& r = step.model.ragdolls[ragdoll];
  const StickRows& rows = *step.model.systemOf(r).direct.rows;
  to.x.middleCols(r.first, rows.n) = from.x.middleCols(r.first, rows.n);
  to.v.middleCols(r.first, rows.n) = from.v.middleCols(r.first, rows.n);
  const int multiplier = step.ws.first_multiplier[ragdoll];
  std::copy_n(from.multipliers.begin() + multiplier, multiplierCount(rows),
              to.multipliers.begin() + multiplier);
}

}  // namespace

void makeRoom(const State& state, SavedMotion& saved) {
  saved.x.resize(3, state.x.cols());
  saved.v.resize(3, state.x.cols());
  saved.multipliers.resize(state.multipliers.size());
}

void save(const StepContext& step, int ragdoll, SavedMotion& saved) {
  copyRagdoll(step, ragdoll, step.state, saved);
}

void restore(const StepContext& step, int ragdoll, const SavedMotion& saved) {
  copyRagdoll(step, ragdoll, saved, step.state);
}

}  // namespace ragdoll
