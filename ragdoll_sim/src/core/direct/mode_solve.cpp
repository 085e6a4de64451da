#include "core/direct/mode_solve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/direct/mode_newton.h"
#include "core/linear/schur_sweeps.h"

namespace ragdoll {
namespace {

/// The rows as sweeps take them (schur_sweeps.h); what slips takes its friction along with its
/// normal force.
struct SweptRows {
  ModeMatrix columns;
  ModeVector w;

  int size() const { return static_cast<int>(w.size()); }
  double rate(int i) const { return w[i]; }
  void push(int i, int count, const double* step) {
    for (int k = 0; k < count; ++k) w += step[k] * columns.col(i + k);
  }
};

/// As many as there may be, so that no solution asks for memory.
struct SweptBlocks {
  std::array<SchurBlock, kMostModeRows> list;
  int count = 0;

  SchurBlock* begin() { return list.data(); }
  SchurBlock* end() { return list.data() + count; }
};

SchurBlock sweptBlock(const ModeMatrix& A, const ModeBlock& block, const SweptRows& rows) {
  const int i = block.row, t = i + 1;
  SchurBlock swept;
  swept.row = i;
  swept.friction = block.friction;
  swept.has_tangents = block.friction > 0 && !block.slips;
  swept.own[0] = rows.columns(i, i) > 0 ? rows.columns(i, i) : A(i, i);
  if (!block.given && A(i, i) > kNoAnswer) swept.answer = 1 / swept.own[0];
  if (!swept.has_tangents) return swept;
  for (int k = 0; k < 2; ++k) {
    swept.own[1 + k] = A(t + k, t + k);
    swept.across[k] = A(i, t + k);
  }
  const double own = std::max(A(t, t), A(t + 1, t + 1)) + std::abs(A(t, t + 1));
  if (own > kNoAnswer) swept.tangent_answer = 1 / own;
  return swept;
}

/// Goes on with p by sweeps over the blocks.
void sweep(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& blocks,
           ModeVector& p) {
  SweptRows rows{A, b};
  SweptBlocks swept;
  for (const ModeBlock& block : blocks) {
    const int i = block.row;
    if (block.friction > 0 && block.slips)
      for (int k = 0; k < 2; ++k) {
        rows.columns.col(i) -= block.friction * block.slip[k] * A.col(i + 1 + k);
        p[i + 1 + k] = 0;
      }
    swept.list[swept.count++] = sweptBlock(A, block, rows);
  }
  projectedGaussSeidel(rows, swept, p.data(), Sweeps::kToTheEnd);
  for (const ModeBlock& block : blocks)
    if (block.friction > 0 && block.slips)
      p.segment<2>(block.row + 1) = -block.friction * p[block.row] * block.slip;
}

/// Which rows press, stick and slip by forces p.
void readMode(const ModeMatrix& A, const ModeVector& b, double scale, const ModeVector& p,
              std::vector<ModeBlock>& blocks) {
  const ModeVector w = b + A * p;
  for (ModeBlock& block : blocks) {
    const int i = block.row;
    block.impending = false;
    block.lean = 0;
    if (!block.given) block.presses = p[i] > kNoForce * scale;
    const bool rubs = block.presses && block.friction > 0 && !block.slips;
    const double force = rubs ? p.segment<2>(i + 1).norm() : 0;
    block.sticks = rubs && (force == 0 || force < (1 - kOnCone) * block.friction * p[i]);
    if (!rubs || block.sticks) continue;
    block.slip = -p.segment<2>(i + 1) / force;
    block.impending = w.segment<2>(i + 1).norm() < kNoRate * scale * A(i, i);
  }
}

/// What the equalities' solution contradicts most, and how.
struct Contradiction {
  enum class Kind { kNone, kRelease, kClose, kSlip, kStick, kLean, kMove } kind = Kind::kNone;
  ModeBlock* block = nullptr;
  double by = 0;  ///< [N]

