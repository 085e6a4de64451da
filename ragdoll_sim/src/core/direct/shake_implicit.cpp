// The step guard's last resorts: an implicit step, and below it a rigid one.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

constexpr int kMaxIterations = 40;     ///< of Newton
constexpr int kMaxRelaxations = 60;    ///< Newton iterations of the projection on sticks alone
constexpr double kLargestShare = 0.5;  ///< of a stick's length: how far an iteration moves its ends
constexpr double kSmallShare = 0.49;   ///< below, by a bound, no stick needs to be looked at
constexpr double kBalance = 1e-9;      ///< of the longest stick: positions against multipliers
constexpr int kImplicitRounds = 12;    ///< of contacts and sticks in turn
constexpr double kLargestTurn = 1;     ///< [rad] of a rigid motion; faster spin is lost
constexpr double kRounding = 1e-9;     ///< of the energy: less is no rise
constexpr int kMaxShortenings = 30;    ///< of a rigid motion that touches
constexpr double kTouchDepth = 1e-7;   ///< [m] a rigid motion may end in an obstacle by that

}  // namespace

double ShakeStep::implicitStep(double h) {
  ++report_.implicit;
  scratch_.total.resize(0);
  scratch_.presses.clear();
  if (!solveImplicit(h)) {
    failed_ = true;
    return 0;
  }
  findConstraints(h);
  pressImplicit(h);
  if (failed_) return 0;
  finish(h, false);
  if (!v().allFinite() || !x().allFinite()) {
    failed_ = true;
    return 0;
  }
  const double rise = gainedEnergy(driveSpeed());
  // Another solution than the one sought, or limits turned the whole body: not to be taken out.
  if (rise > wildRise() || (rise > 0 && !limitEnergy(rise))) {
    failed_ = true;
    return 0;
  }
  for (int s = 0; s < rows_.s; ++s)
    multipliers()[s] = multipliers()[s + rows_.s] = scratch_.lambda[s] / (h * h);
  return h;
}

bool ShakeStep::solveImplicit(double h) {
  const int s = rows_.s, n = n_;
  const Eigen::MatrixXd &B = system_.B, &BW = system_.BW, &G = system_.G;
  auto& [free, dx, unbalanced, step, D0, D, impulses, DB, tangent, sides, solved, pulled, system,
         turn, lambda, stretch, change] = scratch_.implicit;
  free = h * v() + (h * h) * scratch_.acceleration;
  if (s == 0) {
    scratch_.dx = free;
    scratch_.lambda.setZero(rows_.width);
    return free.allFinite();
  }
  const Eigen::Map<const Eigen::VectorXd> length2(length2_, s);
  const double longest = std::sqrt(length2.maxCoeff()), shortest = std::sqrt(length2.minCoeff());
  const double reach = B.cwiseAbs().rowwise().sum().maxCoeff();  // of a particle's motion, on ends
  lambda = Eigen::Map<const Eigen::VectorXd>(multipliers(), s) * (h * h);
  if (!lambda.allFinite()) lambda.setZero();
  dx.setZero(3, n);
  D0.noalias() = x() * B.transpose();
  D = D0;
  tangent.resize(s, s);
  stretch.resize(s);
  change.resize(s);
  sides.resize(s, n + s);
  sides << BW, G;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu(s);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (iteration > 0) {
      D.noalias() = dx * B.transpose();
      D += D0;
    }
    impulses = D * lambda.asDiagonal();
    unbalanced = dx - free;
    unbalanced.noalias() -= impulses * BW;
    double worst = 0;
    for (int k = 0; k < s; ++k) {
      stretch[k] = 0.5 * (D.col(k).squaredNorm() - length2_[k]);
      worst = std::max(worst, 2 * std::abs(stretch[k]) / length2_[k]);
    }
    if (!std::isfinite(worst) || !unbalanced.allFinite()) return false;
    if (worst < kTolerance && unbalanced.cwiseAbs().maxCoeff() <
                                  kBalance * longest + 1e-12 * free.cwiseAbs().maxCoeff()) {
      scratch_.dx = dx;
      scratch_.lambda.setZero(rows_.width);
      scratch_.lambda.head(s) = lambda;
      return true;
    }
    // Only tension stiffens; compression would soften and may leave the tangent indefinite.
    tangent.setIdentity();
    tangent.noalias() -= G * lambda.cwiseMin(0.0).asDiagonal();
    lu.compute(tangent);
    DB.noalias() = unbalanced * B.transpose();
    solved = lu.solve(sides);
    const auto moved = solved.leftCols(n);
    pulled = lu.solve(DB.transpose()).transpose();  // DB (I - Lambda G)^-1
    system.noalias() = D.transpose() * D;
    system.array() *= solved.rightCols(s).array();
    for (int k = 0; k < s; ++k) change[k] = -stretch[k] + D.col(k).dot(pulled.col(k));
    change = lu.compute(system).solve(change);
    step = -unbalanced;
    impulses = DB * lambda.cwiseMin(0.0).asDiagonal();
    step.noalias() -= impulses * moved;
    impulses = D * change.asDiagonal();
    step.noalias() += impulses * moved;
    double share = 1;
    if (!(reach * std::sqrt(step.colwise().squaredNorm().maxCoeff()) < kSmallShare * shortest)) {
      turn.noalias() = step * B.transpose();
      for (int k = 0; k < s; ++k)
        share = std::min(
            share, kLargestShare * std::sqrt(length2_[k]) / std::max(1e-300, turn.col(k).norm()));
    }
    if (!(share > 1e-12)) return false;
    dx += share * step;
    lambda += share * change;
  }
  return false;
}

