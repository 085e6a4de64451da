// One-sided constraints and friction of one body beside its sticks: the Schur complement.
//
// The sticks are eliminated exactly, A = J_c (W - W J_s^T (J_s W J_s^T)^-1 J_s W) J_c^T, and
// projected Gauss-Seidel [Moreau1988], [Cottle1992, ch. 5] finds impulses p of w = b + A p with
//   normal and limit rows:  p >= 0, w >= 0, p w = 0;
//   tangent rows:           |p_t| <= mu p_n, against the slip: the isotropic Coulomb disc, no
//   pyramid.
// Works on displacements (b: gaps [m], slips [m]) and on velocities (b: rates) alike.
#pragma once

#include <array>
#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"
#include "core/linear/constants.h"
#include "core/linear/stick_solver.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// What sweeps are to do.
enum class Sweeps {
  kToTheEnd,
  kOfAnImpact,  ///< the same, until small impulses beside a large one are exact, too: nothing mends
                ///< them
  kBatch,       ///< a few as they are, for who extrapolates from batch to batch
  /// Friction that slides at the first p, at the edge of its disc and against the slip, keeps its
  /// direction while it slides.
  kAlongTheSlip,
};

/// The same, and how far they go.
struct Sweeping {
  Sweeps kind;
  bool leaps;  ///< also where their steps hardly shrink they go on to where these add up to
  /// [m], [m/s] Rows that depend on each other and contradict each other by less agree.
  double contradiction = kAgreeing;

  Sweeping(Sweeps what, bool also_leaps = true) : kind(what), leaps(also_leaps) {}
};

/// A limit, or a contact with its friction: what a sweep solves for at once.
struct SchurBlock {
  int row = 0;                ///< its first
  bool has_tangents = false;  ///< and two rows of friction after it
  double friction = 0;
  double own[3] = {0, 0, 0};   ///< A's diagonal
  double across[2] = {0, 0};   ///< of A: first row, tangents
  double answer = 0;           ///< 1 / own[0]; 0: cannot move
  double tangent_answer = 0;   ///< of both tangents; 0: neither can move
  double step[3] = {0, 0, 0};  ///< of the impulses, by the last sweep
  double leap[3] = {0, 0, 0};  ///< by the last extrapolation
  double slid[2] = {0, 0};     ///< direction of friction that keeps it (Sweeps), or 0
};

class Schur {
 public:
  static constexpr int kMaxParticles = LimitRow::kMaxParticles;

  struct Row {
    enum class Kind { kLimit, kNormal, kTangent };
    Row() {}  // leaves the arrays as they are
    Kind kind;
    int source;  ///< index of its contact or limit
    int count;
    std::array<int, kMaxParticles> particle;  ///< of the body
    std::array<Vec3, kMaxParticles> gradient;
    Vec3 direction = Vec3::Zero();  ///< contact: of the impulse, unit
    double compliance = 0;          ///< added to A's diagonal
    double friction = 0;            ///< normal rows: of the two tangent rows that follow
    bool locked = false;            ///< its impulse stays as it is
    bool given = false;             ///< the same, but its friction is solved for

    /// gradient times x, the body's first coordinates.
    double along(const double* x) const {
      double sum = 0;
      for (int k = 0; k < count; ++k)
        sum += gradient[k].dot(Eigen::Map<const Vec3>(x + 3 * particle[k]));
      return sum;
    }
  };

  /// Forgets the assembly before.
  void forget() {
    assembled_ = false;
    before_.rows.clear();
  }
  /// first: the body's first column of the state.
  void start(int first);
  void addContact(const Contact& contact, int source) {
    addContact(contact, source, 0, contact.count);
  }
  /// The part of a contact that its particles begin ... end - 1, this body's, have in it.
  void addContact(const Contact& contact, int source, int begin, int end);
  void addLimit(const LimitRow& limit, int source);
  bool empty() const { return now_.rows.empty(); }
  int size() const { return static_cast<int>(now_.rows.size()); }
  const Row& row(int i) const { return now_.rows[i]; }
  void lock(int i, bool locked = true) { now_.rows[i].locked = locked; }
  void give(int i) { now_.rows[i].given = true; }
  /// Takes its friction from the contact that was added last, whose rows begin at i.
  void smooth(int i) {
    for (int k = i; k < size(); ++k) now_.rows[k].friction = 0;
  }
  /// The row's compliance, once A is assembled: it may depend on how the row answers.
  void soften(int i, double compliance) {
    now_.A(i, i) += compliance - now_.rows[i].compliance;
    now_.rows[i].compliance = compliance;
  }
  auto matrix() const { return now_.A.leftCols(size()); }

  /// A at the pose of `sticks`. What the assembly before has of the same rows at the same pose
  /// serves again: velocities at a step's end and positions from there on have most in common.
  void assemble(const StickRows& constants, StickSolver& sticks);

  /// p from b, starting at p. Returns whether it settled.
  bool solve(const Eigen::Ref<const Eigen::VectorXd>& b, Eigen::Ref<Eigen::VectorXd> p,
             Sweeping sweeps = Sweeps::kToTheEnd);

  /// out (3 x n, columns) += what the impulses p do, the sticks answering as at assemble.
  void move(const Eigen::Ref<const Eigen::VectorXd>& p, double* out);

  double along(int i, const double* x) const { return now_.rows[i].along(x); }

  // For rows that several bodies share (joint_schur.h).
  const std::vector<SchurBlock>& blocks() const { return blocks_; }  ///< of the last solution
  double entry(int i, int j) const { return now_.A(i, j); }
  double free(int i) const { return now_.free[i]; }  ///< A(i, i) without the sticks' answer
  void clearRates() { w_.setZero(columns_); }
  double rate(int i) const { return w_[i]; }  ///< by the impulses since then
  /// Of all rows, by `count` impulses that begin at row i.
  void addRates(int i, int count, const double* impulses);

 private:
  struct Assembly {
    Roomy<Row> rows;
    RowValues pose;               ///< [m] padded
    Growing<PaddedRows> A;        ///< rows x padded rows
    Growing<PaddedRows> answers;  ///< motions by unit impulses of the rows, padded coordinates
    RowValues free;               ///< A's diagonal without the sticks' answer
  };

  /// known_ <- the row of the assembly before that each one is, -1: none. In the same order, as the
  /// bits of A depend on it. Whether all are the same.
  bool findKnown();
  /// A from the answers.
  void findMatrix(const StickRows& constants);
  /// Of row i: its answer, and its part of the diagonal without the sticks.
  void findAnswer(const StickRows& constants, StickSolver& sticks, int i);
  int first_ = 0, columns_ = 0;
  int count_ = 0;  ///< of the body's coordinates
  Assembly now_, before_;
  bool assembled_ = false;  ///< now_
  Roomy<int> known_;
  Roomy<int> place_;            ///< of each particle in turned_; -1: no row acts on it
  Growing<PaddedRows> turned_;  ///< the answers' coordinates of these particles x padded rows
  Roomy<SchurBlock> blocks_;
  RowValues w_, moved_;
};

/// How many rows are solved for together with a first one: with friction its two tangents, too.
inline int rowsOf(const Schur::Row& first) { return first.friction > 0 ? 3 : 1; }

}  // namespace ragdoll
