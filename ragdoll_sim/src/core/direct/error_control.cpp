#include "core/direct/error_control.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"

namespace ragdoll {

ErrorControl::ErrorControl(double h, double tolerance, double& next)
    : h_(h),
      tolerance_(tolerance),
      shortest_(kShortestPart * std::sqrt(tolerance)),
      next_(next),
      left_(h) {
  if (!(next_ > 0)) next_ = h;
  choosePart();
}

bool ErrorControl::done() const { return !(left_ > kNothingLeft * h_); }

double ErrorControl::from() const { return h_ - left_; }

void ErrorControl::choosePart() {
  const double longest = std::min(next_, left_);
  part_ = longest > 0 ? left_ / std::ceil(left_ / longest - kSnap) : 0;
}

double ErrorControl::allowed(int order) const {
  const double rest = tolerance_ * h_ - spent_ - kReserved * tolerance_ * (left_ - part_);
  const bool free = order == kOrderOfRk;  // there is no event that could take it
  return free ? std::min(rest, tolerance_ * part_) : rest;
}

bool ErrorControl::helps(double rate, int order) {
  const bool known = rate < kUnknownRate;
  if (other_rate_ > 0 && known == (other_rate_ < kUnknownRate)) {
    const double least = other_rate_ * std::pow(part_ / other_part_, kLeastOfOrder * order);
    in_vain_ = part_ <= other_part_ ? (rate > least ? in_vain_ + 1 : 0)
                                    : (rate < least || !known ? in_vain_ : 0);
  } else {
    in_vain_ = 0;
  }
  other_rate_ = rate;
  other_part_ = part_;
  return in_vain_ < (known ? kMaxInVain : kMaxUnknown);
}

bool ErrorControl::accepts(double error, int order) {
  const double may_have = allowed(order);
  const double rate = error / part_, allowed_rate = may_have / part_;
  const bool kept = rate <= allowed_rate;
  const double wanted = std::pow(kAim * allowed_rate / std::max(rate, 1e-300), 1.0 / order);
  const double growth = std::clamp(wanted, 1 / kLargestGrowth, kLargestGrowth);
  // Where the guard acts, as limbs are whipped, it may be known by one more shortening.
  const double shortest = rate < kUnknownRate ? shortest_ : shortest_ / kLargestGrowth;
  if (!kept && part_ > kShortEnough * shortest && helps(rate, order)) {
    next_ = std::max(part_ * growth, shortest);
    choosePart();
    return false;
  }
  // One that stands is no reason for shorter ones: where they gain nothing they would have no end.
  // Where shorter parts were in vain the next one is longer: behind one jump the motion is as any
  // other; if shorter ones are in vain there, too, what follows is held against this one. One that
  // is known where longer ones were not was not in vain.
  const double steady = other_rate_ > 0 ? 1 : std::max(growth, 1.0);
  next_ = std::min(part_ * (kept ? steady : kLargestGrowth), h_);
  const bool others_unknown = !(other_rate_ < kUnknownRate);
  if (kept || ((last_kept_ || others_unknown) && rate < kUnknownRate)) {
    other_rate_ = 0;
    in_vain_ = 0;
  }
  last_kept_ = kept;
  missed_ = missed_ || !kept;
  if (rate < kUnknownRate) made_ += error;
  spent_ += std::min(error, may_have);
  left_ -= part_;
  ++taken_;
  choosePart();
  return true;
}

void ErrorControl::takeRest(double error) {
  missed_ = missed_ || error > tolerance_ * left_;
  made_ += error;
  left_ = 0;
  ++taken_;
}

void ErrorControl::tell(int bodies, StepReport& report) const {
  report.substeps = std::max(report.substeps, taken_);
  report.error_estimate = std::max(report.error_estimate, made_ / h_);
  if (missed_) report.tolerance_missed += bodies;
}

}  // namespace ragdoll
