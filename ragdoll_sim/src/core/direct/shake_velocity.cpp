#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr double kBounceSteps = 4;  ///< bounce only above an approach speed of 4 g h

}  // namespace

void ShakeStep::finish(double h, bool leapfrog, bool impact) {
  move(h, leapfrog);
  pushVelocities(body_.end, impact, h);
  std::swap(body_.start, body_.end);
}

void ShakeStep::move(double h, bool leapfrog) {
  ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
  v() = scratch_.dx / h;
  if (leapfrog) v() += (0.5 * h) * scratch_.acceleration;
  restrictToTouching(h);
  if (leapfrog) releaseSprings(h);
  x() += scratch_.dx;
  body_.end.setPose(rows_, xData());
  body_.end.projectVelocities(rows_, vData());
}

void ShakeStep::restrictToTouching(double h) {
  scratch_.touching.clear();
  scratch_.warm.clear();
  // Impulses of the position stage, if there was one: where the velocity stage starts.
  const auto pressed = [&](const std::vector<int>& rows, std::size_t i, int k) {
    const bool known =
        h > 0 && i < rows.size() && rows[i] >= 0 && rows[i] + k < scratch_.total.size();
    return known ? scratch_.total[rows[i] + k] / h : 0.0;
  };
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i) {
    const Contact& c = scratch_.contacts[i];
    if (gapAt(c, scratch_.dx.data()) >= touching_ &&
        scratch_.contact_role[i] != ShakeScratch::kArrived)
      continue;
    scratch_.touching.push_back(c);
    for (int k = 0; k < (c.friction > 0 ? 3 : 1); ++k)
      scratch_.warm.push_back(pressed(scratch_.contact_row, i, k));
  }
  scratch_.touching_limits.clear();
  if (scratch_.limits.empty()) return;
  LimitAngles::Pose& angles = anglesAfter();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
    const LimitRow& limit = scratch_.limits[i];
    if (limit.compliance > 0) continue;
    if (angles[limit.limit] + limit.opening >= touching_angle_ &&
        scratch_.limit_role[i] != ShakeScratch::kArrived)
      continue;
    scratch_.touching_limits.push_back(limit);
    angles.evaluate(model_, ws_.x1, scratch_.touching_limits.back());
    scratch_.warm.push_back(pressed(scratch_.limit_row, i, 0));
  }
}

void ShakeStep::releaseSprings(double h) {
  for (LimitRow limit : scratch_.limits) {
    if (limit.compliance == 0) continue;
    anglesAfter().evaluate(model_, ws_.x1, limit);
    const double torque = limit.springTorque();
    if (torque == 0) continue;
    for (int k = 0; k < limit.count; ++k)
      v() += (0.5 * h * torque) * limit.gradient[k] *
             system_.W.row(limit.particle[k] - ragdoll_.first);
    if (limit.damping == 0) continue;
    scratch_.touching_limits.push_back(limit);
    scratch_.warm.push_back(0);
  }
}

void ShakeStep::pushVelocities(StickSolver& sticks, bool impact, double h) {
  if (scratch_.touching.empty() && scratch_.touching_limits.empty()) return;
  gatherTouching(h);
  Schur& schur = body_.schur;
  schur.assemble(rows_, sticks);
  const auto push = [&] {
    schur.solve(scratch_.b, scratch_.p);
    schur.move(scratch_.p, vData());
  };
  if (!impact || h > 0) {
    // What pressed all the while does so until the blow; it is not for the blow to take that back.
    if (impact) holdArriving();
    fillRates();
    scratch_.p = Eigen::Map<const Eigen::VectorXd>(scratch_.warm.data(), schur.size());
    push();
  }
  if (!impact) return;
  fillBlow();
  scratch_.p.setZero(schur.size());
  push();
}

void ShakeStep::gatherTouching(double h) {
  Schur& schur = body_.schur;
  schur.start(ragdoll_.first);
  for (std::size_t i = 0; i < scratch_.touching.size(); ++i)
    schur.addContact(scratch_.touching[i], static_cast<int>(i));
  for (std::size_t i = 0; i < scratch_.touching_limits.size(); ++i) {
    const LimitRow& limit = scratch_.touching_limits[i];
    if (limit.compliance == 0)
      schur.addLimit(limit, static_cast<int>(i), 0);
    else  // the damper may take back what the spring gave, no more: the two together only push
      schur.addLimit(limit, static_cast<int>(i), 2 / (h * limit.damping),
                     -0.5 * h * limit.springTorque());
  }
  scratch_.own_rows = schur.size();
}

void ShakeStep::fillRates() {
  const Schur& schur = body_.schur;
  scratch_.b.resize(ownRows());
  for (int i = 0; i < ownRows(); ++i) {
    const Schur::Row& row = schur.row(i);
    scratch_.b[i] = schur.along(i, vData());
    if (row.kind != Schur::Row::Kind::kLimit)
      scratch_.b[i] -= row.direction.dot(scratch_.touching[row.source].surface_motion) / step_;
  }
}

void ShakeStep::holdArriving() {
  for (int i = 0; i < ownRows(); ++i)
    if (arrivesNow(body_.schur.row(i))) {
      body_.schur.hold(i);
      scratch_.warm[i] = 0;
    }
}

void ShakeStep::fillBlow() {
  Schur& schur = body_.schur;
  fillRates();
  for (int i = 0; i < ownRows(); ++i) {
    const Schur::Row& row = schur.row(i);
    schur.hold(i, row.compliance > 0);
    if (row.kind != Schur::Row::Kind::kNormal || located_ > kMaxBounces) continue;
    const Contact& c = scratch_.touching[row.source];
    if (-scratch_.b[i] > bounceSpeed(c)) scratch_.b[i] *= 1 + c.restitution;
  }
}

bool ShakeStep::arrivesNow(const Schur::Row& row) const {
  if (row.kind == Schur::Row::Kind::kLimit) {
    const LimitRow& limit = scratch_.touching_limits[row.source];
    return limit.compliance == 0 && limit.before >= touching_angle_;
  }
  return scratch_.touching[row.source].before >= touching_;
}

double ShakeStep::bounceSpeed(const Contact& c) const {
  return kBounceSteps * step_ * std::abs(c.normal.dot(model_.gravity));
}

void ShakeStep::bounce() {
  scratch_.dx.setZero(3, n_);
  body_.start.setPose(rows_, xData());
  ws_.x1.middleCols(ragdoll_.first, n_) = x();
  restrictToTouching(0);
  pushVelocities(body_.start, true);
}

}  // namespace ragdoll
