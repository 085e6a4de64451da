// What a step tells about itself.
#pragma once

namespace ragdoll {

/// What a step did that a user may want to know. Nothing is mended silently.
struct StepReport {
  int contacts = 0;  ///< contact points that pressed
  int substeps = 1;  ///< most substeps that any ragdoll took
  int guarded = 0;   ///< ragdolls for which the step guard changed the method or the step
  int limited = 0;   ///< ragdolls whose energy was limited: contact, limit's impact, implicit step
  int implicit = 0;  ///< implicit steps that the guard took in place of explicit ones
  int rigid = 0;     ///< motions with the joints frozen, where even implicit steps failed
  int joining = 0;   ///< ragdolls whose sticks were drawn towards their lengths from far
  int unresolved = 0;  ///< ragdolls whose constraints did not converge
  int fast_fallbacks = 0;  ///< method fast: ragdolls that took the step by shake
  int handed_over = 0;  ///< method rk: ragdolls' motions that shake took, where it could not
  double error_estimate = 0;  ///< [m/s] local error per simulated second, largest; 0: not estimated
  int tolerance_missed = 0;   ///< ragdolls whose error was larger than the tolerance, or not known

  /// Of other bodies of the same step.
  StepReport& operator+=(const StepReport& other);
};

inline StepReport& StepReport::operator+=(const StepReport& other) {
  contacts += other.contacts;
  substeps = substeps > other.substeps ? substeps : other.substeps;
  guarded += other.guarded;
  limited += other.limited;
  implicit += other.implicit;
  rigid += other.rigid;
  joining += other.joining;
  unresolved += other.unresolved;
  fast_fallbacks += other.fast_fallbacks;
  handed_over += other.handed_over;
  error_estimate = error_estimate > other.error_estimate ? error_estimate : other.error_estimate;
  tolerance_missed += other.tolerance_missed;
  return *this;
}

}  // namespace ragdoll
