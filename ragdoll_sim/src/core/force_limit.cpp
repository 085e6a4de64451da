#include "ragdoll_sim/core/force_limit.h"

#include <algorithm>
#include <cstdio>

#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

constexpr double kFastest = 1e10;  ///< [m/s] that a step's force may give

}  // namespace

void checkForce(const Model& model, const Poke& poke) {
  const Skeleton& skeleton = model.skeletonOf(model.ragdolls[poke.body.ragdoll]);
  const double size =
      (skeleton.rest.rowwise().maxCoeff() - skeleton.rest.rowwise().minCoeff()).norm();
  const double lever =
      poke.body.particles.size() > 1 && size > 0 ? poke.point.stableNorm() / size : 0;
  const double force = poke.force.stableNorm();
  const double most = kFastest * skeleton.M.sum() / (model.solver.step * (1 + lever));
  if (force <= most) return;
  char text[320];
  std::snprintf(text, sizeof text,
                "[%g, %g, %g] N on '%s' would give it %.3g m/s in one step of %g s; at most %.3g N "
                "here, for %g m/s: numbers cannot follow what is faster",
                poke.force.x(), poke.force.y(), poke.force.z(), poke.body_name.c_str(),
                kFastest * (force / most), model.solver.step, most, kFastest);
  throw Error("force", text);
}

}  // namespace ragdoll
