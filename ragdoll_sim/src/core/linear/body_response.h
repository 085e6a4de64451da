// How one body answers to what acts on it: the interface behind which its sticks are solved.
//
// A step of a direct method looks at two poses of a body, its start and its end. Here both hold the
// direct solution of the sticks (stick_solver.h), and the questions of a step are answered:
//   free motion onto the constraints   alongStart: SHAKE's impulses along the old directions
//   back onto the lengths              alongEnd: the nearest pose, along the new directions
//   the answer to a row                assemble: the rows of a Schur complement
//   the answer to a force              accelerate: [m/s^2] with the lengths kept, for stages
//   the same without the sticks        push
//   onto lengths that are far off      relaxInTurn
//   how near its sticks are to depending on each other   condition
// Whoever solves the sticks in another way (a tree in its tangent coordinates) stands beside this.
#pragma once

#include <cmath>
#include <utility>

#include "core/linear/schur.h"
#include "core/linear/stick_solver.h"

namespace ragdoll {

/// The lengths that sticks shall have, padded as StickRows::length2.
struct StickLengths {
  const double* length2 = nullptr;          ///< [m^2]
  const double* inverse_length2 = nullptr;  ///< [1/m^2]
  double tolerance = 0;                     ///< relative error of a squared length, for alongEnd
};

class BodyResponse {
 public:
  /// Sizes everything; what is known of a pose stays where the sizes are the same.
  void bind(const DirectSystem& system);

  /// x: coordinates of the body's first particle. A pose that is known already costs nothing.
  void setStart(const double* x) { start_.setPose(*rows_, x); }
  void setEnd(const double* x) { end_.setPose(*rows_, x); }
  /// The end is where the next motion starts.
  void endIsStart() { std::swap(start_, end_); }
  const StickRows& rows() const { return *rows_; }
  /// [m^2] of a stick at the start.
  double startLength2(int stick) const;
  /// Relative error of the worst squared length at the start.
  double startError(const StickLengths& lengths);

  /// dx (3 x n) += the impulses lambda along the start's directions, scaled by kg/s^2 h^2.
  void impulse(const double* lambda, Points& dx) { start_.move(*rows_, lambda, 1, dx.data()); }

  /// Newton's method along the start's directions until every stick has its length after dx; lambda
  /// (padded) takes the impulses. False: it did not converge, and dx is as it was.
  bool alongStart(const StickLengths& lengths, Points& dx, Eigen::VectorXd& lambda);
  /// One more solution after that, to rounding: a body with its exact angular momentum turns off by
  /// as much as its lengths are.
  void polishAlongStart(const StickLengths& lengths, Points& dx);

  /// The same along the directions at the end, which follows: x (3 x n) + dx.
  template <class X>
  bool alongEnd(const StickLengths& lengths, const X& x, Points& dx, Eigen::VectorXd& lambda) {
    for (int iteration = 0; iteration < kMaxRelaxations; ++iteration) {
      pose_ = x + dx;
      end_.setPose(*rows_, pose_.data());
      const double worst = endResiduals(lengths);
      if (worst < lengths.tolerance) return true;
      if (!std::isfinite(worst)) return false;
      end_.solve(*rows_, residual_.data());
      lambda += residual_;
      end_.move(*rows_, residual_.data(), 1, dx.data());
    }
    return false;
  }

  /// Takes from velocities v (3 x n) what would stretch the sticks at the end, or the start.
  void projectAtEnd(double* v) { end_.projectVelocities(*rows_, v); }
  void projectAtStart(double* v) { start_.projectVelocities(*rows_, v); }

  /// [m/s^2] free (3 x n): accelerations without the sticks, which accelerate adds to.
  void setFree(const Points& free);
  /// out (3 x n) = free + W J^T lambda with J out = -J' v: lengths stay as they are under
  /// velocities v at the end, or the start. Returns lambda [kg/s^2], padded.
  const Eigen::VectorXd& accelerate(bool at_end, const double* v, double* out);

  /// v (3 x n) += what an impulse on one particle does without the sticks.
  void push(int particle, const Vec3& impulse, Eigen::Ref<Points> v) const {
    v.noalias() += impulse * system_->W.row(particle);
  }

  /// Moves x (3 x n) stick by stick, where Newton's method fails.
  void relaxInTurn(const StickLengths& lengths, int sweeps, Points& x) const;

  /// Of the sticks' system at rest, scaled to a unit diagonal: largest by smallest eigenvalue.
  double condition() const { return system_->condition; }

  /// The rows' answers at the end, or the start.
  void assemble(Schur& schur, bool at_end) { schur.assemble(*rows_, at_end ? end_ : start_); }

 private:
  static constexpr int kMaxRelaxations = 60;  ///< Newton iterations along new directions

  /// D1_ <- the sticks of the start after dx; residual_ is empty.
  void setSticksAfter(const Points& dx);
  /// residual_ <- what is missing to the length of each of D1_; the largest relative error.
  double findResiduals(const StickLengths& lengths);
  /// residual_ <- what is missing to each stick's length at the end; the largest relative error.
  double endResiduals(const StickLengths& lengths);

  const DirectSystem* system_ = nullptr;
  const StickRows* rows_ = nullptr;
  StickSolver start_, end_;
  PaddedRows D1_;
  Eigen::VectorXd residual_, correction_;
  Points pose_, free_;
  PaddedRows pulls_, rates_;  ///< of the sticks: free_, velocities
  Eigen::VectorXd lambda_;
};

}  // namespace ragdoll