void ShakeStep::pressImplicit(double h) {
  if (scratch_.contacts.empty() && scratch_.limits.empty()) return;
  Schur& schur = body_.schur;
  forceNear();
  gather(h, false);
  scratch_.total.setZero(schur.size());
  // Bodies that relaxation moves sank in more with it (test/laws/lying_start_test.cpp).
  const bool goes_on = squeezed_ == Squeezed::kNo && model_.solver.method != Method::kJakobsen;
  double violation = worstViolation();
  bool done = violation < contact_tolerance_;
  for (int round = 0; round < kImplicitRounds && !done; ++round) {
    gather(h, false);
    if (scratch_.total.size() != schur.size()) scratch_.total.setZero(schur.size());  // other rows
    body_.end.setPose(rows_, ws_.x1.data() + 3 * ragdoll_.first);
    schur.assemble(rows_, body_.end);
    fillGaps(h);
    scratch_.p = scratch_.total;
    scratch_.b -= schur.matrix() * scratch_.total;
    const bool settled =
        schur.solve(scratch_.b, scratch_.p) || (goes_on && schur.solveOn(scratch_.b, scratch_.p));
    if (!settled && hasNoWayOut()) {
      failed_ = true;
      return;
    }
    const Eigen::VectorXd change = scratch_.p - scratch_.total;
    scratch_.total = scratch_.p;
    schur.move(change, scratch_.dx.data());
    if (!relaxAlongNew()) {
      failed_ = true;
      return;
    }
    const double now = worstViolation();
    done = now < contact_tolerance_;
    if (!done && round > 1 && now > kProgress * violation) break;
    violation = now;
  }
  failed_ = worstViolation() > kUnsettled || findMissed(h);
  if (!failed_) remember(h);
}

bool ShakeStep::relaxAlongNew() {
  for (int iteration = 0; iteration < kMaxRelaxations; ++iteration) {
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    body_.end.setPose(rows_, ws_.x1.data() + 3 * ragdoll_.first);
    const Eigen::Map<const PaddedRows> D(body_.end.D(), 3, rows_.width);
    double worst = 0;
    scratch_.residual.setZero(rows_.width);
    for (int s = 0; s < rows_.s; ++s) {
      // (L / |d| - 1) |d|^2: the length itself, not its square, so that far sticks come in
      // evenly.
      const double q = std::max(D.col(s).squaredNorm(), kMinLength * kMinLength);
      scratch_.residual[s] = std::sqrt(length2_[s] * q) - q;
      worst = std::max(worst, std::abs(length2_[s] - q) / length2_[s]);
    }
    if (worst < tolerance_) return true;
    if (!std::isfinite(worst)) return false;
    body_.end.solve(rows_, scratch_.residual.data());
    scratch_.lambda += scratch_.residual;
    body_.end.move(rows_, scratch_.residual.data(), 1, scratch_.dx.data());
  }
  return false;
}

double ShakeStep::rigidStep(double h) {
  ++report_.rigid;
  const std::vector<int>& pins = model_.systemOf(ragdoll_).pins;
  const Points start = x(), v0 = v();
  Points carried = Points::Zero(3, n_);  // by several pins, which need not move rigidly
  if (pins.size() > 1)
    for (std::size_t p = 0; p < pins.size(); ++p)
      carried += v0.col(pins[p]) * system_.pin_motion.row(p);
  RigidMotion motion;
  double t = h;
  for (int i = 0; i < kMaxShortenings; ++i, t *= 0.5) {
    if (i + 1 == kMaxShortenings) t = 0;
    motion =
        rigidMotion(model_.skeletonOf(ragdoll_).M, pins, start, v0 + t * scratch_.acceleration);
    if (pins.size() > 1) motion.drift.setZero();
    const double angle = motion.spin.norm() * t;
    if (angle > kLargestTurn) motion.spin *= kLargestTurn / angle;
    scratch_.dx = t * carried;
    if (angle > 0) {
      const Eigen::AngleAxisd turn(std::min(angle, kLargestTurn), motion.spin.normalized());
      scratch_.dx += (turn.toRotationMatrix() - Eigen::Matrix3d::Identity()) *
                     (start.colwise() - motion.centre);
    }
    scratch_.dx.colwise() += t * motion.drift;
    if (!scratch_.dx.allFinite()) continue;
    findConstraints(h);
    double deepest = 0;
    for (const Contact& c : scratch_.contacts) {
      const double gap = gapAt(c, scratch_.dx.data()) + c.offset - c.found;  // none of it may stay
      deepest = std::max(deepest, std::min(0.0, c.gap_start) - gap);
    }
    if (deepest < kTouchDepth) break;
  }
  if (!scratch_.dx.allFinite()) {
    scratch_.dx.setZero();
    findConstraints(h);  // those that are there may be another body's
  }
  scratch_.total.resize(0);
  scratch_.presses.clear();
  std::fill(multipliers(), multipliers() + 2 * rows_.s, 0.0);
  ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
  restrictToTouching(0);
  x() += scratch_.dx;
  motion.centre += t * motion.drift;
  for (int i = 0; i < n_; ++i) v().col(i) = motion.velocityAt(x().col(i)) + carried.col(i);
  body_.end.setPose(rows_, xData());
  body_.end.projectVelocities(rows_, vData());
  pushVelocities(body_.end, false);
  std::swap(body_.start, body_.end);
  report_.unresolved += !v().allFinite();
  const bool touches = !pins.empty() || !scratch_.touching.empty();
  if (!v().allFinite() || (touches && gainedEnergy(0) > kRounding * kineticEnergy())) {
    limited_ = true;
    v().setZero();
  }
  return h;
}

}  // namespace ragdoll
