// Constraints of several bodies that touch each other: each body's Schur complement (schur.h), with
// the contacts between two bodies as rows of both. A row's answer is the sum of its bodies'.
//
// Cost grows with the number of rows and of rows per body, not with the bodies' product: there is
// no common matrix.
#pragma once

#include <array>
#include <vector>

#include "core/base/growing.h"
#include "core/linear/equal_springs.h"
#include "core/linear/schur.h"
#include "core/linear/sweep_batches.h"

namespace ragdoll {

class JointSchur {
 public:
  /// For as many bodies.
  void makeRoom(int bodies) {
    answers_.resize(bodies);
    rows_.reserve(bodies * kRoomForRows);
    blocks_.reserve(bodies * kRoomForRows);
  }
  /// shares_load: whether rows that depend on each other share what they press with as springs do.
  void clear(bool shares_load);
  /// A body's complement; its present rows become rows here, in their order. Returns its number.
  int addBody(Schur& schur);
  /// A contact between bodies (numbers, -1: one that does not move) that both hold from that row
  /// on.
  void addShared(const Contact& contact, int body, int row, int other, int other_row);
  int size() const { return static_cast<int>(rows_.size()); }
  /// First row of a body's own ones.
  int firstOf(int body) const { return first_[body]; }
  const Schur::Row& row(int i) const;
  /// Of the whole row, with its compliance: A(i, i). And as of a body's complement.
  double answer(int i) const;
  /// A(i, j).
  double entry(int i, int j) const;
  /// Of motions x of the bodies, along row i. at[k]: where body k's coordinates begin in x.
  double along(int i, const double* x, const std::vector<int>& at) const;
  void soften(int i, double compliance);
  void give(int i);
  void lock(int i, bool locked);

  /// p from b, starting at p. Returns whether it settled.
  bool solve(const RowValues& b, RowValues& p, Sweeping sweeps = Sweeps::kToTheEnd);
  /// Takes back friction that another solution, or a load shared anew, leaves outside its cone, as
  /// sweeps would.
  void holdInCones(RowValues& p) const;
  /// Goes on where solve gave up, with the same b (sweep_batches.h). Whether it settled.
  bool solveOn(const RowValues& b, RowValues& p);

  /// What of p belongs to each body's rows, in their order; parts may be more than bodies.
  void split(const RowValues& p, std::vector<RowValues>& parts) const;

  /// sum += share A p, with p's parts.
  void addAnswer(double share, const std::vector<RowValues>& parts, RowValues& sum);

 private:
  struct Row {
    std::array<int, 2> body{-1, -1}, row{-1, -1};  ///< -1: none
  };
  struct View;

  /// Sweeps from p on, whatever the shares. Whether they settled.
  bool sweep(const RowValues& b, RowValues& p, Sweeping sweeps);
  /// EqualSprings::share.
  double share(RowValues& p, bool again);
  const std::vector<SchurBlock>& blocks() const;
  /// w = b + A p of one row.
  double rateOf(int i, const RowValues& b, const RowValues& p) const;
  /// Where sweeps go on for ever, as rows that depend on each other contradict each other: takes
  /// what is left of those that press and stick out of shared_, b. Whether none had more than
  /// `most`.
  bool takeLeft(double most, const RowValues& b, const RowValues& p);
  /// idle_ <- rows without load that touch, but for `most`; that is taken out of shared_.
  void findIdle(double most, const RowValues& p);

  /// The first body that holds the row and does move: what the row has once, it has there.
  int sideOf(int i) const { return rows_[i].body[0] >= 0 ? 0 : 1; }

  /// All rows are one body's, in its order: its own matrix answers, by vectors.
  bool isOneBody() const { return bodies_.size() == 1; }

  bool shares_load_ = true;
  Roomy<Schur*> bodies_;
  Roomy<int> first_;
  Roomy<Row> rows_;
  Roomy<SchurBlock> blocks_;
  EqualSprings springs_;
  SweepBatches batches_;
  Roomy<int> idle_;
  RowValues shared_;  ///< b, without what contradicts itself
  RowValues diagonal_;
  std::vector<RowValues> answers_;  ///< per body
};

}  // namespace ragdoll
