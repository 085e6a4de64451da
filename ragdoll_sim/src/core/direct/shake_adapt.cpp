#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr int kMaxPieces = 1024;  ///< of one step; as small as substeps get
constexpr double kSafety = 0.9, kLargestGrowth = 4, kSmallestGrowth = 0.2;

}  // namespace

void ShakeStep::adapt(double h) {
  double& next = multipliers()[2 * rows_.s];
  if (!(next > 0)) next = h;
  double left = h;
  int taken = 0;
  while (left > 1e-9 * h) {
    const double sub = left / std::ceil(left / std::min(next, left) - 1e-6);
    const bool least = sub < 1.01 * h / kMaxPieces;
    save();
    failed_ = false;
    if (!smoothMotion(sub)) {
      const double until = failed_ ? 2 * sub : arriveSmoothly(sub);
      if (failed_ || until > sub) {  // contacts and limits that press: the order is theirs
        restore();
        guard(sub);
        next = std::min(2 * sub, h);
      }
      left -= std::min(until, sub);
      ++taken;
      continue;
    }
    moveSmoothly();
    const double rate = rungeKuttaError(rows_, body_.start, vData(), sub, scratch_.stages) / sub;
    if (!(rate < 1e300)) failed_ = true;
    // The estimate is of fourth order, so that its rate falls with the fourth power of the substep.
    const double growth =
        failed_ ? 0.25 : kSafety * std::pow(std::max(rate / model_.solver.tolerance, 1e-12), -0.25);
    if (failed_ && least) {  // not for an explicit method
      restore();
      guard(left);
      break;
    }
    next = sub * std::clamp(growth, kSmallestGrowth, kLargestGrowth);
    if (failed_ || (rate > model_.solver.tolerance && !least)) {
      restore();
      continue;
    }
    report_.unresolved += rate > model_.solver.tolerance;
    left -= sub;
    ++taken;
  }
  report_.substeps = std::max(report_.substeps, taken);
}

}  // namespace ragdoll
