// The candidates that are solved for, as rows of Schur complements, and their gaps: each body's own
// contacts and limits, and the contacts between bodies of an island beside them. What is said of an
// island is so of all its rows together.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Without leaps where relaxation moves the bodies: they sank in more with them
/// (test/laws/lying_start_test.cpp).
inline Sweeping sweepsOf(const Island& island, Sweeps kind) {
  return {kind, !island.context.relaxed};
}

/// Rows of the contacts and limits that are violated or nearly so after the present motion over h,
/// pressed in the last one, or are active in any case.
void buildRows(Body& body, bool leapfrog);
void buildRows(Island& island, bool leapfrog);

/// Adds a contact's rows to both bodies' complements and to the joint rows; returns the first.
/// smooth: without its friction.
int addPairRows(Island& island, const Contact& contact, int source, bool smooth = false);

/// b <- the gaps [m], angles [rad] and slips [m] of the rows (the body's own ones) after the
/// motion, in which the body turns with others by `turn` [rad]; so bodies turn together, until the
/// next call.
void evaluateGaps(Body& body, double h, const Vec3& turn, Eigen::Ref<Eigen::VectorXd> b);
const CommonTurns& evaluateGaps(Island& island, double h, RowValues& b);

/// Rows of contacts that give way get their compliance, once the Schur complements are assembled.
/// Whether there are any.
bool soften(Island& island, double h, bool leapfrog);

/// Whether a row is violated by its gap b, or a spring presses at the motion's start: it does until
/// it is let go.
bool anyCloses(const Island& island, const RowValues& b);

/// [m] the worst of the rows after the motion; of limits seen on kLever. closed: also what is open
/// while it presses.
double worstResidual(Body& body, bool closed);
double worstResidual(Island& island, bool closed);

/// p (of a body its own rows) <- what pressed in the last motion; and the caches <- what presses
/// now: total of island and bodies.
void warmStart(Body& body, double h, Eigen::Ref<Eigen::VectorXd> p);
void warmStart(Island& island, double h, RowValues& p);
void rememberImpulses(Body& body, double h);
void rememberImpulses(Island& island, double h);

}  // namespace ragdoll