  void consider(ModeBlock& of, double much, Kind what) {
    if (much > by) by = much, block = &of, kind = what;
  }
  void considerFriction(ModeBlock& of, const Eigen::Vector2d& force, double bound, double along,
                        double none, double scale) {
    if (of.sticks) {
      consider(of, force.norm() - bound - none, Kind::kSlip);
    } else if (of.impending) {
      consider(of, along - kNoRate * scale, Kind::kMove);
      consider(of, -along - kNoRate * scale, Kind::kStick);
      consider(of, std::abs(of.across().dot(force)) - kMostLean * bound - none, Kind::kLean);
    } else if (along < 0) {
      consider(of, -along - none, Kind::kStick);
    }
  }
  /// Changes that block.
  void mend(const ModeVector& p) const {
    ModeBlock& of = *block;
    if (kind == Kind::kRelease) of.presses = of.sticks = false;
    if (kind == Kind::kClose) of.presses = true, of.sticks = of.friction > 0 && !of.slips;
    if (kind == Kind::kStick) of.sticks = true;
    if (kind == Kind::kMove) of.impending = false;
    if (kind != Kind::kSlip && kind != Kind::kLean) return;
    of.sticks = false;
    // Where the direction in which it pulls holds it less than the one before, none does: it moves.
    of.impending = kind == Kind::kSlip || of.lean == 0 || by < of.lean;
    of.lean = kind == Kind::kLean ? by : 0;
    of.slip = -p.segment<2>(of.row + 1).normalized();
  }
};

/// What the equalities' solution contradicts most is changed; false: nothing is.
bool change(const ModeMatrix& A, const ModeVector& b, double scale, std::vector<ModeBlock>& blocks,
            const ModeVector& p) {
  const ModeVector w = b + A * p;
  const double none = kNoForce * scale;
  Contradiction worst;
  for (ModeBlock& block : blocks) {
    const int i = block.row;
    const double answer = std::max(A(i, i), kNoAnswer);
    if (!block.given && block.presses)
      worst.consider(block, -p[i] - none, Contradiction::Kind::kRelease);
    if (!block.given && !block.presses)
      worst.consider(block, -w[i] / answer - none, Contradiction::Kind::kClose);
    if (!block.presses || block.friction == 0 || block.slips) continue;
    const double along = w.segment<2>(i + 1).dot(block.slip) / answer;
    worst.considerFriction(block, p.segment<2>(i + 1), block.friction * p[i], along, none, scale);
  }
  if (worst.block) worst.mend(p);
  return worst.block;
}

/// Contacts that begin to slip: their places among the blocks.
using Slipping = Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMostModeRows, 1>;

/// Sines of the angles from their directions to the motions that follow; none where friction all
/// but holds: there it goes on as it was.
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

/// Solves the equalities with contacts that begin to slip doing so along the motion that follows,
/// by Newton's method on their directions, in as many solutions as are left: taking the direction
/// of the motion again and again swings about the solution where friction turns the motion.
bool alignSlips(const ModeMatrix& A, const ModeVector& b, double scale,
                std::vector<ModeBlock>& blocks, int& solutions, ModeVector& p) {
  if (!solveEqualities(A, b, blocks, p)) return false;
  Slipping which(0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const ModeBlock& block = blocks[i];
    if (!block.presses || block.sticks || block.impending || block.slips || block.friction == 0)
      continue;
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
    if (worst < kSameDirection || (worst < kNearlySameDirection && worst > 0.5 * before))
      return true;
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

double impulseScale(const ModeMatrix& A, const ModeVector& b) {
  double scale = 0;
  for (int i = 0; i < b.size(); ++i)
    if (A(i, i) > kNoAnswer) scale = std::max(scale, std::abs(b[i]) / A(i, i));
  return scale;
}

bool solveComplementarity(const ModeMatrix& A, const ModeVector& b, double scale,
                          std::vector<ModeBlock>& blocks, ModeVector& p) {
  for (ModeBlock& block : blocks) {
    block.force = std::max(0.0, block.force);  // a spring that is just touched may pull by rounding
    if (block.given) p[block.row] = block.presses ? block.force : 0;
  }
  sweep(A, b, blocks, p);
  if (!approachComplementarity(A, b, blocks, p)) return false;
  readMode(A, b, scale, p, blocks);
  int solutions = kMostSolutions;
  for (int k = 0; k < kModeChanges; ++k) {
    if (!alignSlips(A, b, scale, blocks, solutions, p)) return false;
    if (!change(A, b, scale, blocks, p)) return true;
  }
  return false;
}

}  // namespace ragdoll
