// The velocity stage: no touching contact approaches, none slips more than friction allows; at an
// impact the fast ones bounce, by Newton's law (docs/equations.md#contacts-and-limits).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Which velocities are solved for.
enum class Stage {
  kMotion,  ///< at the end of a motion over h
  kImpact,  ///< the same, where something is hit: what pressed over h does its part before
  kBounce,  ///< an impact at the present pose, without a motion
  kStop,    ///< the same, in which nothing bounces
};

/// Keeps what touches at the end of the motion over h, with the position stage's impulses; the
/// rest does not act on velocities. h = 0: without impulses. leapfrog: springs act in its middle,
/// so that velocities get as much again.
void findTouching(Body& body, double h, bool leapfrog = true);

/// What the last solution of velocities came to. Until the next one.
struct VelocitySolution {
  /// [N s] by the rows of island.s.joint; null: nothing touches.
  const RowValues* impulses = nullptr;
  /// [J] kinetic, of each body before the impact; null: there was none.
  const std::vector<double>* energies = nullptr;
  double defect = 0;  ///< [m] of the motion (leapfrogDefect), in a part of a step; else 0
};

/// [m] that the motion over h, which ends at the present velocities and began at the saved ones,
/// differs from the trapezoidal rule with them: h^2/4 |a1 - a0| of the particle for which that is
/// most, 3/2 of what leapfrog's positions err by in a step [Hairer2006, sec. I.1.4].
double leapfrogDefect(const Island& island, double h);

/// Makes the motions over h and solves their velocities. damping: [s] of it at the motion's end,
/// before its impact.
VelocitySolution finishMotion(Island& island, double h, bool leapfrog, Stage stage, double damping);

/// Newton's impact law at the present pose for what touches: kBounce or kStop.
VelocitySolution bounce(Island& island, Stage stage = Stage::kBounce);

/// Velocities of what touches at the end pose, which the response holds.
VelocitySolution solveVelocities(Island& island, Stage stage, double h, double damping);

/// of(contact, its first row of the joint ones, its body, its place) of all that was solved for.
/// The place: of a body's own, its first row there; of pairs, which have no body, their number.
template <class Of>
void forEachTouching(const Island& island, const Of& of) {
  int row = 0;
  for (const Body* body : island.bodies)
    for (int own = 0; own < body->constraints.own_rows; ++own, ++row) {
      const Schur::Row& first = body->memory->schur.row(own);
      if (first.kind == Schur::Row::Kind::kNormal)
        of(body->touching.contacts[first.source], row, body, own);
    }
  const std::vector<Contact>& pairs = island.pairs.touching.contacts;
  for (std::size_t i = 0; i < pairs.size(); ++i, row += 3)
    of(pairs[i], row, static_cast<const Body*>(nullptr), static_cast<int>(i));
}

}  // namespace ragdoll
