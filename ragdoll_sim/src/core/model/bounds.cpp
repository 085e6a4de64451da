#include "ragdoll_sim/core/bounds.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

std::string text(const Vec3& v) {
  return "[" + numberText(v.x()) + ", " + numberText(v.y()) + ", " + numberText(v.z()) + "]";
}

}  // namespace

bool isWithinReach(const Vec3& position) { return (position.array().abs() <= kFarthest).all(); }

void checkPosition(const std::string& where, const Vec3& position, const std::string& subject) {
  if (isWithinReach(position)) return;
  throw Error(where, subject + " " + text(position) + " m; numbers from " + numberText(-kFarthest) +
                         " to " + numberText(kFarthest) +
                         " are expected: beyond, they are too coarse for a body");
}

void checkLength(const std::string& where, double length) {
  if (length >= 0 && length <= kFarthest) return;
  throw Error(where, "is " + numberText(length) + " m; a number from 0 to " +
                         numberText(kFarthest) + " is expected");
}

void checkSpeed(const std::string& where, const Vec3& velocity) {
  const double speed = velocity.stableNorm();
  if (speed <= kFastest) return;
  throw Error(where, "makes " + numberText(speed) + " m/s; at most " + numberText(kFastest) +
                         " are possible: numbers cannot follow what is faster");
}

void checkGravity(const std::string& where, const Vec3& gravity, double h) {
  if (gravity.stableNorm() * h <= kFastest) return;
  throw Error(where, "is " + text(gravity) + " m/s^2; at most " + numberText(kFastest / h) +
                         " are possible here, for " + numberText(kFastest) +
                         " m/s in one step: numbers cannot follow what is faster");
}

void checkTolerance(const std::string& where, double tolerance) {
  if (tolerance == 0 || (std::isfinite(tolerance) && tolerance >= kSmallestTolerance)) return;
  const char* reason =
      tolerance > 0 && std::isfinite(tolerance) ? ": numbers are rounded by more than that" : "";
  throw Error(where, "tolerance is " + numberText(tolerance) +
                         "; it must be 0 (a fixed step), or at least " +
                         numberText(kSmallestTolerance) + " m and finite" + reason);
}

void checkThreads(const std::string& where, int threads) {
  if (threads >= 0 && threads <= kMaxThreads) return;
  throw Error(where, "is " + std::to_string(threads) + "; it must be in 0 (all cores) ... " +
                         std::to_string(kMaxThreads));
}

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
