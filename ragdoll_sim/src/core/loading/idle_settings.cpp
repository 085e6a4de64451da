#include "core/loading/idle_settings.h"

#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/trees.h"

namespace ragdoll {
namespace {

/// Why packs take no body of the scene; empty: they take some.
std::string whyNoPacks(const Model& model) {
  if (model.compliant) return "with contact that gives way it leaves all bodies to shake";
  return "";
}

}  // namespace

void warnOfIdleSettings(Model& model) {
  const SolverSpec& solver = model.solver;
  const auto warn = [&](const std::string& key, const std::string& why) {
    model.warnings.push_back(solver.where + "." + key + ": " + why);
  };
  const bool keeps = solver.method == Method::kShake || solver.method == Method::kRk;
  if (solver.tolerance > 0 && !keeps)
    warn("tolerance", "is " + numberText(solver.tolerance) +
                          ", which only the methods shake and rk keep to; steps are fixed");
  if (solver.events && solver.method != Method::kRk)
    warn("events", "is true, which only the method rk follows");
  if (solver.method != Method::kFast) return;
  if (const std::string why = whyNoPacks(model); !why.empty())
    return warn("method", "is fast; " + why);
  for (const TreeFinding& finding : findTrees(model))
    if (!finding.why_not.empty())
      warn("method", "is fast, which leaves this to shake: " + describe(finding));
}

}  // namespace ragdoll
