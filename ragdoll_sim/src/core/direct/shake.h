// Leapfrog with the sticks solved directly: second order, symplectic, time-reversible.
//
// One step of one body, in increments dx so that nothing is lost far from the origin:
//   v_half = v + h/2 a,  dx = h v_half + D0 diag(lambda) (B W)  with |d1| = L   (SHAKE,
//   [Ryckaert1977]) v1 = dx / h + h/2 a + D1 diag(kappa) (B W)  with d1 . d1' = 0 (RATTLE,
//   [Andersen1983])
// Impulses act along the OLD stick directions D0; Newton's matrix is G o (D0^T D0), factorised once
// per step because the velocity stage of a step and the position stage of the next share it.
// Contacts and limits join both stages by the Schur complement (schur.h). docs/equations.md#shake.
#pragma once

#include <vector>

#include "core/contact/contact.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

/// Moves x and v of all awake ragdolls by h; time, step count and obstacles are the caller's.
void stepShake(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
               State& state, StepReport& report);

/// Sizes what bodies need and sweeps the obstacles; before the bodies of a step.
void prepareShake(const Model& model, const Inputs& inputs, Workspace::Impl& ws, State& state);

/// One body's part of it; its presses are appended to ws.presses.
void stepBodyShake(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                   State& state, int ragdoll, StepReport& report);

}  // namespace ragdoll
