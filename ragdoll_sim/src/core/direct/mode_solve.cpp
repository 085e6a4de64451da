#include "core/direct/mode_solve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/direct/mode_constants.h"

namespace ragdoll {
namespace {

/// The rows of A that are equalities, and what their unknowns act by: a column of A, or the normal
/// one with the friction that goes with it.
void columnsOf(const ModeMatrix& A, const std::vector<ModeBlock>& blocks, ModeMatrix& columns,
               Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMostModeRows, 1>& row) {
  const int m = static_cast<int>(A.rows());
  row.resize(m);
  columns.resize(m, m);
  int count = 0;
  for (const ModeBlock& block : blocks) {
    if (!block.presses) continue;
    if (!block.given) {
      columns.col(count) = A.col(block.row);
      if (block.friction > 0 && !block.sticks)
        for (int k = 0; k < 2; ++k)
          columns.col(count) -= block.friction * block.slip[k] * A.col(block.row + 1 + k);
      row[count++] = block.row;
    }
    if (block.friction == 0 || !block.sticks) continue;
    for (int k = 1; k < 3; ++k) {
      columns.col(count) = A.col(block.row + k);
      row[count++] = block.row + k;
    }
  }
  row.conservativeResize(count);
  columns.conservativeResize(m, count);
}

double scaleOf(double diagonal) {
  return diagonal > kNoAnswer ? 1 / std::sqrt(diagonal) : 0;
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
      p[block.row + 1 + d] = block.sticks ? next(k) : -block.friction * p[block.row] * block.slip[d];
  }
}

/// Sweeps over the blocks; contacts that slip already have their friction folded in.
void sweep(const ModeMatrix& A, const ModeVector& b, std::vector<ModeBlock>& blocks, ModeVector& p) {
  ModeVector w = b + A * p;
  const int m = static_cast<int>(A.rows());
  const auto push = [&](int row, double change) {
    p[row] += change;
    w += change * A.col(row);
  };
  for (int k = 0; k < kModeSweeps; ++k) {
    double most = 0, largest = 0;
    for (const ModeBlock& block : blocks) {
      const int i = block.row;
      if (A(i, i) <= kNoAnswer) continue;
      double answer = A(i, i);
      if (block.slips)
        for (int d = 0; d < 2; ++d) answer -= block.friction * block.slip[d] * A(i, i + 1 + d);
      if (!(answer > 0)) answer = A(i, i);
      const double next = block.given ? p[i] : std::max(0.0, p[i] - w[i] / answer);
      const double change = next - p[i];
      push(i, change);
      most = std::max(most, std::abs(change));
      largest = std::max(largest, next);
      if (block.friction == 0) continue;
      Eigen::Vector2d t(p[i + 1], p[i + 2]);
      if (block.slips) {
        t = -block.friction * next * block.slip;
      } else {
        const double own = std::max(A(i + 1, i + 1), A(i + 2, i + 2)) + std::abs(A(i + 1, i + 2));
        if (own > kNoAnswer) t -= Eigen::Vector2d(w[i + 1], w[i + 2]) / own;
        const double bound = block.friction * next, length = t.norm();
        if (length > bound) t *= bound / length;
      }
      for (int d = 0; d < 2; ++d) {
        most = std::max(most, std::abs(t[d] - p[i + 1 + d]));
        push(i + 1 + d, t[d] - p[i + 1 + d]);
      }
    }
    if (most <= kModeSettled * largest || m == 0) return;
  }
}

/// Takes out rows that depend on others, along what changes nothing but how they share the load.
void makeIndependent(const ModeMatrix& A, std::vector<ModeBlock>& blocks, ModeVector& p) {
  for (std::size_t tries = 0; tries < blocks.size(); ++tries) {
    std::array<int, kMostModeRows> member{};
    int count = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i)
      if (blocks[i].presses && !blocks[i].given && count < kMostModeRows) member[count++] = static_cast<int>(i);
    if (count < 2) return;
    ModeMatrix C(count, count);
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j) {
        const ModeBlock &r = blocks[member[i]], &c = blocks[member[j]];
        C(i, j) = A(r.row, c.row) * scaleOf(A(r.row, r.row)) * scaleOf(A(c.row, c.row));
      }
    Eigen::FullPivLU<ModeMatrix> lu(C);
    lu.setThreshold(kDependent);
    if (lu.rank() == count) return;
    const ModeMatrix kernel = lu.kernel();
    ModeVector z = kernel.col(0);
    double least = std::numeric_limits<double>::infinity();
    int out = -1;
    for (int sign = 0; sign < 2 && out < 0; ++sign, z = -z)
      for (int i = 0; i < count; ++i) {
        const int row = blocks[member[i]].row;
        const double force = p[row] / std::max(scaleOf(A(row, row)), kNoAnswer);
        if (z[i] > kDependent && force / z[i] < least) least = force / z[i], out = i;
      }
    if (out < 0) return;
    blocks[member[out]].presses = blocks[member[out]].sticks = false;
  }
}

