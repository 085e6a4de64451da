#include "core/direct/saved_motion.h"

#include <algorithm>

#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

const StickRows& stickRowsOf(const Model& model, const Ragdoll& ragdoll) {
  return *model.systemOf(ragdoll).direct.rows;
}

}  // namespace

void makeRoom(const StickRows& rows, SavedMotion& saved) {
  saved.x.resize(3, rows.n);
  saved.v.resize(3, rows.n);
  saved.multipliers.resize(multiplierCount(rows));
}

void makeRoom(const Model& model, std::vector<SavedMotion>& saved) {
  if (saved.size() == model.ragdolls.size()) return;
  saved.resize(model.ragdolls.size());
  for (std::size_t i = 0; i < saved.size(); ++i)
    makeRoom(stickRowsOf(model, model.ragdolls[i]), saved[i]);
}

void save(const StepContext& step, int ragdoll, SavedMotion& saved) {
  const Ragdoll& r = step.model.ragdolls[ragdoll];
  const StickRows& rows = stickRowsOf(step.model, r);
  saved.x = step.state.x.middleCols(r.first, rows.n);
  saved.v = step.state.v.middleCols(r.first, rows.n);
  const auto first = step.state.multipliers.begin() + step.ws.first_multiplier[ragdoll];
  saved.multipliers.assign(first, first + multiplierCount(rows));
}

void restore(const StepContext& step, int ragdoll, const SavedMotion& saved) {
  const int first = step.model.ragdolls[ragdoll].first;
  step.state.x.middleCols(first, saved.x.cols()) = saved.x;
  step.state.v.middleCols(first, saved.v.cols()) = saved.v;
  std::copy(saved.multipliers.begin(), saved.multipliers.end(),
            step.state.multipliers.begin() + step.ws.first_multiplier[ragdoll]);
}

}  // namespace ragdoll
