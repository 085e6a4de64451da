#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr double kLimitMargin = 0.3;   ///< [rad]
constexpr double kActiveAngle = 0.01;  ///< [rad] likewise
constexpr double kLever = 0.1;         ///< [m] of a radian that is seen
constexpr double kRecoveryTurn = 5;    ///< [rad/s] the same of a limit that is violated
constexpr double kFarBeyond = 0.02;    ///< [rad] violated by more than steps leave behind

}  // namespace

void ShakeStep::findConstraints(double h) {
  scratch_.contacts.clear();
  scratch_.limits.clear();
  scratch_.limit_role.clear();
  if (ws_.obstacles.empty() && model_.skeletonOf(ragdoll_).joints.empty() && !model_.self_collision)
    return;
  ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
  if (!ws_.obstacles.empty())
    appendContacts(model_, ws_.obstacles, state_.x, ws_.x1, index_, kContactMargin,
                   scratch_.contacts);
  if (model_.self_collision)
    ws_.pairs.appendSelf(model_, state_.x, ws_.x1, index_, PairSearch::touches(kContactMargin),
                         scratch_.contacts);
  if (squeezed_ == Squeezed::kThrough) letThrough();
  overlap_ = 0;
  for (Contact& c : scratch_.contacts) {
    overlap_ = std::max(overlap_, -c.gap_start);
    startContact(c, h);
  }
  scratch_.contact_role.assign(scratch_.contacts.size(), ShakeScratch::kIfNear);
  if (isJoined()) addLimits(kLimitMargin, h, ShakeScratch::kIfNear);
}

bool ShakeStep::isJoined() const { return length2_ == rows_.length2.data(); }

void ShakeStep::letThrough() {
  std::vector<Contact>& all = scratch_.contacts;
  double deepest = 0;
  for (const Contact& c : all) deepest = std::min(deepest, c.gap_start);
  scratch_.passed.clear();
  for (const Contact& c : all)
    if (c.gap_start < 0.5 * deepest) scratch_.passed.push_back(c.obstacle);
  all.erase(std::remove_if(all.begin(), all.end(), [&](const Contact& c) { return passes(c); }),
            all.end());
}

bool ShakeStep::passes(const Contact& c) const {
  return squeezed_ == Squeezed::kThrough &&
         std::count(scratch_.passed.begin(), scratch_.passed.end(), c.obstacle) > 0;
}

void ShakeStep::startContact(Contact& c, double h) const {
  const double* dx = scratch_.dx.data();
  c.found = c.offset;
  c.before = gapAt(c, dx) - c.normal.dot(motionOf(c, dx) - h / step_ * c.surface_motion);
  openSlowly(c, h, h);
}

void ShakeStep::startRow(LimitRow& limit, double h) {
  limit.before = anglesBefore()[limit.limit];
  if (limit.compliance > 0) limit.start = std::min(0.0, limit.before);
  openSlowly(limit, h);
}

void ShakeStep::openSlowly(Contact& c, double h, double whole) const {
  // In a part of a step a part of it, or what rounding leaves would become a speed.
  const double least = std::max(0.0, -c.before) * (1 - h / step_);
  const double stays = c.gap_start < 0 ? -c.gap_start - kRecoverySpeed * h : 0;
  if (c.count == 4)
    c.offset = c.found - overlapLeft(c, h, step_);
  else
    c.offset = c.found - (whole - h) / step_ * c.normal.dot(c.surface_motion) -
               std::max({0.0, least, stays});
  if (squeezed_ == Squeezed::kNo) return;
  if (c.gap_start > (squeezed_ >= Squeezed::kAll ? kTouching : -kSqueezed)) return;
  c.surface_motion.setZero();
  scratch_.stay.setZero(3, n_);
  c.offset = std::min(c.offset, c.offset + gapAt(c, scratch_.stay.data()));
}

void ShakeStep::openSlowly(LimitRow& limit, double h) const {
  if (limit.compliance > 0) return;
  const double least = std::max(0.0, -limit.before) * (1 - h / step_);
  const double turn = squeezed_ == Squeezed::kNo ? kRecoveryTurn * h : 0;
  const double stays = limit.value < -kFarBeyond ? -limit.before - turn : 0;
  limit.opening = std::max({0.0, least, stays});
}

void ShakeStep::shorten(double h, double whole) {
  for (Contact& c : scratch_.contacts) openSlowly(c, h, whole);
  for (LimitRow& limit : scratch_.limits) openSlowly(limit, h);
}

