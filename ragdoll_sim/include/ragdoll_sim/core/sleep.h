// Sleeping: a body at rest on something costs nothing until something touches it.
//
// A body falls asleep when none of its particles has moved faster than kStillSpeed for kQuietTime
// while something pressed on it: what floats or swings free never sleeps, however slowly. Bodies
// that press on each other fall asleep together, when the last of them has been still. A body wakes
// when a poke acts on it, an obstacle moves within reach, a pin of it moves, a body that is not
// still itself touches it, or a setting changes (wakeAll).
#pragma once

#include "ragdoll_sim/core/contact.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

constexpr double kStillSpeed = 0.01;  ///< [m/s]
constexpr double kQuietTime = 0.5;    ///< [s]

/// Before a step of h [s]: wakes what the inputs disturb.
void wakeDisturbed(const Model& model, const Inputs& inputs, double h, State& state);

/// Within a step: wakes sleepers that a body touches or is about to touch, unless it lies still
/// itself. x1: where the bodies would go. Returns whether any woke.
bool wakeTouched(const std::vector<Contact>& contacts, const Points& x1, State& state);

/// After a step of h [s]: puts to sleep what has been still long enough. pressed: per ragdoll,
/// whether an obstacle pressed in this step. pressing: who lies on a body that lies on something
/// lies on something, and bodies that press on each other fall asleep together or not at all.
void putToSleep(const Model& model, const std::vector<BodyPair>& pressing, double h,
                std::vector<std::uint8_t>& pressed, State& state);

/// After a change of settings, pins or obstacles.
void wakeAll(State& state);

}  // namespace ragdoll
