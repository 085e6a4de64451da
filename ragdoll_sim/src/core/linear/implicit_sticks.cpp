#include "core/linear/implicit_sticks.h"

#include <algorithm>
#include <cmath>

#include "core/linear/constants.h"

namespace ragdoll {
namespace {

/// Where Newton's method starts: at rest.
void start(const DirectSystem& system, const Eigen::Ref<const Points>& x, ImplicitSticks& s) {
  makeRoom(system, s);
  s.dx.setZero();
  s.D0.noalias() = x * system.B.transpose();
  s.D = s.D0;
  s.sides << system.BW, system.G;
}

/// s.unbalanced and s.stretch at the present dx and lambda; the worst relative stretch.
double findResiduals(const DirectSystem& system, const double* length2, ImplicitSticks& s) {
  s.impulses = s.D * s.lambda.asDiagonal();
  s.unbalanced = s.dx - s.free;
  s.unbalanced.noalias() -= s.impulses * system.BW;
  double worst = 0;
  for (Eigen::Index k = 0; k < s.stretch.size(); ++k) {
    s.stretch[k] = 0.5 * (s.D.col(k).squaredNorm() - length2[k]);
    worst = std::max(worst, 2 * std::abs(s.stretch[k]) / length2[k]);
  }
  return worst;
}

/// s.step and s.change, Newton's for dx and lambda.
void findStep(const DirectSystem& system, ImplicitSticks& s) {
  const Eigen::Index sticks = system.B.rows(), n = system.B.cols();
  // Only tension stiffens; compression would soften and may leave the tangent indefinite.
  s.tangent.setIdentity();
  s.tangent.noalias() -= system.G * s.lambda.cwiseMin(0.0).asDiagonal();
  s.lu.compute(s.tangent);
  s.DB.noalias() = s.unbalanced * system.B.transpose();
  s.solved = s.lu.solve(s.sides);
  const auto moved = s.solved.leftCols(n);
  s.turned_pulls = s.lu.solve(s.DB.transpose());
  s.pulled = s.turned_pulls.transpose();  // DB (I - Lambda G)^-1
  s.system.noalias() = s.D.transpose() * s.D;
  s.system.array() *= s.solved.rightCols(sticks).array();
  for (Eigen::Index k = 0; k < sticks; ++k)
    s.change[k] = -s.stretch[k] + s.D.col(k).dot(s.pulled.col(k));
  s.solution = s.lu.compute(s.system).solve(s.change);
  s.change.swap(s.solution);
  s.step = -s.unbalanced;
  s.impulses = s.DB * s.lambda.cwiseMin(0.0).asDiagonal();
  s.step.noalias() -= s.impulses * moved;
  s.impulses = s.D * s.change.asDiagonal();
  s.step.noalias() += s.impulses * moved;
}

/// How much of the step is taken, so that no stick turns too far.
double shareOf(const DirectSystem& system, const double* length2, double reach, double shortest,
               ImplicitSticks& s) {
  if (reach * std::sqrt(s.step.colwise().squaredNorm().maxCoeff()) <
      kSurelyBelow * kLargestTurn * shortest)
    return 1;
  double share = 1;
  s.turn.noalias() = s.step * system.B.transpose();
  for (Eigen::Index k = 0; k < s.turn.cols(); ++k)
    share = std::min(share,
                     kLargestTurn * std::sqrt(length2[k]) / std::max(1e-300, s.turn.col(k).norm()));
  return share;
}

}  // namespace

void makeRoom(const DirectSystem& system, ImplicitSticks& s) {
  const Eigen::Index sticks = system.B.rows(), n = system.B.cols();
  for (Points* values : {&s.free, &s.dx, &s.unbalanced, &s.step}) values->resize(3, n);
  for (Eigen::MatrixXd* values : {&s.D0, &s.D, &s.impulses, &s.DB, &s.pulled, &s.turn})
    values->resize(3, sticks);
  for (Eigen::MatrixXd* values : {&s.tangent, &s.system}) values->resize(sticks, sticks);
  for (Eigen::MatrixXd* values : {&s.sides, &s.solved}) values->resize(sticks, n + sticks);
  s.turned_pulls.resize(sticks, 3);
  for (Eigen::VectorXd* values : {&s.lambda, &s.stretch, &s.change, &s.solution})
    values->resize(sticks);
  if (s.lu.rows() != sticks) s.lu = Eigen::PartialPivLU<Eigen::MatrixXd>(sticks);
}

bool moveImplicitly(const DirectSystem& system, const double* length2,
                    const Eigen::Ref<const Points>& x, ImplicitSticks& s) {
  const Eigen::Map<const Eigen::VectorXd> lengths2(length2, system.B.rows());
  const double longest = std::sqrt(lengths2.maxCoeff()), shortest = std::sqrt(lengths2.minCoeff());
  // Of a particle's motion, on the ends of sticks.
  const double reach = system.B.cwiseAbs().rowwise().sum().maxCoeff();
  start(system, x, s);
  for (int iteration = 0; iteration < kMaxImplicitNewton; ++iteration) {
    if (iteration > 0) {
      s.D.noalias() = s.dx * system.B.transpose();
      s.D += s.D0;
    }
    const double worst = findResiduals(system, length2, s);
    if (!std::isfinite(worst) || !s.unbalanced.allFinite()) return false;
    const double balance = kBalance * longest + kMotionRounding * s.free.cwiseAbs().maxCoeff();
    if (worst < kLengthTolerance && s.unbalanced.cwiseAbs().maxCoeff() < balance) return true;
    findStep(system, s);
    const double share = shareOf(system, length2, reach, shortest, s);
    if (!(share > kNoProgress)) return false;
    s.dx += share * s.step;
    s.lambda += share * s.change;
  }
  return false;
}

}  // namespace ragdoll