/// What the equalities' solution contradicts most is changed; false: nothing is.
bool change(const ModeMatrix& A, const ModeVector& b, double scale, std::vector<ModeBlock>& blocks,
            const ModeVector& p) {
  const ModeVector w = b + A * p;
  const double none = kNoForce * scale;
  ModeBlock* worst = nullptr;
  double most = 0;
  enum { kRelease, kClose, kSlip, kStick } what = kRelease;
  const auto consider = [&](ModeBlock& block, double by, auto kind) {
    if (!(by > most)) return;
    most = by, worst = &block, what = kind;
  };
  for (ModeBlock& block : blocks) {
    const int i = block.row;
    const double answer = std::max(A(i, i), kNoAnswer);
    if (!block.presses) {
      if (!block.given) consider(block, -w[i] / answer - none, kClose);
      continue;
    }
    if (!block.given) consider(block, -p[i] - none, kRelease);
    if (block.friction == 0 || block.slips) continue;
    const Eigen::Vector2d force(p[i + 1], p[i + 2]), rate(w[i + 1], w[i + 2]);
    if (block.sticks)
      consider(block, force.norm() - block.friction * p[i] - none, kSlip);
    else if (rate.dot(block.slip) < 0)
      consider(block, -rate.dot(block.slip) / answer - none, kStick);
  }
  if (!worst) return false;
  const int i = worst->row;
  if (what == kRelease) worst->presses = worst->sticks = false;
  if (what == kClose) worst->presses = true, worst->sticks = worst->friction > 0 && !worst->slips;
  if (what == kStick) worst->sticks = true;
  if (what == kSlip) {
    worst->sticks = false;
    worst->slip = -Eigen::Vector2d(p[i + 1], p[i + 2]).normalized();
  }
  return true;
}

/// The solution of least norm, by a complete orthogonal decomposition [Golub2013, sec. 5.5]: Eigen's
/// own asks for memory where rows depend on others.
class MinimumNorm {
 public:
  explicit MinimumNorm(const ModeMatrix& C) {
    rows_.setThreshold(kDependent);
    rows_.compute(C);
    rank_ = rows_.rank();
    if (rank_ == C.cols()) return;
    ModeMatrix lower = rows_.matrixR().topRows(rank_).template triangularView<Eigen::Upper>();
    lower.transposeInPlace();
    columns_.compute(lower);
  }

  ModeVector solve(const ModeVector& rhs) const {
    const Eigen::Index m = rhs.size();
    ModeVector c = rhs;
    c.applyOnTheLeft(rows_.householderQ().setLength(rank_).adjoint());
    if (rank_ == m) {
      rows_.matrixR().template triangularView<Eigen::Upper>().solveInPlace(c);
    } else {  // R^T = Q2 R2 P2^T: R2^T z = P2^T c
      ModeVector z(rank_);
      for (Eigen::Index i = 0; i < rank_; ++i)
        z[i] = c[columns_.colsPermutation().indices()[i]];
      columns_.matrixR()
          .topRows(rank_)
          .template triangularView<Eigen::Upper>()
          .transpose()
          .solveInPlace(z);
      c.setZero();
      c.head(rank_) = z;
      c.applyOnTheLeft(columns_.householderQ().setLength(rank_));
    }
    ModeVector q(m);
    for (Eigen::Index i = 0; i < m; ++i) q[rows_.colsPermutation().indices()[i]] = c[i];
    return q;
  }

 private:
  Eigen::ColPivHouseholderQR<ModeMatrix> rows_, columns_;
  Eigen::Index rank_ = 0;
};

}  // namespace

bool solveEqualities(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& blocks,
                     ModeVector& p) {
  ModeMatrix columns;
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMostModeRows, 1> row;
  columnsOf(A, blocks, columns, row);
  const int m = static_cast<int>(row.size());
  p.resize(A.rows());
  spread(blocks, ModeVector(0), p);
  if (m == 0) return true;
  const ModeVector known = b + A * p;
  ModeMatrix C(m, m);
  ModeVector rhs(m), scale(m);
  for (int i = 0; i < m; ++i) scale[i] = scaleOf(A(row[i], row[i]));
  for (int i = 0; i < m; ++i) {
    rhs[i] = -known[row[i]] * scale[i];
    for (int j = 0; j < m; ++j) C(i, j) = columns(row[i], j) * scale[i] * scale[j];
  }
  const MinimumNorm inverse(C);
  ModeVector q = inverse.solve(rhs);
  ModeVector rest = rhs - C * q;
  q += inverse.solve(rest);
  rest = rhs - C * q;
  if (!(rest.cwiseAbs().maxCoeff() <= kModeContradiction * (1e-6 + rhs.cwiseAbs().maxCoeff())))
    return false;
  q = q.cwiseProduct(scale).eval();
  spread(blocks, q, p);
  return p.allFinite();
}

