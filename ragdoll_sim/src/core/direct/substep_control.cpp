#include "core/direct/substep_control.h"

#include <algorithm>
#include <cmath>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/stability.h"

namespace ragdoll {
namespace {

/// Substeps that keep all bodies' h Omega below kStable; also not a number.
double wantedSubsteps(Island& island, double h) {
  double wanted = 1;
  for (Body* body : island.bodies) {
    const double own = isSoft(*body, h) ? 1 : std::ceil(h * std::sqrt(stiffness(*body)) / kStable);
    if (std::isnan(own)) return own;
    wanted = std::max(wanted, own);
  }
  return wanted;
}

bool isDriven(const Island& island) {
  return std::any_of(island.bodies.begin(), island.bodies.end(),
                     [](const Body* body) { return body->driven; });
}

}  // namespace

SubstepControl::SubstepControl(Island& island, double h)
    : island_(island), h_(h), substep_(h), left_(h) {
  const double wanted = wantedSubsteps(island, h);
  if (!island.context.relaxed && wanted <= kMaxSubsteps) {
    substep_ = h / wanted;
  } else {
    way_ = Way::kImplicit;
    guarded_ = true;
  }
}

bool SubstepControl::done() const { return !(left_ > kNothingLeft * h_); }

bool SubstepControl::isSqueezed() const {
  return island_.isLone() && ragdoll::isSqueezed(*island_.bodies[0]);
}

int SubstepControl::most() const {
  if (isSqueezed()) return 1;
  return isDriven(island_) ? kMaxDriven : kMaxSubsteps;
}

bool SubstepControl::isTooShort(double substep, int pieces) const {
  return substep < (1 - kAbout) * h_ / pieces;
}

bool SubstepControl::canHalve() const {
  return substep_ > (1 + kAbout) * h_ / (isSqueezed() ? 1 : kMaxSubsteps);
}

bool SubstepControl::canHalveTwice() const { return !isTooShort(0.5 * substep_, most()); }

void SubstepControl::accept(double took, bool limited) {
  limited_ = limited_ || limited;
  left_ -= took;
  ++taken_;
  cut_ = 0;
  substep_ = std::min(substep_, left_);
}

void SubstepControl::goTo(Way way) {
  way_ = way;
  guarded_ = true;
  substep_ = left_;
}

bool SubstepControl::ignoreMore() {
  Body& body = *island_.bodies[0];
  if (!island_.isLone()) return false;
  if (body.overlaps < OverlapPolicy::kIgnoreAll && body.constraints.overlap >= kTouching)
    body.overlaps = OverlapPolicy::kIgnoreAll;
  else if (body.overlaps == OverlapPolicy::kIgnoreAll && body.pin_speed > 0)
    body.overlaps = OverlapPolicy::kFilter;
  else
    return false;
  return true;
}

void SubstepControl::retry() {
  cut_ = 0;
  Body& body = *island_.bodies[0];
  if (island_.isLone() && hasNoWayOut(body)) {
    body.overlaps = OverlapPolicy::kIgnoreDeep;
    substep_ = left_;
    return;
  }
  if (way_ == Way::kExplicit) {
    substep_ *= 0.5;
    if (isTooShort(substep_, most())) goTo(Way::kImplicit);
    return;
  }
  substep_ *= kImplicitRetry;
  const int pieces = most() == kMaxSubsteps ? kMaxImplicitSubsteps : most();
  if (!isTooShort(substep_, pieces)) return;
  if (ignoreMore())
    substep_ = left_;
  else
    goTo(island_.isLone() ? Way::kRigid : Way::kAlone);
}

void SubstepControl::tell(StepReport& report) const {
  int located = 0;
  bool ignored = false;
  for (const Body* body : island_.bodies) {
    located = std::max(located, body->located);
    ignored = ignored || body->overlaps != OverlapPolicy::kResolve;
  }
  const int size = static_cast<int>(island_.bodies.size());
  report.substeps = std::max(report.substeps, taken_);
  if (guarded_ || ignored || taken_ > 1 + located) report.guarded += size;
  if (limited_) report.limited += size;
  report.unresolved += ignored;
}

}  // namespace ragdoll
