#include "core/direct/mode_equalities.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ragdoll {
namespace {

double scaleOf(double diagonal) { return diagonal > kNoAnswer ? 1 / std::sqrt(diagonal) : 0; }

/// What is zero: a row, or what two tangents have along a direction.
struct Equality {
  int row = 0;
  bool oblique = false;
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< oblique: of `row` and the next
  double scale = 1;

  double of(const ModeVector& w) const { return oblique ? along.dot(w.segment<2>(row)) : w[row]; }
};

/// The equalities, and what their unknowns act by: a column of A, the normal one with the friction
/// that goes with it, or two tangents.
struct Equalities {
  std::array<Equality, kMostModeRows> list;
  ModeMatrix columns;
  int count = 0;

  Equalities(const ModeMatrix& A, const std::vector<ModeBlock>& blocks) {
    columns.resize(A.rows(), A.rows());
    for (const ModeBlock& block : blocks)
      if (block.presses) add(A, block);
    columns.conservativeResize(A.rows(), count);
  }

 private:
  void add(const ModeMatrix& A, const ModeBlock& block) {
    const int t = block.row + 1;
    const bool rubs = block.friction > 0;
    if (!block.given) {
      columns.col(count) = A.col(block.row);
      if (rubs && !block.sticks)
        for (int k = 0; k < 2; ++k)
          columns.col(count) -= block.friction * block.slip[k] * A.col(t + k);
      list[count++] = {block.row, false, {}, normalScale(A, block)};
    }
    if (!rubs) return;
    if (block.sticks)
      for (int k = 0; k < 2; ++k) {
        columns.col(count) = A.col(t + k);
        list[count++] = {t + k, false, {}, tangentScale(A, block)};
      }
    else if (block.impending) {
      columns.col(count) = block.across()[0] * A.col(t) + block.across()[1] * A.col(t + 1);
      list[count++] = {t, true, block.across(), tangentScale(A, block)};
    }
  }
};

/// Of the equalities, scaled: what each asks for by the others' unknowns.
ModeMatrix scaledMatrix(const Equalities& equalities) {
  const int m = equalities.count;
  ModeMatrix C(m, m);
  for (int j = 0; j < m; ++j) {
    const ModeVector column = equalities.columns.col(j);
    for (int i = 0; i < m; ++i)
      C(i, j) = equalities.list[i].of(column) * equalities.list[i].scale * equalities.list[j].scale;
  }
  return C;
}

/// The forces of all rows from those of the unknowns; of none: what is given.
void spread(const std::vector<ModeBlock>& blocks, const ModeVector& q, ModeVector& p) {
  const auto next = [&](int& k) { return k < q.size() ? q[k++] : 0; };
  p.setZero();
  int k = 0;
  for (const ModeBlock& block : blocks) {
    if (!block.presses) continue;
    p[block.row] = block.given ? block.force : next(k);
    if (block.friction == 0) continue;
    for (int d = 0; d < 2; ++d)
      p[block.row + 1 + d] =
          block.sticks ? next(k) : -block.friction * p[block.row] * block.slip[d];
    if (!block.sticks && block.impending) p.segment<2>(block.row + 1) += next(k) * block.across();
  }
}

/// Solves C q = rhs; where rows depend on others they share the load as springs at them would, of a
/// common stiffness: C gives way by a little of the identity. Then q has nothing of what C^T takes
/// to zero (C is not symmetric where contacts slip). Eigen's own decompositions ask for memory
/// there.
class SharedLoad {
 public:
  explicit SharedLoad(const ModeMatrix& C) {
    rows_.setThreshold(kDependent);
    rows_.compute(C);
    rank_ = rows_.rank();
    const Eigen::Index m = C.cols(), free = m - rank_;
    if (free == 0) return;
    kernel_.resize(m, free);
    ModeMatrix kept(free, free);
    for (Eigen::Index k = 0; k < free; ++k) {
      ModeVector z = ModeVector::Zero(m);
      z.head(rank_) = -rows_.matrixR().col(rank_ + k).head(rank_);
      solveUpper(z);
      z[rank_ + k] = 1;
      kernel_.col(k) = unpermuted(z);
      kept.col(k) = rotated(kernel_.col(k)).tail(free);
    }
    share_.compute(kept);
  }

