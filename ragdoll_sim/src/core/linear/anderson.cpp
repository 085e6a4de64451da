#include "core/linear/anderson.h"

#include <algorithm>

namespace ragdoll {
namespace {

constexpr double kDependentColumn = 1e-10;  ///< of a column: what is left of it is rounding

}  // namespace

bool Anderson::mix(const RowValues& before, const RowValues& result, RowValues& better) {
  const Eigen::Index size = result.size();
  if (first_) {
    changes_.resize(size, kMemory);
    results_.resize(size, kMemory);
  }
  change_ = result - before;
  if (!first_) {
    changes_.col(next_) = change_ - last_change_;
    if (changes_.col(next_).norm() < kNoChange * change_.norm()) return false;
    results_.col(next_) = result - last_result_;
    next_ = (next_ + 1) % kMemory;
    known_ = std::min(known_ + 1, kMemory);
  }
  first_ = false;
  last_change_ = change_;
  last_result_ = result;
  findShares();
  better = result;
  for (int k = 0; k < known_; ++k) better -= share_[k] * results_.col(k);
  return true;
}

void Anderson::findShares() {
  double R[kMemory][kMemory] = {};
  basis_ = changes_;
  rest_ = change_;
  for (int k = 0; k < known_; ++k) {
    auto column = basis_.col(k);
    const double whole = column.norm();
    for (int j = 0; j < k; ++j) {
      R[j][k] = basis_.col(j).dot(column);
      column -= R[j][k] * basis_.col(j);
    }
    R[k][k] = column.norm();
    if (R[k][k] > kDependentColumn * whole) {
      column /= R[k][k];
    } else {
      R[k][k] = 0;
      column.setZero();
    }
    share_[k] = column.dot(rest_);
    rest_ -= share_[k] * column;
  }
  for (int k = known_ - 1; k >= 0; --k) {
    for (int j = k + 1; j < known_; ++j) share_[k] -= R[k][j] * share_[j];
    share_[k] = R[k][k] > 0 ? share_[k] / R[k][k] : 0;
  }
}

}  // namespace ragdoll
