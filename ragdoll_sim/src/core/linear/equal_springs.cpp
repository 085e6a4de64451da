#include "core/linear/equal_springs.h"

#include <algorithm>
#include <cmath>

#include "core/linear/constants.h"
#include "core/linear/stick_kernels.h"

namespace ragdoll {
namespace {

bool slides(const SchurBlock& block, const double* now) {
  const double edge = kSlides * block.friction * now[0];
  return block.tangent_answer > 0 && now[1] * now[1] + now[2] * now[2] >= edge * edge;
}

}  // namespace

bool EqualSprings::anySlides(const std::vector<SchurBlock>& blocks, const double* p) {
  return std::any_of(blocks.begin(), blocks.end(), [p](const SchurBlock& block) {
    const double* now = p + block.row;
    return block.answer > 0 && now[0] > 0 && slides(block, now);
  });
}

bool EqualSprings::collect(const std::vector<SchurBlock>& blocks, const std::vector<int>& idle,
                           const double* p) {
  rows_.clear();
  for (const SchurBlock& block : blocks) {
    const double* now = p + block.row;
    const bool is_idle = std::binary_search(idle.begin(), idle.end(), block.row);
    if (!(block.answer > 0) || !(now[0] > 0 || is_idle)) continue;
    const bool sliding = !is_idle && slides(block, now);
    rows_.push_back({block.row, 1 / std::sqrt(block.own[0]), true, sliding, is_idle});
    if (is_idle || sliding || !(block.tangent_answer > 0)) continue;
    const double scale = 1 / std::sqrt(std::max(block.own[1], block.own[2]));
    for (int k = 1; k < 3; ++k)
      if (block.own[k] > 0) rows_.push_back({block.row + k, scale, false, false});
  }
  return rows_.size() > 1 && rows_.size() <= kMostShared;
}

bool EqualSprings::isKnown() const {
  return std::equal(rows_.begin(), rows_.end(), known_.begin(), known_.end(),
                    [](const Pressing& row, int known) { return row.row == known; });
}

void EqualSprings::startAnew() {
  known_.clear();
  for (const Pressing& row : rows_) known_.push_back(row.row);
  findBasis();
}

int EqualSprings::findPivot(bool sliding) const {
  int pivot = -1;
  double most = kDependentPush;
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].slides == sliding && left_[i] > most) {
      most = left_[i];
      pivot = static_cast<int>(i);
    }
  return pivot;
}

/// Cholesky's factors with pivots [Higham2002, sec. 10.3], those that slide last: they depend on
/// others where they get none.
void EqualSprings::factor() {
  const int m = static_cast<int>(B_.rows()), width = static_cast<int>(B_.cols());
  L_.resize(m, width);
  weights_.resize(m);
  left_ = B_.diagonal();
  pivot_.clear();
  for (int k = 0; k < m; ++k) {
    int pivot = findPivot(false);
    if (pivot < 0) pivot = findPivot(true);
    if (pivot < 0) return;
    for (int j = 0; j < k; ++j) weights_[j] = -L_(j, pivot);
    kernels::addWeighted(B_.row(pivot).data(), L_.data(), weights_.data(), k, width,
                         L_.row(k).data());
    L_.row(k) /= std::sqrt(left_[pivot]);
    for (const int before : pivot_) L_(k, before) = 0;
    left_ -= L_.row(k).head(m).cwiseAbs2();
    left_[pivot] = 0;
    pivot_.push_back(pivot);
  }
}

bool EqualSprings::isPivot(int i) const {
  return std::find(pivot_.begin(), pivot_.end(), i) != pivot_.end();
}

