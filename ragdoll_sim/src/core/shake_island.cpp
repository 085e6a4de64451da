#include "ragdoll_sim/core/shake_island.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/pair_energy.h"

namespace ragdoll {
namespace {

constexpr int kMaxPieces = 64;          ///< of implicit steps; beyond, each body by itself
constexpr int kMaxImplicitRounds = 12;  ///< of contacts and sticks in turn
constexpr double kReportedRise = 1e-6;  ///< [J] less is rounding

using Key = std::array<int, 4>;

Key keyOf(const Press& p) { return {p.a, p.b, p.other[0], p.other[1]}; }
Key keyOf(const Contact& c) { return {c.particle[0], c.particle[1], c.particle[2], c.particle[3]}; }

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

// Guard ------------------------------------------------------------------------------------------

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
      const double rise = failed() ? 0 : energyRise();
      double energy = 0;
      for (ShakeStep& step : steps_) energy += step.kineticEnergy();
      failed_ = failed_ || (can_halve && sub * stiffest() > 2 * ShakeStep::kStable) ||
                (can_halve && rise > ShakeStep::kRedoRise && rise > ShakeStep::kRedoRise * energy);
      if (!failed() && rise > 0) {
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

double ShakeIsland::energyRise() {
  bool pressed = !s_.known.empty();
  double rise = 0;
  for (ShakeStep& step : steps_) {
    if (step.pin_speed_ > 0) return 0;
    pressed = pressed || !step.scratch_.presses.empty();
  }
  if (!pressed) return 0;
  for (ShakeStep& step : steps_) rise += step.gainedEnergy(step.driveSpeed());
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
      for (Contact& c : s_.pairs) c.offset = c.found - ShakeStep::overlapLeft(c, until);
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
  double rise = 0;
  for (ShakeStep& step : steps_) rise += step.gainedEnergy(step.driveSpeed());
  if (rise > 0) takeOutOfGroup(model_, bodies_, isHeld(), rise, state_);
  for (ShakeStep& step : steps_)
    for (int k = 0; k < step.rows_.s; ++k)
      step.multipliers()[k] = step.multipliers()[k + step.rows_.s] =
          step.scratch_.lambda[k] / (h * h);
  return h;
}

// Positions --------------------------------------------------------------------------------------

void ShakeIsland::freeMotion(double h) {
  for (ShakeStep& step : steps_) step.freeMotion(h);
}

void ShakeIsland::startPair(Contact& c, double h) const {
  c.found = c.offset;
  c.before = -c.offset;
  for (int k = 0; k < 4; ++k) c.before += c.weight[k] * c.normal.dot(state_.x.col(c.particle[k]));
  c.offset -= ShakeStep::overlapLeft(c, h);
}

void ShakeIsland::findConstraints(double h) {
  for (ShakeStep& step : steps_) step.findConstraints(h);
  for (const int i : all_) {
    const Ragdoll& r = model_.ragdolls[i];
    const int n = model_.skeletonOf(r).size(), slot = slotOf(i);
    ws_.x1.middleCols(r.first, n) = state_.x.middleCols(r.first, n);
    if (slot >= 0) ws_.x1.middleCols(r.first, n) += s_.bodies[slot].dx;
  }
  s_.pairs.clear();
  ws_.pairs.appendBetween(model_, state_, all_, state_.x, ws_.x1,
                          PairSearch::touches(ShakeStep::kContactMargin), s_.pairs);
  for (Contact& c : s_.pairs) startPair(c, h);
}

double ShakeIsland::gapAt(const Contact& c) const {
  double gap = -c.offset;
  for (int k = 0; k < 4; ++k) gap += c.weight[k] * c.normal.dot(state_.x.col(c.particle[k]));
  for (int side = 0; side < 2; ++side) {
    const int slot = slotOf(side == 0 ? c.ragdoll : c.other);
    if (slot < 0) continue;
    const ShakeStep& step = steps_[slot];
    for (int k = 2 * side; k < 2 * side + 2; ++k)
      gap += c.weight[k] * c.normal.dot(step.scratch_.dx.col(c.particle[k] - step.ragdoll_.first));
  }
  return gap;
}

double ShakeIsland::firstDeepPair(double h) const {
  double first = 2 * h, scale = 1;
  for (const ShakeStep& step : steps_) scale = std::min(scale, step.rows_.scale);
  for (const Contact& c : s_.pairs) {  // they do not bounce
    const double end = gapAt(c);
    if (c.gap_start < -ShakeStep::kContactTolerance || end >= -ShakeStep::kDeepImpact * scale)
      continue;
    double v0 = 0;
    for (int k = 0; k < 4; ++k) v0 += c.weight[k] * c.normal.dot(state_.v.col(c.particle[k]));
    const double t = ShakeStep::timeOfZero(c.before, v0, end, h);
    if (t >= 0 && t < h) first = std::min(first, t);
  }
  return first;
}

double ShakeIsland::firstArrival(double h) {
  double first = 2 * h;
  ShakeStep* earliest = nullptr;
  for (ShakeStep& step : steps_) {
    const double until = step.firstArrival(h);
    if (until >= first) continue;
    first = until;
    earliest = &step;
  }
  if (earliest)
    for (ShakeStep& step : steps_) step.takeArrival(&step == earliest);
  return first;
}

int ShakeIsland::addRows(const Contact& c, int source) {
  const int first = s_.joint.size();
  std::array<int, 2> slot{slotOf(c.ragdoll), slotOf(c.other)}, row{-1, -1};
  for (int side = 0; side < 2; ++side) {
    if (slot[side] < 0) continue;
    Schur& schur = s_.bodies[slot[side]].schur;
    row[side] = schur.size();
    schur.addContact(c, source, 2 * side, 2 * side + 2);
  }
  s_.joint.addShared(c, slot[0], row[0], slot[1], row[1]);
  return first;
}

void ShakeIsland::gather(double h, bool leapfrog) {
  s_.joint.clear();
  for (ShakeStep& step : steps_) {
    step.gather(h, leapfrog);
    s_.joint.addBody(step.scratch_.schur);
  }
  s_.row.assign(s_.pairs.size(), -1);
  s_.forced.resize(s_.pairs.size(), 0);
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    const Contact& c = s_.pairs[i];
    const auto pressed = [&c](const Press& last) { return keyOf(last) == keyOf(c); };
    if (s_.forced[i] || gapAt(c) <= ShakeStep::kActiveGap ||
        std::any_of(s_.known.begin(), s_.known.end(), pressed))
      s_.row[i] = addRows(c, static_cast<int>(i));
  }
}

void ShakeIsland::fillGaps(double h) {
  s_.b.resize(s_.joint.size());
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    steps_[k].fillGaps(h);
    s_.b.segment(s_.joint.firstOf(static_cast<int>(k)), steps_[k].ownRows()) = s_.bodies[k].b;
  }
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    const int row = s_.row[i];
    if (row < 0) continue;
    const Contact& c = s_.pairs[i];
    s_.b[row] = gapAt(c);
    Vec3 slip = Vec3::Zero();
    for (int side = 0; side < 2; ++side) {
      const int slot = slotOf(side == 0 ? c.ragdoll : c.other);
      if (slot < 0) continue;
      for (int k = 2 * side; k < 2 * side + 2; ++k)
        slip += c.weight[k] * s_.bodies[slot].dx.col(c.particle[k] - steps_[slot].ragdoll_.first);
    }
    for (int k = 1; k < 3; ++k) s_.b[row + k] = s_.joint.row(row + k).direction.dot(slip);
  }
}

