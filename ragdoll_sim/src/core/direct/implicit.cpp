#include "core/direct/implicit.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/linear/constants.h"

namespace ragdoll {

namespace {

/// Where Newton's method starts: at rest, with the tension of the last motion.
void start(const Body& body, double h, ImplicitScratch& s) {
  const int sticks = body.rows->s;
  s.lambda = Eigen::Map<const Eigen::VectorXd>(body.multipliers(), sticks) * (h * h);
  if (!s.lambda.allFinite()) s.lambda.setZero();
  s.dx.setZero(3, body.n);
  s.D0.noalias() = body.x() * body.system->B.transpose();
  s.D = s.D0;
  s.tangent.resize(sticks, sticks);
  s.stretch.resize(sticks);
  s.change.resize(sticks);
  s.sides.resize(sticks, body.n + sticks);
  s.sides << body.system->BW, body.system->G;
}

/// s.unbalanced and s.stretch at the present dx and lambda; the worst relative stretch.
double findResiduals(const Body& body, ImplicitScratch& s) {
  const double* length2 = body.lengths.length2;
  s.impulses = s.D * s.lambda.asDiagonal();
  s.unbalanced = s.dx - s.free;
  s.unbalanced.noalias() -= s.impulses * body.system->BW;
  double worst = 0;
  for (int k = 0; k < body.rows->s; ++k) {
    s.stretch[k] = 0.5 * (s.D.col(k).squaredNorm() - length2[k]);
    worst = std::max(worst, 2 * std::abs(s.stretch[k]) / length2[k]);
  }
  return worst;
}

/// s.step and s.change, Newton's for dx and lambda.
void findStep(const Body& body, ImplicitScratch& s) {
  const int n = body.n, sticks = body.rows->s;
  // Only tension stiffens; compression would soften and may leave the tangent indefinite.
  s.tangent.setIdentity();
  s.tangent.noalias() -= body.system->G * s.lambda.cwiseMin(0.0).asDiagonal();
  s.lu.compute(s.tangent);
  s.DB.noalias() = s.unbalanced * body.system->B.transpose();
  s.solved = s.lu.solve(s.sides);
  const auto moved = s.solved.leftCols(n);
  s.turned_pulls = s.lu.solve(s.DB.transpose());
  s.pulled = s.turned_pulls.transpose();  // DB (I - Lambda G)^-1
  s.system.noalias() = s.D.transpose() * s.D;
  s.system.array() *= s.solved.rightCols(sticks).array();
  for (int k = 0; k < sticks; ++k) s.change[k] = -s.stretch[k] + s.D.col(k).dot(s.pulled.col(k));
  s.solution = s.lu.compute(s.system).solve(s.change);
  s.change.swap(s.solution);
  s.step = -s.unbalanced;
  s.impulses = s.DB * s.lambda.cwiseMin(0.0).asDiagonal();
  s.step.noalias() -= s.impulses * moved;
  s.impulses = s.D * s.change.asDiagonal();
  s.step.noalias() += s.impulses * moved;
}

/// How much of the step is taken, so that no stick turns too far.
double shareOf(const Body& body, double reach, double shortest, ImplicitScratch& s) {
  if (reach * std::sqrt(s.step.colwise().squaredNorm().maxCoeff()) < 0.98 * kLargestTurn * shortest)
    return 1;
  double share = 1;
  s.turn.noalias() = s.step * body.system->B.transpose();
  for (int k = 0; k < body.rows->s; ++k)
    share = std::min(share, kLargestTurn * std::sqrt(body.lengths.length2[k]) /
                                std::max(1e-300, s.turn.col(k).norm()));
  return share;
}

}  // namespace

bool solveImplicitMotion(Body& body, double h) {
  const int sticks = body.rows->s;
  ImplicitScratch& s = body.implicit;
  s.free = h * body.v() + (h * h) * body.acceleration;
  body.motion.lambda.setZero(body.rows->width);
  body.motion.dx = s.free;
  if (sticks == 0) return s.free.allFinite();
  const Eigen::Map<const Eigen::VectorXd> length2(body.lengths.length2, sticks);
  const double longest = std::sqrt(length2.maxCoeff()), shortest = std::sqrt(length2.minCoeff());
  // Of a particle's motion, on the ends of sticks.
  const double reach = body.system->B.cwiseAbs().rowwise().sum().maxCoeff();
  start(body, h, s);
  for (int iteration = 0; iteration < kMaxImplicitNewton; ++iteration) {
    if (iteration > 0) {
      s.D.noalias() = s.dx * body.system->B.transpose();
      s.D += s.D0;
    }
    const double worst = findResiduals(body, s);
    if (!std::isfinite(worst) || !s.unbalanced.allFinite()) return false;
    const double balance = kBalance * longest + 1e-12 * s.free.cwiseAbs().maxCoeff();
    if (worst < kLengthTolerance && s.unbalanced.cwiseAbs().maxCoeff() < balance) {
      body.motion.dx = s.dx;
      body.motion.lambda.head(sticks) = s.lambda;
      return true;
    }
    findStep(body, s);
    const double share = shareOf(body, reach, shortest, s);
    if (!(share > 1e-12)) return false;
    s.dx += share * s.step;
    s.lambda += share * s.change;
  }
  return false;
}

}  // namespace ragdoll
