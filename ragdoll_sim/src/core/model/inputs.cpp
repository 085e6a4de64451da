#include "ragdoll_sim/core/inputs.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

constexpr double kThinBody = 1e-3;  ///< thickness^2 over length^2 of what has no sides to push at
constexpr double kToldLoss = 1e-3;  ///< of a poke's moment: less is not told

/// How forces w_i (alpha x r_i) about the weighted mean, which have no sum, turn a body: their
/// moment is K alpha.
struct Turning {
  Vec3 mean = Vec3::Zero();
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
};

Turning turningOf(const BodyRef& body, const Eigen::Ref<const Points>& x, int first) {
  Turning turning;
  const Eigen::Index k = static_cast<Eigen::Index>(body.particles.size());
  for (Eigen::Index i = 0; i < k; ++i)
    turning.mean += body.weight[i] * x.col(body.particles[i] - first);
  for (Eigen::Index i = 0; i < k; ++i) {
    const Vec3 r = x.col(body.particles[i] - first) - turning.mean;
    turning.K +=
        body.weight[i] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return turning;
}

/// alpha of the moment. K is singular about the axis of a bone, where the minimum-norm solution
/// gives no force, and nearly so about that of points in line, which the relaxation bends a little.
Vec3 turn(const Turning& turning, const Vec3& moment) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> decomposition;
  decomposition.setThreshold(kThinBody);
  decomposition.compute(turning.K);
  return decomposition.solve(moment);
}

}  // namespace

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
  addForce(poke, state.x, 0, forces);
}

void addForce(const Poke& poke, const Eigen::Ref<const Points>& x, int first, Points& forces) {
  const BodyRef& body = poke.body;
  const Eigen::Index k = static_cast<Eigen::Index>(body.particles.size());
  for (Eigen::Index i = 0; i < k; ++i)
    forces.col(body.particles[i] - first) += poke.force * body.weight[i];
  if (k < 2 || poke.point.isZero()) return;
  const Turning turning = turningOf(body, x, first);
  const Vec3 alpha = turn(turning, poke.point.cross(poke.force));
  for (Eigen::Index i = 0; i < k; ++i) {
    const Vec3 r = x.col(body.particles[i] - first) - turning.mean;
    forces.col(body.particles[i] - first) += body.weight[i] * alpha.cross(r);
  }
}

std::string lostMomentText(const Poke& poke, const Points& x) {
  const Vec3 moment = poke.point.cross(poke.force);
  Vec3 lost = moment;
  if (poke.body.particles.size() > 1) {
    const Turning turning = turningOf(poke.body, x, 0);
    lost -= turning.K * turn(turning, moment);
  }
  if (!(lost.norm() > kToldLoss * moment.norm())) return {};
  return numberText(std::round(1e3 * lost.norm()) * 1e-3) + " N m of its moment of " +
         numberText(std::round(1e3 * moment.norm()) * 1e-3) + " N m have no effect: " +
         (poke.body.particles.size() > 1 ? "a bone takes none about its own axis"
                                         : "a particle takes none");
}

}  // namespace ragdoll
