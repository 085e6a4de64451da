#include "ragdoll_sim/core/inputs.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

namespace ragdoll {

Inputs startInputs(const Model& model) { return {model.pokes, {}, {}}; }

bool isActive(const Poke& poke, double time, double h) {
  const double now = std::round(time / h);
  const double first = std::max(0.0, std::round(poke.start / h));
  if (now < first) return false;
  if (poke.duration < 0) return true;
  return now < first + std::max(1.0, std::round(poke.duration / h));
}

bool actsBefore(const Poke& a, const Poke& b, double h) {
  const auto key = [h](const Poke& p) {
    return std::make_tuple(std::round(p.start / h), std::cref(p.body_name), p.force.x(),
                           p.force.y(), p.force.z(), p.point.x(), p.point.y(), p.point.z());
  };
  return key(a) < key(b);
}

void addForce(const Poke& poke, const State& state, Points& forces) {
  const BodyRef& body = poke.body;
  const Eigen::Index k = static_cast<Eigen::Index>(body.particles.size());
  for (Eigen::Index i = 0; i < k; ++i) forces.col(body.particles[i]) += poke.force * body.weight[i];
  if (k < 2 || poke.point.isZero()) return;
  // Forces w_i (alpha x r_i) about the weighted mean have no sum; alpha from K alpha = moment. K is
  // singular about a bone's own axis, where the minimum-norm solution gives no force.
  Vec3 mean = Vec3::Zero();
  for (Eigen::Index i = 0; i < k; ++i) mean += body.weight[i] * state.x.col(body.particles[i]);
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < k; ++i) {
    const Vec3 r = state.x.col(body.particles[i]) - mean;
    K += body.weight[i] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> decomposition;
  decomposition.setThreshold(1e-9);
  decomposition.compute(K);
  const Vec3 alpha = decomposition.solve(poke.point.cross(poke.force));
  for (Eigen::Index i = 0; i < k; ++i) {
    const Vec3 r = state.x.col(body.particles[i]) - mean;
    forces.col(body.particles[i]) += body.weight[i] * alpha.cross(r);
  }
}

}  // namespace ragdoll
