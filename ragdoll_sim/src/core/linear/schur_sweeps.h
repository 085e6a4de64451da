// Projected Gauss-Seidel [Moreau1988], [Cottle1992, ch. 5] on the rows of one body or of several: a
// contact's friction of the direct methods is here, two rows beside its normal one that are put
// back into the cone together.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/linear/constants.h"
#include "core/linear/lanes.h"
#include "core/linear/schur.h"

namespace ragdoll {

/// What can move of the rows, in their order. Rows: size(); row(i), a Schur::Row; matrix(i, j), of
/// A; free(i), its diagonal without the sticks' answer.
template <class Rows>
void findBlocks(const Rows& rows, std::vector<SchurBlock>& blocks) {
  constexpr double kLocked = 1e-9;  // below this share of its free value a row cannot move
  blocks.clear();
  const int m = rows.size();
  const auto moves = [&](int i) { return rows.matrix(i, i) > kLocked * rows.free(i); };
  for (int i = 0; i < m; ++i) {
    const Schur::Row& row = rows.row(i);
    if (row.kind == Schur::Row::Kind::kTangent || row.locked) continue;
    SchurBlock b;
    b.row = i;
    b.friction = row.friction;
    b.own[0] = rows.matrix(i, i);
    if (moves(i) && !row.given) b.answer = 1 / b.own[0];
    b.has_tangents = row.friction > 0;
    if (b.has_tangents) {
      for (int k = 1; k < 3; ++k) {
        b.own[k] = rows.matrix(i + k, i + k);
        b.across[k - 1] = rows.matrix(i, i + k);
      }
      // One that cannot move, as a pinned rod along itself, leaves friction the other one.
      if (moves(i + 1) || moves(i + 2))
        b.tangent_answer = 1 / (std::max(b.own[1], b.own[2]) + std::abs(rows.matrix(i + 1, i + 2)));
    }
    blocks.push_back(b);
  }
}

/// Sets `slid` of the blocks that slide by p, whose rates are known (Sweeps::kAlongTheSlip).
template <class Rows, class Blocks>
RAGDOLL_INLINE void keepSlips(const Rows& rows, const double* p, Blocks& blocks) {
  for (SchurBlock& b : blocks) {
    const double* now = p + b.row;
    if (!b.has_tangents || !(now[0] > 0)) continue;
    const double length = std::hypot(now[1], now[2]);
    const double against = rows.rate(b.row + 1) * now[1] + rows.rate(b.row + 2) * now[2];
    if (length < kSlides * b.friction * now[0] || against >= 0) continue;
    for (int k = 0; k < 2; ++k) b.slid[k] = now[1 + k] / length;
  }
}

/// Finds p of w = b + A p (schur.h), starting at p. Rows: size(); rate(i), w of row i, at first b;
/// push(i, count, step), which adds step[k] times row i + k of A to w. Blocks: a range of
/// SchurBlock. Returns whether it settled.
///
/// Once it is known what presses and what slides, each sweep's steps are those of the one before
/// times a constant. Where that shows, p goes on to where the steps would add up to, as Aitken
/// extrapolates a sequence [Aitken1926], and the next sweep projects it. Where the constant is near
/// 1, as with a light body under a heavy one, or is 1, as where rows contradict each other, p comes
/// back if that sweep is no nearer.
template <class Rows, class Blocks>
RAGDOLL_INLINE bool projectedGaussSeidel(Rows& rows, Blocks& blocks, double* p, Sweeping sweeps) {
  const int m = rows.size();
  for (int i = 0; i < m; ++i)
    if (p[i] != 0) rows.push(i, 1, p + i);
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  double last_change = kUnknown, last_ratio = 0, before_leap = kUnknown;
  int endless = 0;
  bool leaps = sweeps.leaps;
  const auto leap = [&](double by) {
    for (SchurBlock& b : blocks) {
      const int count = b.has_tangents ? 3 : 1;
      for (int k = 0; k < count; ++k) p[b.row + k] += b.leap[k] *= by;
      rows.push(b.row, count, b.leap);
    }
  };
  if (sweeps.kind == Sweeps::kAlongTheSlip) keepSlips(rows, p, blocks);
  const bool batch = sweeps.kind == Sweeps::kBatch, impact = sweeps.kind == Sweeps::kOfAnImpact;
  const int most = batch ? kBatch : impact ? kMaxImpactSweeps : kMaxSweeps;
  const double tolerance = impact ? kImpactTolerance : kSweepTolerance;
  for (int iteration = 0; iteration < most; ++iteration) {
    double change = 0, largest = 0;
    for (SchurBlock& b : blocks) {
      double* now = p + b.row;
      double step[3] = {0, 0, 0};
      b.step[0] = b.step[1] = b.step[2] = 0;
      const auto set = [&](int k, double value) {
        b.step[k] = step[k] = value - now[k];
        now[k] = value;
        largest = std::max(largest, std::abs(value) * b.own[k]);
        change = std::max(change, std::abs(step[k]) * b.own[k]);
      };
      if (b.answer > 0) set(0, std::max(0.0, now[0] - rows.rate(b.row) * b.answer));
      if (!b.has_tangents) {
        if (step[0] != 0) rows.push(b.row, 1, step);
        continue;
      }
      const double limit = b.friction * now[0];
      if (b.tangent_answer > 0 && (limit > 0 || now[1] != 0 || now[2] != 0)) {
        double t[2];
        for (int k = 0; k < 2; ++k)
          t[k] = now[1 + k] - (rows.rate(b.row + 1 + k) + b.across[k] * step[0]) * b.tangent_answer;
        const double length2 = t[0] * t[0] + t[1] * t[1];
        if (length2 > limit * limit) {
          const bool keeps = b.slid[0] != 0 || b.slid[1] != 0;
          const double* along = keeps ? b.slid : t;
          const double share = keeps ? limit : limit / std::sqrt(length2);
          t[0] = share * along[0];
          t[1] = share * along[1];
        }
        set(1, t[0]);
        set(2, t[1]);
      }
      if (step[0] != 0 || step[1] != 0 || step[2] != 0) rows.push(b.row, 3, step);
    }
    if (change <= tolerance * largest) return true;
    if (batch) continue;
    const double nearest = before_leap;
    before_leap = kUnknown;
    if (nearest < kUnknown && change > kShrinks * nearest) {
      leaps = false;
      leap(-1);
      last_change = kUnknown;
      last_ratio = 0;
      continue;
    }
    const double ratio = change / last_change;
    endless = std::abs(ratio - 1) < kEndless ? endless + 1 : 0;
    if (endless == kEndlessSweeps) return false;
    last_change = change;
    const bool constant = std::abs(ratio - last_ratio) < kConstant * (1 - ratio);
    last_ratio = ratio;
    const bool far = ratio > kMostRatio;
    const double by = ratio / (1 - ratio);
    if (!constant || ratio < kLeastRatio || (far && !leaps)) continue;
    if (iteration + 2 >= most) break;
    if (by * change > kMostGrowth * largest) {
      leaps = false;
      continue;
    }
    for (SchurBlock& b : blocks) std::copy_n(b.step, 3, b.leap);
    leap(by);
    if (far) before_leap = change;
    last_change = kUnknown;  // the next sweeps' are of another sequence
    last_ratio = 0;
  }
  return false;
}

}  // namespace ragdoll
