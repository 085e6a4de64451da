// Sleeping: a body at rest costs nothing until something disturbs it.
//
// A body falls asleep when none of its particles has moved faster than a speed for a time:
//   what lies on something   kStillSpeed for kQuietTime, and it is held: some contact sticks, its
//                            friction inside the cone, or it is slower than kHeldSpeed. So what
//                            slides as a whole goes on, however slowly
//   what hangs from pins     kHungSpeed for kHungTime, also where it touches something: nothing but
//                            its own balance need hold it, and at its turning points a swing is
//                            slow, too. Of one of period T that time shows the fastest if
//                            T <= 2 kHungTime; of a slower one a part of sin(pi kHungTime / T), so
//                            that of T = 10 s swings of less than 0.3 mm are ended, of a minute's
//                            less than 1 cm
//   what floats              kFloatSpeed for kHungTime: what drifts, however slowly, goes on
// Nothing but damping makes a hung body hang still: `damping` its swing about the pin, and its spin
// if there is one pin; `joint_damping` the motion of its limbs. The sweeps of `jakobsen` drive a
// slow spin about a single pin (docs/trade.md), so that there it may never sleep.
//
// Bodies that press on each other fall asleep together, when the last of them has been still. A
// body wakes when a poke acts on it, an obstacle moves within reach, a pin of it moves, a body that
// is not still itself touches it, or a setting changes (wakeAll). While a poke acts it stays awake.
#pragma once

#include <cstdint>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

struct Contact;
struct Supports;

constexpr double kStillSpeed = 0.01;  ///< [m/s]
constexpr double kHeldSpeed = 1e-5;   ///< [m/s] slower than that nothing need hold it
constexpr double kQuietTime = 0.5;    ///< [s]
constexpr double kHungSpeed = 1e-4;   ///< [m/s]
constexpr double kHungTime = 2;       ///< [s]
constexpr double kFloatSpeed = 1e-9;  ///< [m/s] 3 cm in a year

/// Before a step of h [s]: wakes what the inputs disturb, and keeps it awake.
void wakeDisturbed(const Model& model, const Inputs& inputs, double h, State& state);

/// Within a step: wakes sleepers that a body touches or is about to touch, unless it lies still
/// itself. x1: where the bodies would go. Returns whether any woke.
bool wakeTouched(const std::vector<Contact>& contacts, const Points& x1, State& state);

/// After a step of h [s]: puts to sleep what has been still long enough. Who lies on a body that
/// lies on something lies on something, and bodies that press on each other fall asleep together or
/// not at all. supports: of this step; who lies on something is marked as pressed.
void putToSleep(const Model& model, double h, Supports& supports, State& state);

/// After a change of settings, pins or obstacles.
void wakeAll(State& state);

}  // namespace ragdoll
