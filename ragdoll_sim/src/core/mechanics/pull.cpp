#include "ragdoll_sim/core/pull.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace ragdoll {
namespace {

const Ragdoll& ragdollOf(const Model& model, int particle) {
  return *std::find_if(model.ragdolls.rbegin(), model.ragdolls.rend(),
                       [&](const Ragdoll& r) { return r.first <= particle; });
}

}  // namespace

Eigen::Matrix3d mobility(const Model& model, const State& state, int particle) {
  const Ragdoll& r = ragdollOf(model, particle);
  const DirectSystem& d = model.systemOf(r).direct;
  const int p = particle - r.first;
  Eigen::Matrix3d A = d.W(p, p) * Eigen::Matrix3d::Identity();
  if (d.B.rows() == 0) return A;
  // U = J W e_p: what the force alone would do to the sticks; they answer with S^-1 U.
  const Eigen::MatrixXd D = state.x.middleCols(r.first, d.B.cols()) * d.B.transpose();
  const Eigen::MatrixXd S = d.G.cwiseProduct(D.transpose() * D);
  const Eigen::MatrixXd U = (D * d.BW.col(p).asDiagonal()).transpose();
  return A - U.transpose() * S.ldlt().solve(U);
}

Vec3 pullForce(const Model& model, const State& state, int particle, const Vec3& target) {
  const double h = model.solver.step, w = kPullRate;
  const Vec3 v = state.v.col(particle);
  Vec3 away = target - state.x.col(particle);
  away *= std::min(1.0, kPullReach / std::max(away.norm(), 1e-300));
  const Vec3 a = (w * w * away - (2 * w + h * w * w) * v) / ((1 + h * w) * (1 + h * w));

  // No direction is heavier than the whole body, unless a pin holds it.
  const double whole = model.skeletonOf(ragdollOf(model, particle)).M.sum();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> A(mobility(model, state, particle));
  if (!(A.eigenvalues().maxCoeff() > 0)) return Vec3::Zero();
  const Vec3 mass = A.eigenvalues().cwiseMax(1 / whole).cwiseInverse();
  return A.eigenvectors() * mass.asDiagonal() * A.eigenvectors().transpose() * a;
}

}  // namespace ragdoll
