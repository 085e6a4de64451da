#include "core/limits/limit_projection.h"

#include <algorithm>

#include "core/limits/constants.h"

namespace ragdoll {
namespace {

void moveLumped(const LimitRow& row, const Eigen::MatrixXd& W, int first, double lambda,
                Points& x) {
  for (int k = 0; k < row.count; ++k) {
    const int i = row.particle[k] - first;
    x.col(row.particle[k]) += lambda * W(i, i) * row.gradient[k];
  }
}

void moveDense(const LimitRow& row, const Eigen::MatrixXd& W, int first, double lambda, Points& x) {
  for (int k = 0; k < row.count; ++k) {
    const Vec3 impulse = lambda * row.gradient[k];
    for (Eigen::Index j = 0; j < W.rows(); ++j)
      x.col(first + j) += W(j, row.particle[k] - first) * impulse;
  }
}

/// gradient W gradient^T [1 / (kg m^2)]
double inverseInertia(const LimitRow& row, const System& system, int first) {
  double w = 0;
  for (int k = 0; k < row.count; ++k) {
    const int i = row.particle[k] - first;
    w += system.W(i, i) * row.gradient[k].squaredNorm();
    if (system.lumped) continue;
    for (int l = 0; l < k; ++l)
      w += 2 * system.W(i, row.particle[l] - first) * row.gradient[k].dot(row.gradient[l]);
  }
  return w;
}

}  // namespace

void LimitProjection::prepare(const Model& model, const State& state, const Points& x1, double h) {
  findLimits(model, x1, state, kNearLimit, found_);
  listPlanes(model, state, found_);  // all: whether they allow it shows in the sweeps
  rows_.clear();
  for (const LimitRow& limit : found_) {
    Row row;
    row.limit = limit;
    startLimit(model, state.x, row.limit);
    row.softness = row.limit.eulerSoftness(h);
    evaluate(model, x1, row);
    rows_.push_back(row);
  }
}

void LimitProjection::evaluate(const Model& model, const Points& x, Row& row) const {
  LimitRow& limit = row.limit;
  evaluateLimit(model, x, limit);
  row.offset = limit.value;
  for (int k = 0; k < limit.count; ++k)
    row.offset -= limit.gradient[k].dot(x.col(limit.particle[k]));
  const Ragdoll& ragdoll = model.ragdolls[limit.ragdoll];
  row.w = inverseInertia(limit, model.systemOf(ragdoll), ragdoll.first);
}

bool LimitProjection::isInside(const Row& row, const Points& x) const {
  if (row.limit.limit < 0 || row.lambda > 0) return false;
  double value = row.offset;
  for (int k = 0; k < row.limit.count; ++k)
    value += row.limit.gradient[k].dot(x.col(row.limit.particle[k]));
  return value > 0;
}

void LimitProjection::project(const Model& model, Row& row, Points& x) const {
  if (isInside(row, x)) return;
  evaluate(model, x, row);
  const LimitRow& limit = row.limit;
  // w = 0: all held by pins, or planes that allow where the child is.
  if (!(row.w > 0) || (limit.value >= 0 && row.lambda == 0)) return;
  const LimitRow::Softness& soft = row.softness;
  const double wanted = -limit.value - soft.offset - soft.compliance * row.lambda;
  const double lambda = std::max(0.0, row.lambda + wanted / (row.w + soft.compliance));
  const double change = lambda - row.lambda;
  row.lambda = lambda;
  const Ragdoll& ragdoll = model.ragdolls[limit.ragdoll];
  const System& system = model.systemOf(ragdoll);
  system.lumped ? moveLumped(limit, system.W, ragdoll.first, change, x)
                : moveDense(limit, system.W, ragdoll.first, change, x);
}

void LimitProjection::sweep(const Model& model, Points& x) {
  for (Row& row : rows_) project(model, row, x);
}

}  // namespace ragdoll