namespace {

/// Contacts that begin to slip: their places among the blocks.
using Slipping = Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMostModeRows, 1>;

/// Sines of the angles from their directions to the motions that follow; none where friction all but
/// holds: there it goes on as it was.
void anglesOf(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& blocks,
              double scale, const Slipping& which, const ModeVector& p, ModeVector& sine) {
  const ModeVector w = b + A * p;
  sine.setZero(which.size());
  for (int j = 0; j < which.size(); ++j) {
    const ModeBlock& block = blocks[which[j]];
    const Eigen::Vector2d rate(w[block.row + 1], w[block.row + 2]);
    const double length = rate.norm();
    const double nothing =
        std::max(kOnCone * std::abs(p[block.row]), kHeld * scale) * A(block.row, block.row);
    if (length > nothing)
      sine[j] = (block.slip.x() * rate.y() - block.slip.y() * rate.x()) / length;
  }
}

void turn(ModeBlock& block, double angle) {
  block.slip = Eigen::Rotation2Dd(angle) * block.slip;
  block.slip.normalize();
}

/// Solves the equalities with contacts that begin to slip doing so along the motion that follows, by
/// Newton's method on their directions, in as many solutions as are left: taking the direction of the
/// motion again and again swings about the solution where friction turns the motion.
bool alignSlips(const ModeMatrix& A, const ModeVector& b, double scale,
                std::vector<ModeBlock>& blocks, int& solutions, ModeVector& p) {
  if (!solveEqualities(A, b, blocks, p)) return false;
  Slipping which(0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const ModeBlock& block = blocks[i];
    if (!block.presses || block.sticks || block.slips || block.friction == 0) continue;
    which.conservativeResize(which.size() + 1);
    which[which.size() - 1] = static_cast<int>(i);
  }
  const int m = static_cast<int>(which.size());
  if (m == 0) return true;
  ModeVector sine, there, other;
  ModeMatrix J(m, m);
  double before = 1;
  for (int k = 0; k < kAlignments; ++k) {
    anglesOf(A, b, blocks, scale, which, p, sine);
    const double worst = sine.cwiseAbs().maxCoeff();
    if (worst < kSameDirection || (worst < kNearlySameDirection && worst > 0.5 * before)) return true;
    before = worst;
    solutions -= m + 1;
    if (solutions < 0) return false;
    for (int j = 0; j < m; ++j) {
      const Eigen::Vector2d slip = blocks[which[j]].slip;
      turn(blocks[which[j]], kSlipTurn);
      if (!solveEqualities(A, b, blocks, other)) return false;
      anglesOf(A, b, blocks, scale, which, other, there);
      J.col(j) = (there - sine) / kSlipTurn;
      blocks[which[j]].slip = slip;
    }
    const ModeVector change = J.fullPivLu().solve(sine);
    for (int j = 0; j < m; ++j)
      turn(blocks[which[j]], -std::clamp(change[j], -kMostTurn, kMostTurn));
    if (!solveEqualities(A, b, blocks, p)) return false;
  }
  return sine.cwiseAbs().maxCoeff() < kNearlySameDirection;
}

}  // namespace

bool solveComplementarity(const ModeMatrix& A, const ModeVector& b, double scale,
                          std::vector<ModeBlock>& blocks, ModeVector& p) {
  for (const ModeBlock& block : blocks)
    if (block.given) p[block.row] = block.presses ? block.force : 0;
  sweep(A, b, blocks, p);
  for (ModeBlock& block : blocks) {
    const int i = block.row;
    if (!block.given) block.presses = p[i] > kNoForce * scale;
    const double along = block.friction > 0 ? std::hypot(p[i + 1], p[i + 2]) : 0;
    block.sticks = block.presses && block.friction > 0 && !block.slips &&
                   (along == 0 || along < (1 - kOnCone) * block.friction * p[i]);
    if (block.presses && block.friction > 0 && !block.slips && !block.sticks)
      block.slip = -Eigen::Vector2d(p[i + 1], p[i + 2]) / along;
  }
  makeIndependent(A, blocks, p);
  int solutions = kMostSolutions;
  for (int k = 0; k < kModeChanges; ++k) {
    if (!alignSlips(A, b, scale, blocks, solutions, p)) return false;
    if (!change(A, b, scale, blocks, p)) return true;
  }
  return false;
}

}  // namespace ragdoll
