// Position stage of bodies that touch each other.
#include <algorithm>
#include <cmath>

#include "core/direct/shake_island.h"

namespace ragdoll {
namespace {

constexpr int kMaxImplicitRounds = 12;  ///< of contacts and sticks in turn

using Key = std::array<int, 4>;

Key keyOf(const Press& p) { return {p.a, p.b, p.other[0], p.other[1]}; }
Key keyOf(const Contact& c) { return {c.particle[0], c.particle[1], c.particle[2], c.particle[3]}; }

}  // namespace

void ShakeIsland::freeMotion(double h) {
  for (ShakeStep& step : steps_) step.freeMotion(h);
}

void ShakeIsland::startPair(Contact& c, double h) const {
  c.found = c.offset;
  c.before = -c.offset;
  for (int k = 0; k < 4; ++k) c.before += c.weight[k] * c.normal.dot(state_.x.col(c.particle[k]));
  c.offset -= overlapLeft(c, h);
}

double ShakeIsland::overlapLeft(const Contact& c, double h) const {
  return ShakeStep::overlapLeft(c, h, steps_[0].step_);
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
    if (c.gap_start < -steps_[0].contact_tolerance_ || end >= -ShakeStep::kDeepImpact * scale)
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
    Schur& schur = steps_[slot[side]].body_.schur;
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
    s_.joint.addBody(step.body_.schur);
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
    if (s_.row[i] >= 0 || gapAt(s_.pairs[i]) >= -steps_[0].contact_tolerance_) continue;
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
    Schur& schur = step.body_.schur;
    if (schur.empty()) continue;
    schur.move(s_.parts[k], step.scratch_.dx.data());
    const bool held = (at_start && step.satisfySticks()) || step.relaxAlongNew();
    if (!held) step.failed_ = true;
  }
  s_.joint.split(s_.total, s_.parts);
  for (std::size_t k = 0; k < steps_.size(); ++k) s_.bodies[k].total = s_.parts[k];
}

bool ShakeIsland::anyCloses() const {
  for (int i = 0; i < s_.joint.size(); ++i)
    if (s_.joint.row(i).kind != Schur::Row::Kind::kTangent && s_.b[i] < 0) return true;
  return false;
}

bool ShakeIsland::pressFound(double h) {
  gather(h, true);
  const int size = s_.joint.size();
  s_.total.setZero(size);
  for (ShakeStep& step : steps_) step.scratch_.total.setZero(step.body_.schur.size());
  if (size == 0) return true;
  fillGaps(h);
  if (!anyCloses()) return true;
  for (ShakeStep& step : steps_) {
    Schur& schur = step.body_.schur;
    if (!schur.empty()) schur.assemble(step.rows_, step.body_.start);
  }
  recall(h);
  double violation = 0;
  for (int round = 0; round < ShakeStep::kMaxRounds; ++round) {
    if (round > 0) {
      fillGaps(h);
      s_.p = s_.total;
    }
    solveRound(true);
    if (failed()) return false;
    double now = worstViolation();
    for (ShakeStep& step : steps_) now = std::max(now, step.worstViolation());
    if (now < steps_[0].contact_tolerance_) return true;
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
  for (ShakeStep& step : steps_) step.scratch_.total.setZero(step.body_.schur.size());
  double violation = worst();
  bool done = violation < steps_[0].contact_tolerance_;
  for (int round = 0; round < kMaxImplicitRounds && !done; ++round) {
    gather(h, false);
    if (s_.joint.size() != s_.total.size()) break;  // planes that changed their mind
    for (ShakeStep& step : steps_) {
      Schur& schur = step.body_.schur;
      step.body_.end.setPose(step.rows_, ws_.x1.data() + 3 * step.ragdoll_.first);
      if (!schur.empty()) schur.assemble(step.rows_, step.body_.end);
    }
    fillGaps(h);
    s_.p = s_.total;
    solveRound(false);
    if (failed()) return;
    const double now = worst();
    done = now < steps_[0].contact_tolerance_;
    if (!done && round > 1 && now > ShakeStep::kProgress * violation) break;
    violation = now;
  }
  failed_ = worst() > ShakeStep::kUnsettled || findMissed(h);
  if (!failed_) remember(h);
}

}  // namespace ragdoll