double ShakeStep::gapAt(const Contact& c, const double* dx) const {
  double gap = -c.offset;
  for (int k = 0; k < c.count; ++k) {
    const int i = c.particle[k];
    gap += c.weight[k] *
           c.normal.dot(state_.x.col(i) + Eigen::Map<const Vec3>(dx + 3 * (i - ragdoll_.first)));
  }
  return gap;
}

Vec3 ShakeStep::motionOf(const Contact& c, const double* dx) const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < c.count; ++k)
    sum += c.weight[k] * Eigen::Map<const Vec3>(dx + 3 * (c.particle[k] - ragdoll_.first));
  return sum;
}

LimitAngles::Pose& ShakeStep::anglesAfter() {
  ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
  return body_.angles.at(model_, ws_.x1, index_);
}

void ShakeStep::gather(double h, bool leapfrog) {
  Schur& schur = body_.schur;
  schur.start(ragdoll_.first);
  scratch_.contact_row.assign(scratch_.contacts.size(), -1);
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i) {
    const Contact& c = scratch_.contacts[i];
    const auto role = scratch_.contact_role[i];
    if (role == ShakeScratch::kArriving) continue;
    if (role == ShakeScratch::kIfNear && gapAt(c, scratch_.dx.data()) > kActiveGap &&
        !lastPress(keyOf(c)))
      continue;
    scratch_.contact_row[i] = schur.size();
    schur.addContact(c, static_cast<int>(i));
  }
  scratch_.softness.resize(scratch_.limits.size());
  scratch_.limit_row.assign(scratch_.limits.size(), -1);
  LimitAngles::Pose& angles = anglesAfter();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
    LimitRow& limit = scratch_.limits[i];
    const auto role = scratch_.limit_role[i];
    if (role == ShakeScratch::kArriving) continue;
    if (role == ShakeScratch::kIfNear && limit.compliance == 0 &&
        angles[limit.limit] > kActiveAngle && !lastPress(keyOf(limit)))
      continue;
    // One that touches at the start pushes along its direction there, as the sticks do.
    if (leapfrog && limit.compliance == 0 && std::abs(limit.before) < touching_angle_)
      anglesBefore().evaluate(model_, state_.x, limit);
    else
      angles.evaluate(model_, ws_.x1, limit);
    scratch_.softness[i] = leapfrog ? limit.middleSoftness(h) : limit.eulerSoftness(h);
    scratch_.limit_row[i] = schur.size();
    schur.addLimit(limit, static_cast<int>(i), scratch_.softness[i].compliance);
  }
  scratch_.own_rows = schur.size();
}

void ShakeStep::forceNear() {
  for (std::vector<std::uint8_t>* roles : {&scratch_.contact_role, &scratch_.limit_role})
    std::replace(roles->begin(), roles->end(), std::uint8_t{ShakeScratch::kIfNear},
                 std::uint8_t{ShakeScratch::kForced});
}

bool ShakeStep::forceViolated() {
  bool any = false;
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i) {
    if (scratch_.contact_row[i] >= 0 || scratch_.contact_role[i] == ShakeScratch::kArriving)
      continue;
    if (gapAt(scratch_.contacts[i], scratch_.dx.data()) >= -contact_tolerance_) continue;
    scratch_.contact_role[i] = ShakeScratch::kForced;
    any = true;
  }
  const LimitAngles::Pose& angles = anglesAfter();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
    if (scratch_.limit_row[i] >= 0 || scratch_.limit_role[i] == ShakeScratch::kArriving) continue;
    if (angles[scratch_.limits[i].limit] * kLever >= -contact_tolerance_) continue;
    scratch_.limit_role[i] = ShakeScratch::kForced;
    any = true;
  }
  return any;
}

bool ShakeStep::findMissed(double h) {
  ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
  // The relaxation leaves sticks off their lengths, too, but not so far.
  const bool limits = isJoined() || model_.solver.method == Method::kJakobsen;
  bool any = limits && addLimits(-kMissed / kLever, step_, ShakeScratch::kForced);
  scratch_.missed.clear();
  if (!ws_.obstacles.empty()) {
    appendContacts(model_, ws_.obstacles, state_.x, ws_.x1, index_, 0, scratch_.missed);
    appendStickOverlaps(model_, ws_.obstacles, state_.x, ws_.x1, index_, kMissedStick,
                        scratch_.missed);
  }
  const std::size_t obstacles = scratch_.missed.size();
  if (model_.self_collision)
    ws_.pairs.appendSelf(model_, state_.x, ws_.x1, index_, PairSearch::overlaps(kMissedPair),
                         scratch_.missed);
  for (std::size_t i = 0; i < scratch_.missed.size(); ++i) {
    Contact& c = scratch_.missed[i];
    if (passes(c)) continue;
    startContact(c, i < obstacles ? step_ : h);
    if (i < obstacles)  // what overlaps opens in a part of a step by a part of it
      c.offset = std::min(c.offset, c.found - std::max(0.0, -c.gap_start - kRecoverySpeed * h));
    if (gapAt(c, scratch_.dx.data()) >= (i < obstacles ? -kMissed : -kMissedPair)) continue;
    scratch_.contacts.push_back(c);
    scratch_.contact_role.push_back(ShakeScratch::kForced);
    any = true;
  }
  return any;
}

