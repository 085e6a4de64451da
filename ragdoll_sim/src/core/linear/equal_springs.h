// How rows that depend on each other share what they press with: no law of rigid contact tells, but
// friction, and so the motion of what slides, depends on it. As springs of one stiffness under them
// would, which become rigid: with B = S A S, S = diag(A)^-1/2, of the rows that press and stick,
//
//     S^-1 p = lim (e 1 + B)^-1 S w,  e -> 0:
//
// of all that do the same the least, without a part in the kernel of B.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/linear/schur.h"

namespace ragdoll {

class EqualSprings {
 public:
  /// Whether something slides: else it does not matter how the load is shared.
  static bool anySlides(const std::vector<SchurBlock>& blocks, const double* p);

  /// p, shared so; friction that slides goes along. idle: rows of contacts and limits that touch
  /// without load, in their order. A(i, j): of the rows; again: as it was the last time. Returns by
  /// how much friction has changed at most, or will in the next sweep, or is beyond its cone, as a
  /// part of the largest impulse, both in units in which all rows yield alike: nothing else moves
  /// bodies.
  template <class Matrix>
  double share(const std::vector<SchurBlock>& blocks, const std::vector<int>& idle, const Matrix& A,
               bool again, double* p) {
    if (!collect(blocks, idle, p)) return 0;
    if (!again || !isKnown()) {
      const int m = static_cast<int>(rows_.size());
      B_.setZero(m, paddedWidth(m));
      for (int i = 0; i < m; ++i)
        for (int j = 0; j <= i; ++j)
          B_(i, j) = B_(j, i) = A(rows_[i].row, rows_[j].row) * rows_[i].scale * rows_[j].scale;
      startAnew();
    }
    return spread(blocks, p);
  }

 private:
  struct Pressing {
    int row;
    double scale;  ///< A(row, row)^-1/2, of both tangents of a contact the same
    bool pushes;   ///< and cannot pull
    bool slides;
    bool idle = false;  ///< without load, and so without friction, until now
  };
  /// rows_ <- what presses or touches, and what sticks. Whether there is something to share.
  bool collect(const std::vector<SchurBlock>& blocks, const std::vector<int>& idle,
               const double* p);
  /// Whether B_ is of rows_, and nothing has let go.
  bool isKnown() const;
  void startAnew();
  /// p from B.
  double spread(const std::vector<SchurBlock>& blocks, double* p);
  /// basis_ of the rows that have not let go.
  void findBasis();
  /// Rows of L: L^T L = B, as many as B has ranks.
  void factor();
  /// Of what is left the largest; -1: nothing.
  int findPivot(bool sliding) const;
  bool isPivot(int i) const;
  /// change_ <- what takes q_'s part in the kernel out of it.
  void findChange();
  /// Friction that slides, by what its contact presses with now. Returns the largest change.
  double slide(const std::vector<SchurBlock>& blocks, double* p);
  /// By how much friction that sticks is more than its contact holds now: it is to slide.
  static double beyondCones(const std::vector<SchurBlock>& blocks, const double* p);

  Roomy<Pressing> rows_;
  Roomy<int> known_;       ///< rows that B_ is of
  Roomy<int> pivot_;       ///< of L_'s rows
  bool depends_ = false;   ///< what slides, on other rows
  bool of_kernel_ = true;  ///< what basis_ spans: or else, where that is less, the range
  Growing<PaddedRows> B_, L_, basis_;
  RowValues q_, change_, left_, weights_;
};

}  // namespace ragdoll