void ShakeIsland::recall(double h) {
  s_.p.setZero(s_.joint.size());
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    steps_[k].recall(h);
    const int own = steps_[k].ownRows();
    s_.p.segment(s_.joint.firstOf(static_cast<int>(k)), own) = s_.bodies[k].p.head(own);
  }
  std::vector<std::uint8_t> used(s_.known.size(), 0);
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    if (s_.row[i] < 0) continue;
    for (std::size_t k = 0; k < s_.known.size(); ++k) {
      if (used[k] || keyOf(s_.known[k]) != keyOf(s_.pairs[i])) continue;
      used[k] = 1;  // two capsules that lie along each other have two contacts
      for (int d = 0; d < 3; ++d)
        s_.p[s_.row[i] + d] =
            s_.known[k].impulse.dot(s_.joint.row(s_.row[i] + d).direction) * h * h;
      s_.p[s_.row[i]] = std::max(0.0, s_.p[s_.row[i]]);
      break;
    }
  }
}

void ShakeIsland::remember(double h) {
  for (ShakeStep& step : steps_) step.remember(h);
  s_.known.clear();
  s_.pressing.clear();
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    const int row = s_.row[i];
    if (row < 0 || !(s_.total[row] > 0)) continue;
    const Contact& c = s_.pairs[i];
    Press press;
    press.ragdoll = c.ragdoll;
    press.a = c.particle[0];
    press.b = c.particle[1];
    press.other = {c.particle[2], c.particle[3]};
    for (int d = 0; d < 3; ++d)
      press.impulse += s_.total[row + d] / (h * h) * s_.joint.row(row + d).direction;
    s_.known.push_back(press);
    s_.pressing.push_back({c.ragdoll, c.other});
  }
}