double ShakeStep::overlapLeft(const Contact& pair, double h, double step) {
  const double overlap = std::max(0.0, -pair.gap_start), more = overlap - kMissedPair;
  const double behind = std::max(0.0, -pair.before) * (1 - h / step);
  return std::max(behind, more > 0 ? kMissedPair + more * std::exp(-h / kPairRecovery) : overlap);
}

bool ShakeStep::addLimits(double margin, double h, ShakeScratch::Role role) {
  const std::vector<Limit>& limits = model_.skeletonOf(ragdoll_).limits;
  if (limits.empty()) return false;
  const std::size_t known = scratch_.limits.size();
  const LimitAngles::Pose& angles = anglesAfter();
  for (int k = 0; k < static_cast<int>(limits.size()); ++k) {
    if (angles[k] >= margin) continue;
    const auto same = [k](const LimitRow& l) { return l.limit == k; };
    const auto end = scratch_.limits.begin() + static_cast<std::ptrdiff_t>(known);
    if (std::any_of(scratch_.limits.begin(), end, same)) continue;
    LimitRow& row = scratch_.limits.emplace_back(limitRow(model_, index_, k));
    row.value = angles[k];
    startRow(row, h);
    scratch_.limit_role.push_back(role);
  }
  return scratch_.limits.size() > known;
}

void ShakeStep::pressFound(double h, bool leapfrog) {
  Schur& schur = body_.schur;
  gather(h, leapfrog);
  scratch_.total.setZero(schur.size());
  if (schur.empty()) return;
  fillGaps(h);
  if (!anyCloses()) return;
  schur.assemble(rows_, body_.start);
  Eigen::VectorXd& p = scratch_.p;
  recall(h);
  double violation = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    if (round > 0) {
      fillGaps(h);
      scratch_.b -= schur.matrix() * scratch_.total;
      p = scratch_.total;
    }
    if (!schur.solve(scratch_.b, p) && hasNoWayOut()) {
      failed_ = true;
      break;
    }
    const Eigen::VectorXd change = p - scratch_.total;
    scratch_.total = p;
    schur.move(change, scratch_.dx.data());
    if (!satisfySticks() && !relaxAlongNew()) failed_ = true;
    const double now = failed_ ? 0 : worstViolation();
    if (failed_ || now < contact_tolerance_) break;
    if (round > 1 && now > kUnsettled && now > kProgress * violation) break;
    violation = now;
  }
}

void ShakeStep::press(double h, bool leapfrog) {
  if (scratch_.contacts.empty() && scratch_.limits.empty()) {
    scratch_.presses.clear();
    return;
  }
  Schur& schur = body_.schur;
  scratch_.free_dx = scratch_.dx;
  scratch_.free_lambda = scratch_.lambda;
  for (int search = 0;; ++search) {
    pressFound(h, leapfrog);
    if (failed_) break;
    const bool forced = forceViolated();
    const bool missed = leapfrog && !arrivesBefore() && findMissed(h);
    if (!forced && !missed) break;
    if (search + 1 == kMaxSearches) {
      failed_ = leapfrog;  // smaller steps meet fewer things at once
      if (failed_) scratch_.total.resize(0);
      break;
    }
    if (search + 2 == kMaxSearches) {  // the last one solves for all that is near
      forceNear();
    }
    scratch_.dx = scratch_.free_dx;
    scratch_.lambda = scratch_.free_lambda;
  }
  if (failed_ && scratch_.total.size() == 0) return;
  failed_ = failed_ || (leapfrog && worstViolation() > kUnsettled);
  for (int i = 0; i < schur.size(); ++i)
    if (schur.row(i).kind == Schur::Row::Kind::kNormal && scratch_.total[i] > 0) ++report_.contacts;
  remember(h);
}