  ModeVector solve(const ModeVector& rhs) const {
    ModeVector z = rotated(rhs);
    const Eigen::Index free = z.size() - rank_;
    z.tail(free).setZero();
    solveUpper(z);
    ModeVector q = unpermuted(z);
    if (free == 0) return q;
    const ModeVector share = rotated(q).tail(free);
    q -= kernel_ * share_.solve(share);
    return q;
  }

 private:
  /// Q^T x, where C = Q R P^T.
  ModeVector rotated(ModeVector x) const {
    x.applyOnTheLeft(rows_.householderQ().setLength(rank_).adjoint());
    return x;
  }
  void solveUpper(ModeVector& z) const {
    auto head = z.head(rank_);
    rows_.matrixR()
        .topLeftCorner(rank_, rank_)
        .template triangularView<Eigen::Upper>()
        .solveInPlace(head);
  }
  ModeVector unpermuted(const ModeVector& z) const {
    ModeVector q(z.size());
    for (Eigen::Index i = 0; i < z.size(); ++i) q[rows_.colsPermutation().indices()[i]] = z[i];
    return q;
  }

  Eigen::ColPivHouseholderQR<ModeMatrix> rows_;
  Eigen::Index rank_ = 0;
  ModeMatrix kernel_;
  Eigen::PartialPivLU<ModeMatrix> share_;
};

}  // namespace

double normalScale(const ModeMatrix& A, const ModeBlock& block) {
  return scaleOf(A(block.row, block.row));
}

double tangentScale(const ModeMatrix& A, const ModeBlock& block) {
  return scaleOf(std::max(A(block.row + 1, block.row + 1), A(block.row + 2, block.row + 2)));
}

bool solveEqualities(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& blocks,
                     ModeVector& p, double left) {
  const Equalities equalities(A, blocks);
  const int m = equalities.count;
  p.resize(A.rows());
  spread(blocks, ModeVector(0), p);
  if (m == 0) return true;
  const ModeVector known = b + A * p;
  const ModeMatrix C = scaledMatrix(equalities);
  ModeVector rhs(m), scale(m);
  for (int i = 0; i < m; ++i) scale[i] = equalities.list[i].scale;
  for (int i = 0; i < m; ++i) rhs[i] = -equalities.list[i].of(known) * scale[i];
  const SharedLoad inverse(C);
  ModeVector q = inverse.solve(rhs);
  ModeVector rest = rhs - C * q;
  q += inverse.solve(rest);
  rest = rhs - C * q;
  const double of_asked = kModeContradiction * rhs.cwiseAbs().maxCoeff();
  for (int i = 0; i < m; ++i)
    if (!(std::abs(rest[i]) <= of_asked + left * scale[i])) return false;
  q = q.cwiseProduct(scale).eval();
  spread(blocks, q, p);
  return p.allFinite();
}

void findIdleLoads(const ModeMatrix& A, const std::vector<ModeBlock>& blocks, const ModeVector& p,
                   std::vector<double>& loads) {
  loads.assign(blocks.size(), -std::numeric_limits<double>::infinity());
  const auto isIdle = [](const ModeBlock& block) { return !block.presses && !block.given; };
  if (std::none_of(blocks.begin(), blocks.end(), isIdle)) return;
  const Equalities equalities(A, blocks);
  const int m = equalities.count;
  if (m == 0) return;
  const SharedLoad inverse(scaledMatrix(equalities));
  ModeVector q(m);
  for (int k = 0; k < m; ++k) q[k] = equalities.list[k].of(p) / equalities.list[k].scale;
  const ModeVector bends = inverse.solve(q);  // how far the springs give way: q = C bends
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const int row = blocks[i].row;
    const double scale = normalScale(A, blocks[i]);
    if (!isIdle(blocks[i]) || scale == 0) continue;
    ModeVector own(m), answers(m);
    for (int k = 0; k < m; ++k) {
      const Equality& equality = equalities.list[k];
      own[k] = equality.of(A.col(row)) * equality.scale * scale;
      answers[k] = equalities.columns(row, k) * equality.scale * scale;
    }
    if (1 - answers.dot(inverse.solve(own)) < kDependent) loads[i] = scale * answers.dot(bends);
  }
}

}  // namespace ragdoll
