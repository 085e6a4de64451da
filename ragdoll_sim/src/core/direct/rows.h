// The candidates that are solved for, as rows of the body's Schur complement, and their gaps.
#pragma once

#include <cmath>

#include "core/direct/body.h"

namespace ragdoll {

/// Rows of the contacts and limits that are violated or nearly so after the present motion over h,
/// pressed in the last one, or are active in any case. leapfrog: soft limits act in its middle.
void buildRows(Body& body, double h, bool leapfrog);

/// body.b <- the gaps [m], angles [rad] and slips [m] of the body's own rows after the motion.
void evaluateGaps(Body& body, double h);

/// Rows of contacts that give way get their compliance, once the Schur complement is assembled.
/// Whether there are any.
bool soften(Body& body, double h, bool leapfrog);

/// [m] the worst of the rows after the motion; of limits seen on kLever.
double worstResidual(Body& body, bool closed);

/// p (the body's own rows) <- what pressed in the last motion; and body.cache <- what presses now.
void warmStart(const Body& body, double h, Eigen::Ref<Eigen::VectorXd> p);
void rememberImpulses(Body& body, double h);

}  // namespace ragdoll
