// The direct methods, shake and rk: a step of all bodies. Second order, symplectic, time-reversible
// where nothing presses (docs/equations.md#shake).
#pragma once

#include <vector>

#include "core/direct/workspace.h"

namespace ragdoll {

/// Gives the scratch its size: no step but the first asks for memory.
void makeRoom(const StepContext& context);

/// The same, multipliers of the state, and sweeps the obstacles: before the bodies of a step.
void prepareDirect(const StepContext& context);

/// Moves x and v of all awake ragdolls by the step; time, step count and obstacles are the
/// caller's.
void stepDirect(const StepContext& context, StepReport& report);

/// Those bodies' part of it, as one island (ascending; sleepers: near them). What presses is
/// appended, and marked in the context's supports.
void stepBodies(const StepContext& context, const std::vector<int>& bodies,
                const std::vector<int>& sleepers, std::vector<CachedImpulse>& impulses,
                std::vector<BodyPair>& pressing, StepReport& report);

/// As stepBodies for each of these bodies by itself, on the solver's threads; what presses goes to
/// the context.
void stepApart(const StepContext& context, const std::vector<int>& bodies, StepReport& report);

/// What pressed on sleepers goes on doing so: appends it.
void keepSleepersImpulses(const StepContext& context, std::vector<CachedImpulse>& impulses);

/// Positions <- where the body would go if it met nothing; velocities are left as they then are.
void predictFreely(const StepContext& context, int ragdoll);

}  // namespace ragdoll
