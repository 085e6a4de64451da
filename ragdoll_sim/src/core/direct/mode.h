// A mode of an island's motion: which limits press, which contacts are closed, and which of these
// stick; what gives way presses by its spring and damper. While it lasts the motion is smooth
// (docs/equations.md#event-driven-rk).
#pragma once

#include <array>
#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"
#include "core/direct/dormand_prince.h"
#include "core/direct/mode_solve.h"
#include "core/linear/stick_kernels.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// What may press.
struct ModeRow {
  enum class Kind { kParticle, kStick, kLimit, kPair };
  Kind kind = Kind::kParticle;
  int body = 0;           ///< place in the island
  int a = 0, b = 0;       ///< particles of the body; of a stick both
  int obstacle = -1;      ///< of the step's
  int limit = -1;         ///< of the skeleton
  double ra = 0, rb = 0;  ///< [m]
  // kPair: particle or stick on particle or stick; of what gives way two whole capsules.
  int other = 0;          ///< place of the body of c and d
  int c = 0, d = 0;       ///< as a and b
  double rc = 0, rd = 0;  ///< [m]
  double rest = 0;        ///< [m] of the gap that counts as none: what steps of shake leave
  double friction = 0, restitution = 0;
  Compliance give;  ///< limits: [rad/(N m)], [N m s/rad]
  // Of the present mode.
  bool closed = false;     ///< gap and rate are zero; of what gives way: it presses
  bool presses = false;    ///< an equality; of what gives way: by its spring and damper
  bool sticks = false;     ///< presses: so are its tangents
  bool impending = false;  ///< slip is impending (ModeBlock::impending)
  bool moves = false;      ///< slips, in the direction:
  Vec3 slip = Vec3::Zero();
  bool slow = false;  ///< slips so slowly that friction turns it at once (mode_slow_slips.h): about
  Vec3 along = Vec3::Zero();     ///< unit, there
  std::array<int, 3> feature{};  ///< where it touches, as RowPlace::feature
  double gap_start = 0;          ///< [m], [rad] at the start of the present piece
  double gap_noise = 0;          ///< likewise: how far below that it is not met yet
  double answer = 0;             ///< [1/kg] to a push along the normal: of springs that press

  bool isSoft() const { return give.compliance > 0; }
  bool isContact() const { return kind != Kind::kLimit; }
  /// Two capsules press on each other at the ends, or between them, that `feature` says.
  bool keepsToFeature() const { return kind == Kind::kPair && isSoft() && presses; }
  bool isShared() const { return kind == Kind::kPair && other != body; }
};

/// Where a row stands at a pose.
struct RowPlace {
  double gap = 0;        ///< [m], [rad]
  double curvature = 0;  ///< second derivative of the gap along the motion, without accelerations
  Vec3 turn = Vec3::Zero();     ///< [m/s^2] along the surface: as place and normal move
  Vec3 surface = Vec3::Zero();  ///< [m/s] of the obstacle where it is touched
  Vec3 moves = Vec3::Zero();    ///< [m/s] of a pair: how the way between its places changes
  bool regular = true;          ///< false: it has no such derivative here
  double at = 0;                ///< of a stick: from a (0) to b (1)
  bool inside = true;           ///< likewise: between its ends
  /// -1, 0, 1: beyond which faces of the obstacle's core; of a pair that gives way at which end of
  /// its first and second stick (0: between them), then at which end of their overlap (1, 2) if
  /// they lie along each other; of a limit LimitRow::border.
  std::array<int, 3> feature{};
  Contact contact;  ///< of all but kLimit
  LimitRow limit;   ///< kLimit
};

/// Forces of the rows at one instant.
struct ModeForces {
  Roomy<double> normal;  ///< [N], [N m]
  Roomy<Vec3> friction;  ///< [N]
  Roomy<double> idle;    ///< of what is closed and does not press, as findIdleLoads says
};

/// Where a body of n particles has its clock: after its coordinates, so that it goes along with
/// their motion. It is the time [s] since the beginning of the step, by which obstacles move.
inline int clockPlace(int n) { return paddedWidth(3 * n); }

/// A motion's state at one instant: padded coordinates of one body after the other (Mode::offset),
/// each with its clock.
struct ModePoint {
  RowValues x, v, a;
  ModeForces forces;
  double power = 0;  ///< [W] of what is counted in Body::given
};

/// What the stages of a piece of motion came to (mode_piece.h).
struct ModePiece {
  Growing<PaddedRows> slopes;  ///< of each: velocities, then accelerations
  std::array<ModeForces, dormand_prince::kStages> forces;
  double work = 0;  ///< [J] of what is counted in Body::given
};

/// How bodies turn as one (group_motion.h). Where they press on each other, and nothing outside on
/// them: friction between two axes, which are apart, is a couple; as angular momentum stays, it
/// comes back as a spin of them all.
struct GroupSpin {
  Vec3 centre = Vec3::Zero();                         ///< [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< [kg m^2]
  Vec3 rate = Vec3::Zero();  ///< [rad/s] of all as one; what slips is measured against it
};

using SlowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostSlowSlips, 1>;
using SlowMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostSlowSlips, kMostSlowSlips>;

/// Of the rows that slip slowly, at the start of a piece.
struct SlowSlips {
  Roomy<int> rows;
  Roomy<Vec3> start;  ///< their directions
  SlowMatrix turns;   ///< [s^2/m] inverse of how accelerations across slips answer to their turning
  SlowVector rate;    ///< [rad/s] at which the directions turn
  SlowVector lag;     ///< [rad] of slips behind where they would be if they stood still
};

constexpr int kEventsOfRow = 5;  ///< functions that mode_event_search.h looks at

struct Mode {
  Roomy<ModeRow> rows;     ///< of one body after the other, then those that two share
  Roomy<int> offset;       ///< of each body's coordinates
  int size = 0;            ///< of all coordinates
  double force_scale = 0;  ///< [N] below 1e-9 of which a force is none
  double longest = 0;      ///< [s] piece in which springs are followed
  // Scratch.
  Roomy<RowPlace> place;
  Roomy<int> first;  ///< of rows in the Schur complement; -1: none
  Roomy<ModeBlock> blocks;
  Roomy<int> spin_of;   ///< of each body; -1: held, or nothing presses on it
  Roomy<int> found_of;  ///< that the present forces were found with
  Roomy<GroupSpin> spins;
  SlowSlips slow;
  ModePoint start, end;  ///< of the present piece
  ModePiece piece;       ///< likewise
  ModePoint sample, stage, later;
  RowValues beside;  ///< positions near those of a point
  Roomy<double, kEventsOfRow * kRoomForRows> event, earlier;
};

}  // namespace ragdoll
