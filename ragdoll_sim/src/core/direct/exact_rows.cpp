#include "core/direct/exact_rows.h"

#include "core/direct/mode_solve.h"

namespace ragdoll {
namespace {

/// What is solved for: p = start + change, change >= 0 where a row only pushes.
struct Remaining {
  ModeMatrix A;
  ModeVector b, change;
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, kMostModeRows, 1> row;  ///< of the island's
};

/// The rows that are solved for: their blocks, and what they start at. False: too many.
bool choose(const JointSchur& joint, const RowValues& p, std::vector<ModeBlock>& blocks,
            RowValues& start, Remaining& rest) {
  blocks.clear();
  start = p;
  rest.row.resize(0);
  for (int i = 0, count = 0; i < joint.size(); i += count) {
    const Schur::Row& row = joint.row(i);
    count = rowsOf(row);
    if (row.locked || row.given) continue;
    const int first = static_cast<int>(rest.row.size());
    if (first + count > kMostModeRows) return false;
    ModeBlock& block = blocks.emplace_back();
    block.row = first;
    block.friction = row.friction;
    rest.row.conservativeResize(first + count);
    for (int k = 0; k < count; ++k) {
      rest.row[first + k] = i + k;
      start[i + k] = 0;
    }
  }
  return rest.row.size() > 0;
}

void build(const JointSchur& joint, const RowValues& b, const RowValues& start, Remaining& rest) {
  const int m = static_cast<int>(rest.row.size());
  rest.A.resize(m, m);
  rest.b.resize(m);
  rest.change.setZero(m);
  for (int i = 0; i < m; ++i) {
    rest.b[i] = b[rest.row[i]];
    for (int j = 0; j < joint.size(); ++j)
      if (start[j] != 0) rest.b[i] += joint.entry(rest.row[i], j) * start[j];
    for (int j = 0; j < m; ++j) rest.A(i, j) = joint.entry(rest.row[i], rest.row[j]);
  }
}

}  // namespace

bool solveExactly(Island& island, const RowValues& b, RowValues& p) {
  IslandScratch& s = island.s;
  Remaining rest;
  if (!choose(s.joint, p, s.mode.blocks, s.start, rest)) return false;
  build(s.joint, b, s.start, rest);
  const double scale = impulseScale(rest.A, rest.b);
  if (!solveComplementarity(rest.A, rest.b, scale, s.mode.blocks, rest.change)) return false;
  p = s.start;
  for (int i = 0; i < rest.row.size(); ++i) p[rest.row[i]] += rest.change[i];
  return true;
}

}  // namespace ragdoll
