#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/shake_step.h"

namespace ragdoll {
namespace {

constexpr double kStable = 1.0;     ///< h sqrt(Omega2) of a substep; 2 is the edge of stability
constexpr int kMaxSubsteps = 16;    ///< above, one implicit step is cheaper
constexpr int kMaxImplicit = 60;    ///< Newton iterations of an implicit step
constexpr double kRedoRise = 1e-3;  ///< of the kinetic energy (1 J at least): done again at half

}  // namespace

void ShakeStep::guard(double h) {
  int count = std::max(1, static_cast<int>(std::ceil(h * std::sqrt(stiffness()) / kStable)));
  int taken = 0;
  double left = h;
  bool implicit = count > kMaxSubsteps;
  double sub = implicit ? h : h / count;
  while (left > 1e-9 * h) {
    sub = std::min(sub, left);
    save();
    failed_ = false;
    double took = 0;
    if (implicit) {
      took = implicitStep(sub);
    } else {
      took = model_.solver.method == Method::kRk ? advanceSmooth(sub, taken)
                                                 : advance(sub, taken < kMaxBounces);
      const bool outgrown = sub * std::sqrt(stiffness()) > 2 * kStable && sub > h / kMaxSubsteps;
      if (failed_ || outgrown || !v().allFinite()) {
        restore();
        sub *= 0.5;
        if (sub < 0.99 * h / kMaxSubsteps) {
          implicit = true;
          sub = left;
        }
        continue;
      }
      const double rise = energyRise();
      if (rise > kRedoRise && rise > kRedoRise * kineticEnergy() && sub > 1.01 * h / kMaxSubsteps) {
        restore();
        sub *= 0.5;
        continue;
      }
      if (rise > 0) limitEnergy(rise);
    }
    left -= took;
    ++taken;
  }
  report_.substeps = std::max(report_.substeps, taken);
  report_.guarded += implicit || taken > 1;
  report_.limited += limited_;
}

double ShakeStep::stiffness() {
  const Eigen::Map<const Eigen::VectorXd> m(multipliers(), rows_.s);
  scratch_.residual.setZero(rows_.width);
  scratch_.residual.head(rows_.s) = 2 * m.cwiseAbs();
  scratch_.correction.resize(rows_.width);
  kernels::multiply(rows_.absolute_G.data(), scratch_.residual.data(), rows_.s, rows_.width,
                    scratch_.correction.data());
  return rows_.s > 0 ? scratch_.correction.maxCoeff() : 0;
}

void ShakeStep::save() {
  scratch_.saved_x = x();
  scratch_.saved_v = v();
  scratch_.saved_multipliers.assign(multipliers(), multipliers() + 2 * rows_.s);
}

void ShakeStep::restore() {
  x() = scratch_.saved_x;
  v() = scratch_.saved_v;
  std::copy(scratch_.saved_multipliers.begin(), scratch_.saved_multipliers.end(), multipliers());
}

double ShakeStep::implicitStep(double h) {
  ++report_.implicit;
  scratch_.dx = h * v() + (h * h) * scratch_.acceleration;
  scratch_.lambda.setZero(rows_.width);
  body_.start.setPose(rows_, xData());
  relaxAlongNew();
  findConstraints(h);
  press(h, false);
  finish(h, false);
  for (int s = 0; s < rows_.s; ++s)
    multipliers()[s] = multipliers()[s + rows_.s] = scratch_.lambda[s] / (h * h);
  return h;
}

bool ShakeStep::relaxAlongNew() {
  for (int iteration = 0; iteration < kMaxImplicit; ++iteration) {
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    body_.end.setPose(rows_, ws_.x1.data() + 3 * ragdoll_.first);
    const Eigen::Map<const PaddedRows> D(body_.end.D(), 3, rows_.width);
    double worst = 0;
    scratch_.residual.setZero(rows_.width);
    for (int s = 0; s < rows_.s; ++s) {
      // (L / |d| - 1) |d|^2: the length itself, not its square, so that far sticks come in
      // evenly.
      const double q = std::max(D.col(s).squaredNorm(), kMinLength * kMinLength);
      scratch_.residual[s] = std::sqrt(rows_.length2[s] * q) - q;
      worst = std::max(worst, std::abs(rows_.length2[s] - q) / rows_.length2[s]);
    }
    if (worst < kTolerance) return true;
    body_.end.solve(rows_, scratch_.residual.data());
    scratch_.lambda += scratch_.residual;
    body_.end.move(rows_, scratch_.residual.data(), 1, scratch_.dx.data());
  }
  ++report_.unresolved;
  return false;
}

}  // namespace ragdoll