bool ShakeIsland::forceViolated() {
  bool any = false;
  for (ShakeStep& step : steps_) any = step.forceViolated() || any;
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    if (s_.row[i] >= 0 || gapAt(s_.pairs[i]) >= -ShakeStep::kContactTolerance) continue;
    s_.forced[i] = 1;
    any = true;
  }
  return any;
}

bool ShakeIsland::findMissed(double h) {
  for (ShakeStep& step : steps_)
    if (step.arrivesBefore()) return false;  // what is found will be cut short
  bool any = false;
  for (ShakeStep& step : steps_) any = step.findMissed(h) || any;  // sets ws_.x1
  s_.missed.clear();
  ws_.pairs.appendBetween(model_, state_, all_, state_.x, ws_.x1,
                          PairSearch::overlaps(ShakeStep::kMissedPair), s_.missed);
  for (Contact& c : s_.missed) {
    startPair(c, h);
    if (gapAt(c) >= -ShakeStep::kMissedPair) continue;
    s_.pairs.push_back(c);
    s_.forced.push_back(1);
    any = true;
  }
  return any;
}

double ShakeIsland::worstViolation() const {
  double worst = 0;
  for (std::size_t i = 0; i < s_.pairs.size(); ++i)
    if (s_.row[i] >= 0) worst = std::max(worst, -gapAt(s_.pairs[i]));
  return worst;
}

/// One solution of all rows and its motion.
void ShakeIsland::solveRound(bool at_start) {
  s_.joint.split(s_.total, s_.parts);
  s_.joint.addAnswer(-1, s_.parts, s_.b);
  s_.joint.solve(s_.b, s_.p);
  s_.joint.split(s_.p - s_.total, s_.parts);
  s_.total = s_.p;
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    ShakeStep& step = steps_[k];
    Schur& schur = step.scratch_.schur;
    if (schur.empty()) continue;
    StickSolver& sticks = at_start ? step.body_.start : step.body_.end;
    schur.move(step.rows_, sticks, s_.parts[k], step.scratch_.dx.data());
    const bool held = (at_start && step.satisfySticks()) || step.relaxAlongNew();
    if (!held) step.failed_ = true;
  }
  s_.joint.split(s_.total, s_.parts);
  for (std::size_t k = 0; k < steps_.size(); ++k) s_.bodies[k].total = s_.parts[k];
}

