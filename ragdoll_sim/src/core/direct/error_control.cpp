#include "core/direct/error_control.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"

namespace ragdoll {

ErrorControl::ErrorControl(double h, double tolerance, double& next)
    : h_(h), tolerance_(tolerance), next_(next), left_(h) {
  if (!(next_ > 0)) next_ = h;
  choosePart();
}

bool ErrorControl::done() const { return !(left_ > kNothingLeft * h_); }

double ErrorControl::from() const { return h_ - left_; }

void ErrorControl::choosePart() {
  const double longest = std::min(next_, left_);
  part_ = longest > 0 ? left_ / std::ceil(left_ / longest - kSnap) : 0;
}

bool ErrorControl::helps(double rate, int order) {
  const bool known = rate < kUnknownRate;
  if (rejected_rate_ > 0 && known == (rejected_rate_ < kUnknownRate)) {
    const double expected = std::pow(part_ / rejected_part_, order);
    in_vain_ = rate > rejected_rate_ * std::pow(expected, kLeastOfOrder) ? in_vain_ + 1 : 0;
  } else {
    in_vain_ = 0;
  }
  rejected_rate_ = rate;
  rejected_part_ = part_;
  return in_vain_ < (known ? kMaxInVain : kMaxUnknown);
}

bool ErrorControl::accepts(double error, int order) {
  const double rate = error / part_;
  const double wanted = std::pow(kAim * tolerance_ / std::max(rate, 1e-300), 1.0 / order);
  double growth = std::clamp(wanted, 1 / kLargestGrowth, kLargestGrowth);
  const bool kept = rate <= tolerance_;
  if (!kept && part_ > kShortestPart && helps(rate, order)) {
    first_try_ = std::max(first_try_, part_);
    next_ = part_ * growth;
    choosePart();
    return false;
  }
  // One that stands is no reason for shorter ones: where they gain nothing they would have no end.
  growth = rejected_rate_ > 0 ? 1 : std::max(growth, 1.0);
  // Where shorter parts were in vain, what solutions leave is more than what the motion needs.
  next_ = std::min(kept ? part_ * growth : kLargestGrowth * std::max(part_, first_try_), h_);
  first_try_ = 0;
  missed_ = missed_ || !kept;
  largest_rate_ = std::max(largest_rate_, std::min(rate, kUnknownRate));
  rejected_rate_ = 0;
  in_vain_ = 0;
  left_ -= part_;
  ++taken_;
  choosePart();
  return true;
}

void ErrorControl::tell(int bodies, StepReport& report) const {
  report.substeps = std::max(report.substeps, taken_);
  report.error_estimate = std::max(report.error_estimate, largest_rate_);
  if (missed_) report.tolerance_missed += bodies;
}

}  // namespace ragdoll