/// The kernel's vectors are 1 at one of the rows that are no pivots and 0 at the others. By
/// Gram-Schmidt orthonormal [Golub2013, sec. 5.2.8].
void EqualSprings::findBasis() {
  factor();
  const int m = static_cast<int>(B_.rows()), rank = static_cast<int>(pivot_.size());
  depends_ = false;
  for (int i = 0; i < m; ++i) depends_ = depends_ || (rows_[i].slides && !isPivot(i));
  if (!depends_) return;
  const int free = m - rank;
  of_kernel_ = free <= rank;
  if (of_kernel_) {
    basis_.setZero(free, m);
    int k = 0;
    for (int i = 0; i < m; ++i) {
      if (isPivot(i)) continue;
      auto z = basis_.row(k++);
      z[i] = 1;
      for (int j = rank - 1; j >= 0; --j)
        z[pivot_[j]] = -L_.row(j).head(m).dot(z) / L_(j, pivot_[j]);
    }
  } else {
    basis_ = L_.topLeftCorner(rank, m);
  }
  for (Eigen::Index k = 0; k < basis_.rows(); ++k) {
    for (Eigen::Index j = 0; j < k; ++j)
      basis_.row(k) -= basis_.row(j).dot(basis_.row(k)) * basis_.row(j);
    basis_.row(k).normalize();
  }
}

void EqualSprings::findChange() {
  change_.setZero(q_.size());
  for (Eigen::Index k = 0; k < basis_.rows(); ++k) change_ += basis_.row(k).dot(q_) * basis_.row(k);
  if (of_kernel_)
    change_ *= -1;
  else
    change_ -= q_;
}

double EqualSprings::slide(const std::vector<SchurBlock>& blocks, double* p) {
  double most = 0;
  std::size_t k = 0;
  for (const SchurBlock& block : blocks) {
    double* now = p + block.row;
    while (k < rows_.size() && rows_[k].row < block.row) ++k;
    if (k == rows_.size() || rows_[k].row != block.row) continue;
    if (rows_[k].idle) most = std::max(most, block.friction * q_[k]);
    if (!rows_[k].slides) continue;
    const double next = q_[k] * rows_[k].scale;
    most = std::max(most, block.friction * std::abs(next - now[0]) / rows_[k].scale);
    for (int d = 1; d < 3; ++d) now[d] *= next / now[0];
  }
  return most;
}

double EqualSprings::beyondCones(const std::vector<SchurBlock>& blocks, const double* p) {
  double most = 0;
  for (const SchurBlock& block : blocks) {
    if (!(block.tangent_answer > 0)) continue;
    const double* now = p + block.row;
    const double beyond = std::hypot(now[1], now[2]) - block.friction * now[0];
    most = std::max(most, beyond * std::sqrt(block.own[0]));
  }
  return most;
}

double EqualSprings::spread(const std::vector<SchurBlock>& blocks, double* p) {
  if (!depends_) return 0;
  const int m = static_cast<int>(rows_.size());
  q_.resize(m);
  for (int i = 0; i < m; ++i) q_[i] = p[rows_[i].row] / rows_[i].scale;
  const auto idle = std::count_if(rows_.begin(), rows_.end(), [](auto& row) { return row.idle; });
  for (int let_go = 0; let_go < kMostLetGo + idle && depends_; ++let_go) {
    findChange();
    double way = 1;  // until the first one lets go
    int first = -1;
    for (int i = 0; i < m; ++i) {
      if (!rows_[i].pushes || q_[i] + way * change_[i] >= 0) continue;
      way = q_[i] / -change_[i];
      first = i;
    }
    q_ += way * change_;
    if (first < 0) break;
    q_[first] = 0;
    B_.row(first).setZero();
    B_.col(first).setZero();
    B_(first, first) = 1;  // what is 0 there has no part in the kernel
    known_.clear();
    findBasis();
  }
  const double most = slide(blocks, p);
  for (int i = 0; i < m; ++i) p[rows_[i].row] = q_[i] * rows_[i].scale;
  return std::max(most, beyondCones(blocks, p)) / q_.cwiseAbs().maxCoeff();
}

}  // namespace ragdoll
