#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/shake_step.h"

namespace ragdoll {
namespace {

constexpr double kBounceSteps = 4;       ///< bounce only above an approach speed of 4 g h
constexpr double kTouchingAngle = 1e-4;  ///< [rad]

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
    if (gapAt(c, scratch_.dx.data()) >= kTouching) continue;
    scratch_.touching.push_back(c);
    for (int k = 0; k < (c.friction > 0 ? 3 : 1); ++k)
      scratch_.warm.push_back(pressed(scratch_.contact_row, i, k));
  }
  scratch_.touching_limits.clear();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
    const LimitRow& limit = scratch_.limits[i];
    if (limit.compliance > 0) continue;
    if (valueAt(model_, ws_.x1, limit) + limit.opening >= kTouchingAngle) continue;
    scratch_.touching_limits.push_back(limit);
    evaluateLimit(model_, ws_.x1, scratch_.touching_limits.back());
    if (scratch_.touching_limits.back().count == 0)
      scratch_.touching_limits.pop_back();
    else
      scratch_.warm.push_back(pressed(scratch_.limit_row, i, 0));
  }
}

void ShakeStep::releaseSprings(double h) {
  for (LimitRow limit : scratch_.limits) {
    if (limit.compliance == 0) continue;
    evaluateLimit(model_, ws_.x1, limit);
    const double torque = limit.springTorque();
    if (limit.count == 0 || torque == 0) continue;
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
  Schur& schur = scratch_.schur;
  schur.assemble(rows_, sticks, system_.W);
  fillRates(impact);
  scratch_.p = Eigen::Map<const Eigen::VectorXd>(scratch_.warm.data(), schur.size());
  schur.solve(scratch_.b, scratch_.p);
  schur.move(rows_, sticks, system_.W, scratch_.p, vData());
}

void ShakeStep::gatherTouching(double h) {
  Schur& schur = scratch_.schur;
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

void ShakeStep::fillRates(bool impact) {
  const Schur& schur = scratch_.schur;
  scratch_.b.resize(ownRows());
  for (int i = 0; i < ownRows(); ++i) {
    const Schur::Row& row = schur.row(i);
    scratch_.b[i] = schur.along(i, vData());
    if (row.kind == Schur::Row::Kind::kLimit) continue;
    const Contact& c = scratch_.touching[row.source];
    scratch_.b[i] -= row.direction.dot(c.surface_motion) / step_;
    if (impact && row.kind == Schur::Row::Kind::kNormal && -scratch_.b[i] > bounceSpeed(c))
      scratch_.b[i] *= 1 + c.restitution;
  }
}

double ShakeStep::bounceSpeed(const Contact& c) const {
  return kBounceSteps * step_ * std::abs(c.normal.dot(model_.gravity));
}

bool ShakeStep::isImpact(const Contact& c, double h, bool may_bounce) const {
  if (c.gap_start < -kContactTolerance) return false;
  if (gapAt(c, scratch_.dx.data()) < -kDeepImpact * rows_.scale) return true;
  if (!may_bounce || !(c.restitution > 0)) return false;
  const double speed =
      -c.normal.dot(motionOf(c, scratch_.dx.data()) / h - c.surface_motion / step_);
  return speed > bounceSpeed(c) && gapAt(c, scratch_.dx.data()) < 0;
}

double ShakeStep::timeOfTouch(double g0, double v0, double end, double h) {
  const double q = (end - g0 - v0 * h) / (h * h);  // gap = g0 + v0 t + q t^2
  const double root = std::sqrt(std::max(0.0, v0 * v0 - 4 * q * g0));
  const double t = g0 > 0 ? 2 * g0 / (-v0 + root) : 0;
  return t >= 0 ? t : h;
}

double ShakeStep::firstImpact(double h, bool may_bounce) const {
  double first = h;
  for (const Contact& c : scratch_.contacts) {
    if (!isImpact(c, h, may_bounce)) continue;
    const double end = gapAt(c, scratch_.dx.data());
    const double v0 = c.normal.dot(motionOf(c, state_.v.data() + 3 * ragdoll_.first)) -
                      c.normal.dot(c.surface_motion) / step_;
    const double g0 = std::max(
        0.0, end - c.normal.dot(motionOf(c, scratch_.dx.data()) - h / step_ * c.surface_motion));
    first = std::min(first, timeOfTouch(g0, v0, end, h));
  }
  return first;
}

void ShakeStep::bounce() {
  scratch_.dx.setZero(3, n_);
  body_.start.setPose(rows_, xData());
  ws_.x1.middleCols(ragdoll_.first, n_) = x();
  restrictToTouching(0);
  pushVelocities(body_.start, true);
}

}  // namespace ragdoll
