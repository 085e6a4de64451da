#include "core/direct/mode_newton.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/direct/mode_constants.h"

namespace ragdoll {
namespace {

/// The unknowns q among the forces, p = known + spread q, and their scaled rates, gather^T w.
struct Unknowns {
  ModeMatrix spread, gather;
  ModeVector known;
  int count = 0;
  /// Of each block: places of its normal force and of the first of two tangential ones, or -1.
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMostModeRows, 1> normal, tangents;

  Unknowns(const ModeMatrix& A, const std::vector<ModeBlock>& blocks)
      : spread(ModeMatrix::Zero(A.rows(), A.rows())),
        gather(spread),
        known(ModeVector::Zero(A.rows())) {
    normal.setConstant(static_cast<Eigen::Index>(blocks.size()), -1);
    tangents = normal;
    for (std::size_t i = 0; i < blocks.size(); ++i) add(A, blocks[i], static_cast<int>(i));
    spread.conservativeResize(A.rows(), count);
    gather.conservativeResize(A.rows(), count);
  }

 private:
  void add(const ModeMatrix& A, const ModeBlock& block, int i) {
    const int row = block.row;
    const bool rubs = block.friction > 0 && block.slips;
    if (block.given) {
      known[row] = block.presses ? block.force : 0;
      if (rubs) known.segment(row + 1, 2) = -block.friction * known[row] * block.slip;
    } else {
      normal[i] = count;
      const double scale = normalScale(A, block);
      gather(row, count) = spread(row, count) = scale;
      if (rubs) spread.col(count).segment(row + 1, 2) = -block.friction * scale * block.slip;
      ++count;
    }
    if (block.friction == 0 || rubs) return;
    tangents[i] = count;
    const double scale = tangentScale(A, block);
    for (int d = 1; d < 3; ++d, ++count) gather(row + d, count) = spread(row + d, count) = scale;
  }
};

/// Zero where forces and rates w = c + B q agree with the inequalities.
struct NaturalMap {
  const std::vector<ModeBlock>& blocks;
  const Unknowns& of;
  ModeMatrix B;
  ModeVector c, own;
  ModeVector F;
  ModeMatrix J;  ///< of F

  NaturalMap(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& all,
             const Unknowns& unknowns)
      : blocks(all),
        of(unknowns),
        B(of.gather.transpose() * A * of.spread),
        c(of.gather.transpose() * (b + A * of.known)) {
    own = B.diagonal();
  }

  void soften(double by) { B.diagonal() = own.array() + by; }

  void evaluate(const ModeVector& q) {
    const ModeVector w = c + B * q;
    F = q;
    J.setIdentity(of.count, of.count);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const int n = of.normal[static_cast<Eigen::Index>(i)];
      if (n >= 0 && q[n] > w[n]) {
        F[n] = w[n];
        J.row(n) = B.row(n);
      }
      if (of.tangents[static_cast<Eigen::Index>(i)] >= 0)
        evaluateFriction(q, w, static_cast<int>(i));
    }
  }

 private:
  void evaluateFriction(const ModeVector& q, const ModeVector& w, int i) {
    const ModeBlock& block = blocks[i];
    const int t = of.tangents[i], n = of.normal[i];
    const double scale = of.gather(block.row + 1, t);
    if (!(scale > 0)) return;
    const double press = n < 0 ? of.known[block.row] : of.gather(block.row, n) * q[n];
    const double bound = block.friction * std::max(0.0, press) / scale;
    const Eigen::Vector2d pulls = q.segment<2>(t) - w.segment<2>(t);
    const double length = pulls.norm();
    if (length <= bound) {
      F.segment<2>(t) = w.segment<2>(t);
      J.middleRows<2>(t) = B.middleRows<2>(t);
      return;
    }
    const Eigen::Vector2d along = pulls / length;
    F.segment<2>(t) -= bound * along;
    const Eigen::Matrix2d turn =
        bound / length * (Eigen::Matrix2d::Identity() - along * along.transpose());
    J.middleRows<2>(t) += turn * B.middleRows<2>(t);
    J.block<2, 2>(t, t) -= turn;
    if (n >= 0 && press > 0)
      J.col(n).segment<2>(t) -= block.friction * of.gather(block.row, n) / scale * along;
  }
};

/// Newton's method from q on.
bool descend(NaturalMap& map, ModeVector& q) {
  map.evaluate(q);
  for (int k = 0; k < kNewtonSteps; ++k) {
    const double off = map.F.norm();
    if (off <= kNewtonSettled * q.norm()) return true;
    const ModeVector change = map.J.partialPivLu().solve(map.F), from = q;
    if (!change.allFinite()) return false;
    double share = 1;
    for (int half = 0; half < kNewtonHalvings; ++half, share *= 0.5) {
      q = from - share * change;
      map.evaluate(q);
      if (map.F.norm() < (1 - kNewtonGain * share) * off) break;
    }
  }
  return false;
}

}  // namespace

bool approachComplementarity(const ModeMatrix& A, const ModeVector& b,
                             const std::vector<ModeBlock>& blocks, ModeVector& p) {
  const Unknowns unknowns(A, blocks);
  NaturalMap map(A, b, blocks, unknowns);
  ModeVector q(unknowns.count);
  for (int k = 0; k < unknowns.count; ++k) {
    Eigen::Index row = 0;
    const double scale = unknowns.gather.col(k).maxCoeff(&row);
    q[k] = scale > 0 ? p[row] / scale : 0;
  }
  map.soften(kGivesWay);
  bool found = descend(map, q);
  if (!found) q.setZero();
  for (double soft = kSoftest; !found && soft > kGivesWay / kSofter; soft /= kSofter) {
    map.soften(std::max(soft, kGivesWay));
    found = descend(map, q) && soft < kGivesWay * kSofter;
  }
  if (found) p = unknowns.known + unknowns.spread * q;
  return found;
}

}  // namespace ragdoll
