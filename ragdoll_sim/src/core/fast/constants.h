// What the fast method is tuned by. What a change does: docs/fast_tables.md#constants.
#pragma once

#include <limits>

namespace ragdoll::fast {

constexpr int kMaxLanes = 16;  ///< bodies of a pack: floats in the widest vector
constexpr int kNewton = 3;     ///< linearised solves a step
/// Solves where something is left too deep; with three, three times as many steps go to shake.
constexpr int kMostRounds = 6;
constexpr int kSweeps = 4;                ///< Gauss-Seidel sweeps of each
constexpr int kRateSweeps = 20;           ///< of the velocities at the end
constexpr int kSweepsTogether = 16;       ///< of bodies that touch each other: heaps sink with 8
constexpr double kSettledSpeed = 1.2e-4;  ///< [m/s], [rad/s] sweeps that change less are the last
/// [rad^2] Linearised solves that leave less of second order are the last. In shorter steps than
/// kSettledStep [s] by the fourth power of them less: e rad of a step are e / h of a velocity, and
/// e / h^2 of it after a second, which is to stay of second order.
constexpr double kSettled = 1e-6;
constexpr double kSettledStep = 1.0 / 60;

constexpr double kRecovery = 0.2;     ///< of a violation, undone a step; 1 throws bodies up
constexpr double kRecoveryRate = 48;  ///< [1/s] of it: in short parts no faster
// As near boxes, spheres and capsules are looked for at most, beyond where the free motion leads:
// what contacts and joints may turn it aside by in a step.
constexpr double kMargin = 0.05;  ///< [m] at most
constexpr double kAside = 6;      ///< [m/s]
// What may take part: what is nearer than this, and than what the body's fastest particle covers in
// so many steps; an impact moves limbs that the free motion leaves alone.
constexpr double kNear = 0.01;  ///< [m]
constexpr double kReach = 1;    ///< steps
// What comes as near takes part in the rounds that follow; the others only wait for it: of the rows
// of a body on stairs, a half. Limits that wait up to 0.01 rad are exceeded by a degree more.
constexpr double kWake = 0.005;      ///< [m]
constexpr double kWakeAngle = 0.02;  ///< [rad]
constexpr double kNearAngle = 0.05;  ///< [rad]
constexpr double kTurnReach = 4;     ///< [rad/m] times what the fastest particle covers in a step
constexpr double kOwnTurn = 2;       ///< times what a link turns by, where no obstacle is near
constexpr double kLeastSine = 0.2;   ///< of a limit's angle: nearer to a pole its cosine is flat

// How solids are looked for in packs.
constexpr double kOnCore = 1e-9;     ///< [m] nearer there is no direction; guards divisions
constexpr double kInside = 1e-6;     ///< [m] a stick's axis nearer to a core runs through it
constexpr double kTouching = 1e-4;   ///< [m] what is as near does not come to touch
constexpr double kLocated = 2e-4;    ///< [m] a first touch is where the gap is less
constexpr int kLocations = 5;        ///< tries at most
constexpr double kGrazed = 5e-3;     ///< [m] what may enter by less on its way touches half way
constexpr double kFlat = 2e-3;       ///< [m] flat: a stick's gap over a face varies by less
constexpr double kStickTip = 0.002;  ///< of a stick: nearer to an end the particle touches

/// Of the product of what a point answers with along its axes, the determinant: with less it is
/// held by its links. Single precision tells no less.
constexpr double kHeld = 1e-5;
constexpr double kBounce = 4;  ///< [g h] slower approaches do not bounce: they are rest

constexpr double kMostSine2 = 0.9;     ///< a link that turns by more in a step is not for a pack
constexpr double kMostStretch = 1e-3;  ///< of a length at the start: the body is being joined

/// Share of a pack that bodies have to fill: a pack takes some three times as long as one body,
/// which goes alone.
constexpr double kPackFull = 0.3;

/// What a pack leaves is made again in so many parts of the step before it goes to shake: some 20
/// us of a body alone in place of 400. Two leave penetrations a fifth larger, eight are no better.
constexpr int kParts = 4;

constexpr double kSelfNear = 1e-3;      ///< [m] limbs this near touch
constexpr double kTouchOverlap = 2e-3;  ///< [m] bodies that overlap by more take the step anew

/// What a step, or a part of one, may leave.
struct StepBounds {
  double particle, stick;  ///< [m] in an obstacle, deeper than it was
  double missed;           ///< [m/s] of what touches none: as much energy as this speed has
  double stopped;          ///< [m/s] what comes faster is hit at a time that is looked for
};
/// What leaves more is made again (kParts): the median of falls' penetrations is 0.6 to 0.8 mm,
/// with 4 mm of particles 1.4 to 2.4, for a tenth of the time. Sticks at 3 mm: a fifth more of it.
/// Energy, 2 J in a human: after 1 s of `hang` 70 mm off (without 266), with free joints 27 (798);
/// what falls is hardly ever made again. Impacts, found in time: 1 m/s leaves 0.8 of the error that
/// 2 m/s leave, for 1.2 of the instructions.
constexpr StepBounds kOfStep = {0.0008, 0.008, 0.24, 2};
constexpr double kStopReach = 4;           ///< [rad/m] of limits' speeds
constexpr double kImpactShare = 1.0 / 16;  ///< of the step: a part that has an impact
constexpr double kBeforeImpact = 0.9;      ///< of that part
constexpr int kMostFound = 6;              ///< impacts of a body in a step
constexpr double kNone = std::numeric_limits<double>::infinity();
/// What leaves more goes to shake.
constexpr StepBounds kOfPart = {0.004, 0.015, kNone, kNone};
// What rests and begins deeper goes to shake, which brings it out: more than packs leave.
constexpr double kSunkParticle = 0.006;  ///< [m] in an obstacle
constexpr double kSunkStick = 0.02;      ///< [m] likewise; and bodies in each other that rest
constexpr double kRests = 0.05;          ///< [m/s] by their energy: slower
constexpr double kWorse = 0.5;      ///< of a bound: than a deep particle is to be after the step
constexpr double kDeeper = 0.25;    ///< of a bound: what is sunk may sink on
constexpr double kMostAngle = 0.1;  ///< [rad] of a limit

/// [m/s] What nothing presses may gain in a step as much energy as this speed has, 0.5 J in a
/// human: velocities of an impact lie along tangents, those of a step that follows along chords,
/// and limbs that turn fast seem to gain up to 1 %. Without a bound up to 15 J; a share of the
/// kinetic energy in place of it shows in what just tumbles.
constexpr double kFreeGain = 0.12;
constexpr double kNoBound = 1e30;  ///< [J]

/// Of links that turn by more in a step, no guess (lane_guess.h).
constexpr double kGuessSine2 = 0.1;

constexpr double kReportedShare = 1e-6;  ///< of a motion: less that is drawn back is rounding
constexpr double kUnseenShare = 5e-3;    ///< of an energy: less hardly moves what touches

constexpr int kSlots = 4;  ///< contacts of one particle or stick beside those with planes

}  // namespace ragdoll::fast
