#include "core/direct/step_island.h"

#include <algorithm>

#include "core/direct/angular_momentum.h"
#include "core/direct/begin_step.h"
#include "core/direct/constants.h"
#include "core/direct/driving.h"
#include "core/direct/energy.h"
#include "core/direct/smooth_motion.h"
#include "core/direct/stability.h"
#include "core/direct/trial.h"

namespace ragdoll {
namespace {

using Way = SubstepControl::Way;

/// What is to become of a trial.
struct Verdict {
  bool accepted = false;
  double gain = 0;  ///< [J] to be taken out
};

/// Whether anything pressed in the trial.
bool presses(const Island& island) {
  return std::any_of(island.bodies.begin(), island.bodies.end(),
                     [](const Body* body) { return !body->cache.empty(); });
}

/// What the guard takes of a gain [J]: not what a solution leaves.
double worthTaking(Island& island, double gain) {
  return gain > 0 && gain > kLeastGain * swingScale(island) ? gain : 0;
}

/// rk from event to event has no swing, and its pieces are as short as they must be: what it gains
/// is its error.
Verdict judgeExact(Island& island, double took, const SubstepControl& control) {
  const double gain = gainedEnergy(island, took, driveSpeed(island));
  if (control.canHalve() && gain > kRedoGain * swingScale(island)) return {false, 0};
  return {true, worthTaking(island, gain)};
}

Verdict judgeExplicit(Island& island, const Trial& trial, const SubstepControl& control) {
  if (trial.exact) return judgeExact(island, trial.took, control);
  const bool smooth = isSmooth(island);
  const auto any = [&](const auto& is) {
    return std::any_of(island.bodies.begin(), island.bodies.end(),
                       [&](Body* body) { return is(*body); });
  };
  const double h = control.substep(), took = trial.took;
  // Limits that press may have led to another solution than the one sought.
  const bool steady =
      smooth && !presses(island) && !any([&](Body& body) { return swings(body, took); });
  const double gain = steady ? 0 : gainedEnergy(island, took, smooth ? 0 : driveSpeed(island));
  const bool large = isLargeGain(island, gain, smooth);
  if (control.canHalve() && (large || any([&](Body& body) { return exceedsStable(body, h, 2); })))
    return {false, 0};
  if (control.canHalveTwice() && any([&](Body& body) { return tensionJumped(body, took); }))
    return {false, 0};
  // What leapfrog's energy swings by comes back; not so what limits that press have given it.
  const bool comes_back = smooth && !(large && presses(island));
  return {true, comes_back ? 0 : worthTaking(island, gain)};
}

Verdict judgeImplicit(Island& island, double took) {
  const double gain = gainedEnergy(island, took, driveSpeed(island));
  // Another solution than the one sought: not to be taken out.
  return {!(gain > wildGain(island)), std::max(0.0, gain)};
}

/// Whether a trial may stand, and what it gained.
Verdict judge(Island& island, const Trial& trial, const SubstepControl& control) {
  if (!trial.ok) return {false, 0};
  if (control.way() == Way::kExplicit) return judgeExplicit(island, trial, control);
  if (control.way() == Way::kImplicit) return judgeImplicit(island, trial.took);
  return {true, 0};
}

/// Whether what a trial of that way lost of its angular momentum is given back. The last resort
/// gives none back: what it would gain by that is not taken out. rk from event to event loses none,
/// and may have met what was outside and has left again.
bool losesAngularMomentum(const Island& island, const Trial& trial, Way way) {
  return way == Way::kImplicit || (way == Way::kExplicit && !trial.exact && pressesItself(island));
}

/// The next trial begins where so much [s] of the step is left.
void setTime(Island& island, double left) {
  for (Body* body : island.bodies) body->time = island.context.h - left;
}

/// Explicit steps as they come, to measure what the guard costs.
void stepUnguarded(Island& island) {
  double left = island.context.h;
  while (left > kNothingLeft * island.context.h) {
    save(island);
    setTime(island, left);
    left -= takeExplicitTrial(island, left).took;
  }
}

}  // namespace

bool takeSubsteps(Island& island, double h, StepReport& report) {
  SubstepControl control(island, h);
  while (!control.done()) {
    save(island);
    setTime(island, control.left());
    const Trial trial = takeTrial(island, control, report);
    if (trial.ok && trial.turn > 0) {
      restore(island);
      for (Body* body : island.bodies) ++body->located;
      control.cut(trial.turn);
      continue;
    }
    if (trial.ok && losesAngularMomentum(island, trial, control.way()))
      restoreAngularMomentum(island, trial.took);
    const Verdict verdict = judge(island, trial, control);
    if (!verdict.accepted || !removeEnergy(island, verdict.gain, trial.took)) {
      restore(island);
      control.retry();
      continue;
    }
    if (verdict.gain > 0)
      for (Body* body : island.bodies) restorePins(*body, body->saved.v);
    control.accept(trial.took, trial.limited || verdict.gain > 0);
    report.contacts += trial.contacts;
    island.s.defect += trial.defect;
    if (trial.handed_over) report.handed_over += static_cast<int>(island.bodies.size());
  }
  control.tell(report);
  if (control.guarded() || control.limited())
    for (Body* body : island.bodies) makeAffine(*body);  // rigid velocities carry what is off it
  return control.limited();
}

bool stepThroughEvents(Island& island, double& error, StepReport& report) {
  const double h = island.context.h;
  beginStep(island, report);
  save(island);
  setTime(island, h);
  const SmoothTrial trial = moveTogether(island, h);
  if (!trial.exact) return false;
  const double gain = gainedEnergy(island, h, driveSpeed(island));
  if (gain > kRedoGain * swingScale(island)) return false;
  if (!removeEnergy(island, worthTaking(island, gain), h)) return false;
  error = trial.error;
  report.contacts += trial.contacts;
  report.substeps = 1;
  return true;
}

void stepIsland(Island& island, StepReport& report) {
  beginStep(island, report);
  if (!island.context.guarded)
    stepUnguarded(island);
  else
    takeSubsteps(island, island.context.h, report);
}

}  // namespace ragdoll
