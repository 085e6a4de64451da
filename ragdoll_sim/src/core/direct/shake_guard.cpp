#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr int kMaxPieces =
    64;  ///< of implicit steps; beyond, the rest of the step is one rigid motion
constexpr int kMaxDriven = 4;  ///< the same while obstacles or pins move

}  // namespace

void ShakeStep::guard(double h) {
  enum class Way { kExplicit, kImplicit, kRigid };
  if (ws_.unguarded) {
    for (double left = h; left > 1e-9 * h;) left -= explicitStep(left);
    return;
  }
  const double wanted = isSoft(h) ? 1 : std::ceil(h * std::sqrt(stiffness()) / kStable);
  const bool relaxes = model_.solver.method == Method::kJakobsen;  // backward Euler as it is
  Way way =
      !relaxes && wanted <= kMaxSubsteps ? Way::kExplicit : Way::kImplicit;  // also not a number
  double sub = way == Way::kExplicit ? h / std::max(1.0, wanted) : h;
  double left = h;
  int taken = 0;
  bool guarded = way != Way::kExplicit;
  // Obstacles that squeeze a body leave no solution, and smaller steps do not find one.
  const auto most = [&] { return isSqueezed() ? 1 : driven_ ? kMaxDriven : kMaxSubsteps; };
  while (left > 1e-9 * h) {
    sub = std::min(sub, left);
    save();
    failed_ = false;
    double took = 0;
    if (way == Way::kExplicit) {
      took = explicitStep(sub);
      const bool smooth = !failed_ && isSmooth();
      const double rise = failed_ || (smooth && !swings(took)) ? 0 : energyRise(smooth);
      const bool can_halve = sub > 1.01 * h / (isSqueezed() ? 1 : kMaxSubsteps);
      const bool outgrown = can_halve && !isSoft(sub) && sub * std::sqrt(stiffness()) > 2 * kStable;
      const bool jumped = 0.5 * sub > 0.99 * h / most() && tensionJumped(took);
      const bool much =
          smooth ? isLargeSwing(rise) : rise > kRedoRise && rise > kRedoRise * kineticEnergy();
      failed_ = failed_ || outgrown || jumped || (can_halve && much);
      const bool swing = smooth && !(much && !scratch_.presses.empty());  // it comes back
      if (!failed_ && rise > 0 && !swing) failed_ = !limitEnergy(rise);
    } else {
      guarded = true;
      took = way == Way::kImplicit ? implicitStep(sub) : rigidStep(sub);
    }
    if (failed_) {
      restore();
      if (hasNoWayOut()) {
        squeezed_ = Squeezed::kDeep;
        sub = left;
        continue;
      }
      if (way == Way::kExplicit) {
        sub *= 0.5;
        if (sub < 0.99 * h / most()) {
          way = Way::kImplicit;
          sub = left;
        }
      } else {
        sub *= 0.25;
        if (sub < 0.99 * h / (most() == kMaxSubsteps ? kMaxPieces : most())) {
          if (squeezed_ < Squeezed::kAll && overlap_ >= kTouching)
            squeezed_ = Squeezed::kAll;
          else if (squeezed_ == Squeezed::kAll && pin_speed_ > 0)
            squeezed_ = Squeezed::kThrough;
          else
            way = Way::kRigid;
          sub = left;
        }
      }
      continue;
    }
    left -= took;
    ++taken;
  }
  report_.substeps = std::max(report_.substeps, taken);
  report_.guarded += guarded || squeezed_ != Squeezed::kNo || taken > 1 + located_;
  report_.unresolved += squeezed_ != Squeezed::kNo;
  report_.limited += limited_;
  if (guarded || limited_) makeAffine();  // rigid velocities carry what is off it along
}

bool ShakeStep::isSqueezed() const {
  if (overlap_ <= kSqueezed) return false;
  const std::vector<Contact>& all = scratch_.contacts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].gap_start > -kTouching) continue;
    if (all[i].count == 4) return true;
    for (std::size_t j = 0; j < all.size(); ++j)
      if (all[j].gap_start < kTouching && all[i].normal.dot(all[j].normal) < 0) return true;
  }
  return false;
}

double ShakeStep::explicitStep(double h) {
  const double took = model_.solver.method == Method::kRk ? advanceSmooth(h) : advance(h);
  if (!v().allFinite() || !x().allFinite()) failed_ = true;
  return took;
}

bool ShakeStep::isSoft(double h) {
  if (rows_.s == 0) return true;
  const double most =
      Eigen::Map<const Eigen::VectorXd>(multipliers(), rows_.s).cwiseAbs().maxCoeff();
  return 2 * most * rows_.largest_row * h * h < kStable * kStable;
}

bool ShakeStep::swings(double h) {
  return !isSoft(h / kSwing) && h * std::sqrt(stiffness()) > kSwing * kStable;
}

bool ShakeStep::tensionJumped(double h) {
  if (isSoft(h / kJump)) return false;
  const double now = stiffness();
  return h * std::sqrt(now) > kJump * kStable &&
         now > 4 * stiffnessOf(scratch_.saved_multipliers.data());
}

double ShakeStep::stiffness() { return stiffnessOf(multipliers()); }

double ShakeStep::stiffnessOf(const double* multipliers) {
  const Eigen::Map<const Eigen::VectorXd> m(multipliers, rows_.s);
  scratch_.residual.setZero(rows_.width);
  scratch_.residual.head(rows_.s) = 2 * m.cwiseAbs();
  scratch_.correction.resize(rows_.width);
  kernels::multiply(rows_.absolute_G.data(), scratch_.residual.data(), rows_.s, rows_.width,
                    scratch_.correction.data());
  return rows_.s > 0 ? scratch_.correction.maxCoeff() : 0;
}

void ShakeStep::save() {
  located_before_ = located_;
  scratch_.saved_x = x();
  scratch_.saved_v = v();
  scratch_.saved_multipliers.assign(multipliers(), multipliers() + 2 * rows_.s);
  scratch_.saved_presses = scratch_.presses;
}

void ShakeStep::restore() {
  x() = scratch_.saved_x;
  v() = scratch_.saved_v;
  std::copy(scratch_.saved_multipliers.begin(), scratch_.saved_multipliers.end(), multipliers());
  scratch_.presses = scratch_.saved_presses;
}

}  // namespace ragdoll
