// Projected Gauss-Seidel [Moreau1988], [Cottle1992, ch. 5] on the rows of one body or of several.
// Private to the core.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ragdoll_sim/core/schur.h"

namespace ragdoll {

/// Finds p of w = b + A p (schur.h), starting at p. Rows: size(); row(i), a Schur::Row; matrix(i,
/// j), of A; free(i), its diagonal without the sticks' answer; rate(i), w of row i, at first b;
/// push(i, step), which adds step times row i of A to w. Returns whether it settled.
template <class Rows>
bool projectedGaussSeidel(Rows& rows, Eigen::VectorXd& p) {
  constexpr int kMaxIterations = 100;  // most end after 5 to 30
  constexpr int kPatience = 20;        // iterations in which the changes have to shrink,
  constexpr double kProgress = 0.9;    // to this share at least
  constexpr double kSettled = 1e-7;    // largest change of an impulse, of the largest impulse
  constexpr double kHeld = 1e-9;       // below this share of its free value a row cannot move
  using Kind = Schur::Row::Kind;
  const int m = rows.size();
  for (int i = 0; i < m; ++i)
    if (p[i] != 0) rows.push(i, p[i]);
  double earlier = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    double change = 0, largest = 0;
    const auto set = [&](int i, double diagonal, double value) {
      const double step = value - p[i];
      largest = std::max(largest, std::abs(value) * diagonal);
      if (step == 0) return;
      change = std::max(change, std::abs(step) * diagonal);
      p[i] = value;
      rows.push(i, step);
    };
    for (int i = 0; i < m; ++i) {
      const Schur::Row& row = rows.row(i);
      if (row.held) continue;
      const double own = rows.matrix(i, i);
      if (row.kind != Kind::kTangent) {
        if (own > kHeld * rows.free(i)) set(i, own, std::max(row.least, p[i] - rows.rate(i) / own));
        continue;
      }
      const int j = i + 1;  // tangents come in pairs
      const double limit = row.friction * p[i - 1], other = rows.matrix(j, j);
      const bool moves = own > kHeld * rows.free(i) && other > kHeld * rows.free(j);
      if (moves && (limit > 0 || p[i] != 0 || p[j] != 0)) {
        const double a = std::max(own, other) + std::abs(rows.matrix(i, j));
        double ti = p[i] - rows.rate(i) / a, tj = p[j] - rows.rate(j) / a;
        const double length = std::sqrt(ti * ti + tj * tj);
        if (length > limit) {
          ti *= limit / length;
          tj *= limit / length;
        }
        set(i, own, ti);
        set(j, other, tj);
      }
      ++i;
    }
    if (change <= kSettled * largest) return true;
    if (iteration % kPatience != kPatience - 1) continue;
    if (change > kProgress * earlier) return false;  // no solution: impulses grow without end
    earlier = change;
  }
  return false;
}

}  // namespace ragdoll