bool ShakeIsland::pressFound(double h) {
  gather(h, true);
  const int size = s_.joint.size();
  s_.total.setZero(size);
  for (ShakeStep& step : steps_) {
    Schur& schur = step.scratch_.schur;
    step.scratch_.total.setZero(schur.size());
    if (!schur.empty()) schur.assemble(step.rows_, step.body_.start);
  }
  if (size == 0) return true;
  recall(h);
  double violation = 0;
  for (int round = 0; round < ShakeStep::kMaxRounds; ++round) {
    fillGaps(h);
    if (round > 0) s_.p = s_.total;
    solveRound(true);
    if (failed()) return false;
    double now = worstViolation();
    for (ShakeStep& step : steps_) now = std::max(now, step.worstViolation());
    if (now < ShakeStep::kContactTolerance) return true;
    if (round > 1 && now > ShakeStep::kUnsettled && now > ShakeStep::kProgress * violation)
      return false;
    violation = now;
  }
  return true;
}

void ShakeIsland::press(double h) {
  s_.forced.clear();
  for (ShakeStep& step : steps_) {
    ShakeScratch& scratch = step.scratch_;
    scratch.free_dx = scratch.dx;
    scratch.free_lambda = scratch.lambda;
  }
  for (int search = 0; !failed(); ++search) {
    pressFound(h);
    if (failed()) return;
    const bool forced = forceViolated();
    const bool missed = findMissed(h);
    if (!forced && !missed) break;
    if (search + 1 == ShakeStep::kMaxSearches) {
      failed_ = true;  // smaller steps meet fewer things at once
      return;
    }
    const bool last = search + 2 == ShakeStep::kMaxSearches;  // solves for all that is near
    if (last) s_.forced.assign(s_.pairs.size(), 1);
    for (ShakeStep& step : steps_) {
      ShakeScratch& scratch = step.scratch_;
      scratch.dx = scratch.free_dx;
      scratch.lambda = scratch.free_lambda;
      if (!last) continue;
      step.forceNear();
    }
  }
  if (failed()) return;
  double worst = worstViolation();
  for (ShakeStep& step : steps_) worst = std::max(worst, step.worstViolation());
  failed_ = worst > ShakeStep::kUnsettled;
  for (int i = 0; i < s_.joint.size(); ++i)
    if (s_.joint.row(i).kind == Schur::Row::Kind::kNormal && s_.total[i] > 0) ++report_.contacts;
  remember(h);
}

void ShakeIsland::pressImplicit(double h) {
  for (ShakeStep& step : steps_) {
    step.forceNear();
  }
  s_.forced.assign(s_.pairs.size(), 1);
  const auto worst = [&] {
    double violation = worstViolation();
    for (ShakeStep& step : steps_) violation = std::max(violation, step.worstViolation());
    return violation;
  };
  gather(h, false);
  s_.total.setZero(s_.joint.size());
  for (ShakeStep& step : steps_) step.scratch_.total.setZero(step.scratch_.schur.size());
  double violation = worst();
  bool done = violation < ShakeStep::kContactTolerance;
  for (int round = 0; round < kMaxImplicitRounds && !done; ++round) {
    gather(h, false);
    if (s_.joint.size() != s_.total.size()) break;  // planes that changed their mind
    for (ShakeStep& step : steps_) {
      Schur& schur = step.scratch_.schur;
      step.body_.end.setPose(step.rows_, ws_.x1.data() + 3 * step.ragdoll_.first);
      if (!schur.empty()) schur.assemble(step.rows_, step.body_.end);
    }
    fillGaps(h);
    s_.p = s_.total;
    solveRound(false);
    if (failed()) return;
    const double now = worst();
    done = now < ShakeStep::kContactTolerance;
    if (!done && round > 1 && now > ShakeStep::kProgress * violation) break;
    violation = now;
  }
  failed_ = worst() > ShakeStep::kUnsettled || findMissed(h);
  if (!failed_) remember(h);
}

