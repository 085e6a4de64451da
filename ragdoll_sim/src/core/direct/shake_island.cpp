#include "core/direct/shake_island.h"

#include <algorithm>
#include <cmath>

#include "core/mechanics/pair_energy.h"

namespace ragdoll {
namespace {

constexpr int kMaxPieces = 64;          ///< of implicit steps; beyond, each body by itself
constexpr double kReportedRise = 1e-6;  ///< [J] less is rounding

}  // namespace

ShakeIsland::ShakeIsland(const Model& model, Workspace::Impl& ws, IslandScratch& scratch,
                         State& state, const std::vector<int>& bodies,
                         const std::vector<int>& others, StepReport& report)
    : model_(model), ws_(ws), s_(scratch), state_(state), report_(report), bodies_(bodies) {
  std::merge(bodies.begin(), bodies.end(), others.begin(), others.end(), std::back_inserter(all_));
  if (s_.bodies.size() < bodies.size()) s_.bodies.resize(bodies.size());
  steps_.reserve(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k)
    steps_.emplace_back(model, ws, s_.bodies[k], state, bodies[k], report);
}

void ShakeIsland::run(const Inputs& inputs, double h) {
  for (ShakeStep& step : steps_) step.begin(inputs, h);
  s_.known.clear();
  s_.pressing.clear();
  for (const Press& press : state_.presses) {
    const Ragdoll& r = model_.ragdolls[press.ragdoll];
    if (press.other[0] >= r.first + model_.skeletonOf(r).size() && slotOf(press.ragdoll) >= 0)
      s_.known.push_back(press);
  }
  guard(h);
  for (ShakeStep& step : steps_) step.end();
}

int ShakeIsland::slotOf(int ragdoll) const {
  const auto it = std::lower_bound(bodies_.begin(), bodies_.end(), ragdoll);
  return it != bodies_.end() && *it == ragdoll ? static_cast<int>(it - bodies_.begin()) : -1;
}

bool ShakeIsland::failed() const {
  return failed_ || std::any_of(steps_.begin(), steps_.end(),
                                [](const ShakeStep& step) { return step.failed_; });
}

void ShakeIsland::guard(double h) {
  enum class Way { kExplicit, kImplicit, kAlone };
  double stiffness = 0;
  bool driven = false, finite = true;
  const auto stiffest = [&] {
    stiffness = 0;
    for (ShakeStep& step : steps_) {
      const double own = step.stiffness();
      finite = finite && std::isfinite(own);
      stiffness = std::max(stiffness, own);
    }
    return std::sqrt(stiffness);
  };
  for (const ShakeStep& step : steps_) driven = driven || step.driven_;
  const double wanted = std::ceil(h * stiffest() / ShakeStep::kStable);
  Way way = finite && wanted <= ShakeStep::kMaxSubsteps ? Way::kExplicit : Way::kImplicit;
  double sub = way == Way::kExplicit ? h / std::max(1.0, wanted) : h;
  double left = h;
  int taken = 0;
  bool guarded = way != Way::kExplicit, limited = false;
  while (left > 1e-9 * h) {
    sub = std::min(sub, left);
    if (way == Way::kAlone) {
      stepAlone(left);
      ++taken;
      break;
    }
    failed_ = false;
    for (ShakeStep& step : steps_) {
      step.save();
      step.failed_ = false;
    }
    const std::vector<Press> known = s_.known;
    double took = 0;
    if (way == Way::kExplicit) {
      took = explicitStep(sub, taken);
      const bool can_halve = sub > 1.01 * h / ShakeStep::kMaxSubsteps;
      const bool smooth = !failed() && isSmooth();
      const double rise = failed() || (smooth && !swings(took)) ? 0 : energyRise(smooth);
      failed_ = failed_ || (can_halve && (sub * stiffest() > 2 * ShakeStep::kStable ||
                                          tensionJumped(took) || isLarge(rise, smooth)));
      if (!failed() && rise > 0 && !smooth) {
        takeOutOfGroup(model_, bodies_, isHeld(), rise, state_);
        limited = limited || rise > kReportedRise;
      }
    } else {
      guarded = true;
      took = implicitStep(sub);
    }
    if (failed()) {
      for (ShakeStep& step : steps_) step.restore();
      s_.known = known;
      sub *= way == Way::kExplicit ? 0.5 : 0.25;
      const int most = driven ? 4 : way == Way::kExplicit ? ShakeStep::kMaxSubsteps : kMaxPieces;
      if (sub < 0.99 * h / most) {
        way = way == Way::kExplicit ? Way::kImplicit : Way::kAlone;
        sub = left;
      }
      continue;
    }
    left -= took;
    ++taken;
  }
  report_.substeps = std::max(report_.substeps, taken);
  const int size = static_cast<int>(bodies_.size());
  int located = 0;
  for (const ShakeStep& step : steps_) located = std::max(located, step.located_);
  if (guarded || taken > 1 + located) report_.guarded += size;
  if (limited) report_.limited += size;
  if (!guarded && !limited) return;
  for (ShakeStep& step : steps_) step.makeAffine();
}

void ShakeIsland::stepAlone(double h) {
  s_.known.clear();
  s_.touching.clear();
  for (ShakeStep& step : steps_) {
    step.failed_ = false;
    step.guard(h);
  }
  ++report_.unresolved;
}

bool ShakeIsland::isSmooth() const {
  return s_.known.empty() && s_.touching.empty() &&
         std::all_of(steps_.begin(), steps_.end(),
                     [](const ShakeStep& step) { return step.isSmooth(); });
}

bool ShakeIsland::swings(double h) {
  return std::any_of(steps_.begin(), steps_.end(), [h](ShakeStep& step) { return step.swings(h); });
}

bool ShakeIsland::tensionJumped(double h) {
  return std::any_of(steps_.begin(), steps_.end(),
                     [h](ShakeStep& step) { return step.tensionJumped(h); });
}

bool ShakeIsland::isLarge(double rise, bool smooth) {
  double energy = 0;
  for (ShakeStep& step : steps_) energy += smooth ? step.swingScale() : step.kineticEnergy();
  if (smooth) return std::abs(rise) > ShakeStep::kRedoSwing * energy;
  return rise > ShakeStep::kRedoRise && rise > ShakeStep::kRedoRise * energy;
}

double ShakeIsland::energyRise(bool smooth) {
  double rise = 0;
  for (ShakeStep& step : steps_) {
    if (step.pin_speed_ > 0) return 0;
    rise += step.gainedEnergy(smooth ? 0 : step.driveSpeed());
  }
  return rise;
}

bool ShakeIsland::isHeld() const {
  for (const ShakeStep& step : steps_) {
    if (!model_.systemOf(step.ragdoll_).pins.empty()) return true;
    for (const Press& press : step.scratch_.presses)
      if (press.obstacle >= 0) return true;
  }
  return std::any_of(s_.pressing.begin(), s_.pressing.end(), [this](const BodyPair& pair) {
    return slotOf(pair.first) < 0 || slotOf(pair.second) < 0;  // a sleeper
  });
}

double ShakeIsland::explicitStep(double h, int taken) {
  for (ShakeStep& step : steps_) step.body_.start.setPose(step.rows_, step.xData());
  freeMotion(h);
  findConstraints(h);
  double until = taken < ShakeStep::kMaxImpacts ? firstDeepPair(h) : 2 * h;
  if (until > h) {
    for (ShakeStep& step : steps_) step.findArrivals(h);
    press(h);
    if (failed()) return h;
    until = firstArrival(h);
  }
  if (until <= h) {
    if (until > 0) {
      for (ShakeStep& step : steps_) step.shorten(until, h);
      for (Contact& c : s_.pairs) c.offset = c.found - overlapLeft(c, until);
      freeMotion(until);
      press(until);
      finish(until, true, true);
    } else {
      bounce();
    }
    return std::max(until, 1e-6 * h);
  }
  finish(h, true, false);
  for (ShakeStep& step : steps_)
    if (!step.x().allFinite() || !step.v().allFinite()) failed_ = true;
  return h;
}

double ShakeIsland::implicitStep(double h) {
  for (ShakeStep& step : steps_) {
    ++report_.implicit;
    step.scratch_.total.resize(0);
    step.scratch_.presses.clear();
    if (!step.solveImplicit(h)) step.failed_ = true;
  }
  s_.total.resize(0);
  s_.known.clear();
  if (failed()) return 0;
  findConstraints(h);
  pressImplicit(h);
  if (failed()) return 0;
  finish(h, false, false);
  for (ShakeStep& step : steps_)
    if (!step.x().allFinite() || !step.v().allFinite()) failed_ = true;
  if (failed()) return 0;
  double rise = 0, wild = 0;
  for (ShakeStep& step : steps_) {
    rise += step.gainedEnergy(step.driveSpeed());
    wild += step.wildRise();
  }
  failed_ = rise > wild;
  if (failed_) return 0;
  if (rise > 0) takeOutOfGroup(model_, bodies_, isHeld(), rise, state_);
  for (ShakeStep& step : steps_)
    for (int k = 0; k < step.rows_.s; ++k)
      step.multipliers()[k] = step.multipliers()[k + step.rows_.s] =
          step.scratch_.lambda[k] / (h * h);
  return h;
}

}  // namespace ragdoll
