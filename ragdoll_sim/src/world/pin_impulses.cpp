#include "pin_impulses.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "ragdoll_sim/core/limits.h"

namespace ragdoll {
namespace {

constexpr double kMayPress = 1e-2;  ///< [rad] limits that may press are nearer than that

/// Gradients (3 x n) of the limits that may press.
std::vector<Points> limitDirections(const Model& model, int ragdoll, const Points& x) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  std::vector<Points> directions;
  for (std::size_t k = 0; k < s.limits.size(); ++k) {
    LimitRow row = limitRow(model, ragdoll, static_cast<int>(k));
    if (valueAt(model, x, row) > kMayPress) continue;
    evaluateLimit(model, x, row);
    Points& direction = directions.emplace_back(Points::Zero(3, s.size()));
    for (int i = 0; i < row.count; ++i) direction.col(row.particle[i] - r.first) += row.gradient[i];
  }
  return directions;
}

/// [1] of the impulse on each of a stick's ends, by where it presses.
Eigen::Vector2d sharesOf(const std::array<int, 2>& particle, const Vec3& point, const Points& x) {
  if (particle[1] < 0) return {1, 0};
  const Vec3 a = x.col(particle[0]), along = x.col(particle[1]) - a;
  const double t = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return {1 - t, t};
}

/// Columns of the pins, particles of the skeleton.
std::vector<int> pinsOf(const Model& model, int ragdoll) {
  std::vector<int> pins;
  for (const Pin& pin : model.pins)
    if (pin.ragdoll == ragdoll) pins.push_back(pin.particle - model.ragdolls[ragdoll].first);
  return pins;
}

Eigen::VectorXd flat(const Eigen::Ref<const Points>& points) {
  return Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
}

}  // namespace

Points unexplained(const Model& model, const Inputs& inputs,
                   const std::vector<ContactImpulse>& contacts, const Points& before,
                   const Points& x, const State& state, int ragdoll) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  const double h = model.solver.step, time = state.time - h;
  const auto was = before.middleCols(r.first, s.size());
  Points gained = state.v.middleCols(r.first, s.size()) - was;
  gained.colwise() -= h * model.gravity;
  if (model.solver.damping > 0) gained += (1 - std::exp(-model.solver.damping * h)) * was;
  Points rest = gained * s.M;
  for (const Poke& poke : inputs.pokes) {
    if (poke.body.ragdoll != ragdoll || !isActive(poke, time, h)) continue;
    for (std::size_t k = 0; k < poke.body.particles.size(); ++k)
      rest.col(poke.body.particles[k] - r.first) -= h * poke.body.weight[k] * poke.force;
  }
  const auto give = [&](const std::array<int, 2>& particle, const Vec3& point,
                        const Vec3& impulse) {
    const Eigen::Vector2d shares = sharesOf(particle, point, x);
    for (int end = 0; end < 2; ++end)
      if (particle[end] >= 0) rest.col(particle[end] - r.first) -= shares[end] * impulse;
  };
  for (const ContactImpulse& c : contacts) {
    if (c.ragdoll == ragdoll) give(c.particle, c.point, c.impulse);
    const int other = c.obstacle >= 0 ? -1 : c.other >= 0 ? c.other : c.ragdoll;
    if (other == ragdoll) give(c.other_particle, c.point, -c.impulse);
  }
  return rest;
}

std::vector<Vec3> impulsesByPins(const Model& model, int ragdoll, const Points& x,
                                 const Points& rest) {
  const std::vector<int> pins = pinsOf(model, ragdoll);
  if (pins.size() == 1) return {rest.rowwise().sum()};
  const Ragdoll& r = model.ragdolls[ragdoll];
  const DirectSystem& system = model.systemOf(r).direct;
  const int n = static_cast<int>(rest.cols());
  const int sticks = static_cast<int>(system.B.rows()), count = static_cast<int>(pins.size());
  // Forces that keep groups in shape do no work on motions that do: affine takes them out.
  const Points D = x.middleCols(r.first, n) * system.B.transpose();
  const Eigen::MatrixXd B = system.B * system.affine;
  const std::vector<Points> limits = limitDirections(model, ragdoll, x);
  Eigen::MatrixXd A(3 * n, 3 * count + sticks + static_cast<int>(limits.size()));
  int column = 0;
  for (const int pin : pins)
    for (int axis = 0; axis < 3; ++axis) {
      Points unit = Points::Zero(3, n);
      unit.row(axis) = system.affine.row(pin);
      A.col(column++) = flat(unit);
    }
  for (int k = 0; k < sticks; ++k) {
    const Points along = D.col(k).normalized() * B.row(k);
    A.col(column++) = flat(along);
  }
  for (const Points& direction : limits) {
    const Points kept = direction * system.affine;
    A.col(column++) = flat(kept);
  }
  const Points wanted = rest * system.affine;
  const Eigen::VectorXd found =
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(A).solve(flat(wanted));
  std::vector<Vec3> impulses(count);
  Vec3 sum = Vec3::Zero();
  for (int p = 0; p < count; ++p) sum += impulses[p] = found.segment<3>(3 * p);
  const Vec3 missing = rest.rowwise().sum() - sum;
  for (Vec3& impulse : impulses) impulse += missing / count;
  return impulses;
}

}  // namespace ragdoll