// Velocities -------------------------------------------------------------------------------------

void ShakeIsland::finish(double h, bool leapfrog, bool impact) {
  if (failed()) return;
  s_.touching.clear();
  s_.warm.clear();
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    if (gapAt(s_.pairs[i]) >= ShakeStep::kTouching) continue;
    s_.touching.push_back(s_.pairs[i]);
    const bool known = s_.total.size() > 0 && s_.row[i] >= 0;
    for (int k = 0; k < 3; ++k) s_.warm.push_back(known ? s_.total[s_.row[i] + k] / h : 0.0);
  }
  for (ShakeStep& step : steps_) step.move(h, leapfrog);
  pushVelocities(true, impact, h);
  for (ShakeStep& step : steps_) std::swap(step.body_.start, step.body_.end);
}

void ShakeIsland::bounce() {
  for (ShakeStep& step : steps_) {
    step.scratch_.dx.setZero(3, step.n_);
    step.body_.start.setPose(step.rows_, step.xData());
    ws_.x1.middleCols(step.ragdoll_.first, step.n_) = step.x();
    step.restrictToTouching(0);
  }
  s_.touching.clear();
  for (const Contact& c : s_.pairs)
    if (gapAt(c) < ShakeStep::kTouching) s_.touching.push_back(c);
  s_.warm.assign(3 * s_.touching.size(), 0.0);
  pushVelocities(false, true, 0);
}

void ShakeIsland::pushVelocities(bool at_end, bool impact, double h) {
  s_.joint.clear();
  for (ShakeStep& step : steps_) {
    step.gatherTouching(h);
    s_.joint.addBody(step.scratch_.schur);
  }
  const int own = s_.joint.size();
  for (std::size_t i = 0; i < s_.touching.size(); ++i) addRows(s_.touching[i], static_cast<int>(i));
  const int size = s_.joint.size();
  if (size == 0) return;
  const auto sticksOf = [&](ShakeStep& step) -> StickSolver& {
    return at_end ? step.body_.end : step.body_.start;
  };
  for (ShakeStep& step : steps_)
    if (!step.scratch_.schur.empty()) step.scratch_.schur.assemble(step.rows_, sticksOf(step));
  const auto push = [&](bool blow) {
    s_.b.resize(size);
    s_.p.setZero(size);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      ShakeStep& step = steps_[k];
      if (blow)
        step.fillBlow();
      else
        step.fillRates();
      const int first = s_.joint.firstOf(static_cast<int>(k)), rows = step.ownRows();
      s_.b.segment(first, rows) = step.scratch_.b;
      if (!blow)
        s_.p.segment(first, rows) =
            Eigen::Map<const Eigen::VectorXd>(step.scratch_.warm.data(), rows);
    }
    for (std::size_t i = 0; i < s_.touching.size(); ++i) {
      const Contact& c = s_.touching[i];
      Vec3 rate = Vec3::Zero();
      for (int k = 0; k < 4; ++k) rate += c.weight[k] * state_.v.col(c.particle[k]);
      for (int d = 0; d < 3; ++d) {
        const int row = own + 3 * static_cast<int>(i) + d;
        s_.b[row] = s_.joint.row(row).direction.dot(rate);
        if (!blow) s_.p[row] = s_.warm[3 * i + d];
      }
    }
    s_.joint.solve(s_.b, s_.p);
    s_.joint.split(s_.p, s_.parts);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      ShakeStep& step = steps_[k];
      Schur& schur = step.scratch_.schur;
      if (!schur.empty()) schur.move(step.rows_, sticksOf(step), s_.parts[k], step.vData());
    }
  };
  if (!impact || h > 0) {
    for (ShakeStep& step : steps_)
      if (impact) step.holdArriving();
    push(false);
  }
  if (impact) push(true);
}

}  // namespace ragdoll