const Press* ShakeStep::lastPress(const Press& key) const {
  for (const Press& last : scratch_.presses)
    if (last.a == key.a && last.b == key.b && last.obstacle == key.obstacle &&
        last.other == key.other)
      return &last;
  return nullptr;
}

Press ShakeStep::keyOf(const LimitRow& limit) const {
  Press key;
  key.ragdoll = index_;
  key.a = -1 - limit.limit;
  key.b = limit.joint;
  return key;
}

Press ShakeStep::keyOf(const Contact& c) const {
  Press key;
  key.ragdoll = index_;
  key.a = c.particle[0];
  key.b = c.count > 1 ? c.particle[1] : -1;
  key.obstacle = c.obstacle;
  if (c.count == 4) key.other = {c.particle[2], c.particle[3]};
  return key;
}

Press ShakeStep::keyOf(const Schur::Row& row) const {
  return row.kind == Schur::Row::Kind::kLimit ? keyOf(scratch_.limits[row.source])
                                              : keyOf(scratch_.contacts[row.source]);
}

void ShakeStep::recall(double h) {
  Eigen::VectorXd& p = scratch_.p;
  p.setZero(body_.schur.size());
  if (scratch_.presses.empty()) return;
  const Press* last = nullptr;
  for (int i = 0; i < ownRows(); ++i) {
    const Schur::Row& row = body_.schur.row(i);
    if (row.kind != Schur::Row::Kind::kTangent) last = lastPress(keyOf(row));
    if (!last) continue;
    if (row.kind == Schur::Row::Kind::kLimit)
      p[i] = last->impulse.x() * h * h;
    else
      p[i] = last->impulse.dot(row.direction) * h * h;
    if (row.kind == Schur::Row::Kind::kNormal) p[i] = std::max(0.0, p[i]);
  }
}

void ShakeStep::remember(double h) {
  scratch_.presses.clear();
  bool pressed = false;  // the contact whose friction follows
  for (int i = 0; i < ownRows(); ++i) {
    const Schur::Row& row = body_.schur.row(i);
    const double force = scratch_.total[i] / (h * h);
    if (row.kind == Schur::Row::Kind::kLimit) {
      if (force == 0) continue;
      scratch_.presses.push_back(keyOf(row));
      scratch_.presses.back().impulse = Vec3(force, 0, 0);
    } else if (row.kind == Schur::Row::Kind::kNormal) {
      pressed = force != 0;
      if (!pressed) continue;
      scratch_.presses.push_back(keyOf(row));
      scratch_.presses.back().impulse = force * row.direction;
    } else if (pressed && force != 0) {
      scratch_.presses.back().impulse += force * row.direction;
    }
  }
}

void ShakeStep::fillGaps(double h) {
  const double share = h / step_;
  Schur& schur = body_.schur;
  scratch_.b.resize(ownRows());
  const LimitAngles::Pose& angles = anglesAfter();
  for (int i = 0; i < ownRows(); ++i) {
    const Schur::Row& row = schur.row(i);
    if (row.kind == Schur::Row::Kind::kLimit) {
      const LimitRow& limit = scratch_.limits[row.source];
      scratch_.b[i] = angles[limit.limit] + limit.opening + scratch_.softness[row.source].offset +
                      row.compliance * scratch_.total[i];
    } else if (row.kind == Schur::Row::Kind::kNormal) {
      scratch_.b[i] = gapAt(scratch_.contacts[row.source], scratch_.dx.data());
    } else {
      const Contact& c = scratch_.contacts[row.source];
      scratch_.b[i] =
          schur.along(i, scratch_.dx.data()) - row.direction.dot(share * c.surface_motion);
    }
  }
}

bool ShakeStep::anyCloses() const {
  for (int i = 0; i < ownRows(); ++i)
    if (body_.schur.row(i).kind != Schur::Row::Kind::kTangent && scratch_.b[i] < 0) return true;
  return false;
}

double ShakeStep::worstViolation() {
  double worst = 0;
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i)
    if (scratch_.contact_row[i] >= 0)
      worst = std::max(worst, -gapAt(scratch_.contacts[i], scratch_.dx.data()));
  const LimitAngles::Pose& angles = anglesAfter();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
    const LimitRow& limit = scratch_.limits[i];
    if (scratch_.limit_row[i] >= 0 && limit.compliance == 0)
      worst = std::max(worst, -(angles[limit.limit] + limit.opening) * kLever);
  }
  return worst;
}

}  // namespace ragdoll
