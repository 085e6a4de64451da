// What passes between the step and the packs of bodies: plain numbers, one body (lane) at a time,
// so that units of different instruction sets share no types. Private to the fast method.
#pragma once

#include <cstddef>

#include "core/fast/body.h"
#include "core/fast/constants.h"

namespace ragdoll::fast {

/// An obstacle's tangent plane at a particle or stick, at the step's end; world.
struct LaneContact {
  int feature = 0;
  int slot = 0;  ///< which of the feature's contacts
  int obstacle = 0;
  double weight = 0;  ///< of Feature::b; 0 of a particle
  double radius = 0;  ///< [m] of the body there
  double normal[3] = {0, 0, 1};
  double offset = 0;  ///< [m] of the obstacle's surface along the normal, from the body's root
  double friction = 0, restitution = 0;
  double motion[3] = {0, 0, 0};   ///< [m] of the surface there during the step
  double impulse[3] = {0, 0, 0};  ///< [N] in the last step
};

struct LaneImpulse {
  int feature = 0, obstacle = 0;
  double impulse[3] = {0, 0, 0};  ///< [N]
  bool grips = false;             ///< friction, which is less than it could be
};

/// A particle or stick near a solid that a pack leaves to contact/detect.h.
struct LeftOver {
  int feature = 0, solid = 0;
};

/// One body of a pack.
struct Lane {
  const double* x = nullptr;  ///< [m] 3 n
  const double* v = nullptr;  ///< [m/s] likewise
  double* x1 = nullptr;       ///< [m] 3 n, out; may be x
  double* v1 = nullptr;       ///< [m/s] likewise
  double* tried_x = nullptr;  ///< in place of x1 where the body is deep or on trial
  double* tried_v = nullptr;
  double* predicted = nullptr;      ///< [m] 3 n, out: where the free motion leads; may be null
  const double* force = nullptr;    ///< [N] 3 n of pokes; null: none
  double pin[3] = {0, 0, 0};        ///< [m] motion of the pin
  double h = 0;                     ///< [s] of its step, or part of one
  double keep = 1;                  ///< of velocities, damping
  double keep_inner = 1;            ///< of velocities against the rigid motion, joint damping
  StepBounds bounds = kOfPart;      ///< what leaves more is not for a pack
  bool driven = false;              ///< pins or obstacles move: they may give it energy
  LaneContact* contacts = nullptr;  ///< with solids; out of `predict`, in of `finish`
  int contact_count = 0, contact_room = 0;
  LeftOver* hard = nullptr;  ///< out of `predict`
  int hard_count = 0, hard_room = 0;
  double* limit_impulse = nullptr;  ///< [N m] per limit, in and out
  bool limits_pressed = false;      ///< in: one of them is not 0
  LaneImpulse* impulses = nullptr;  ///< in: of the last step; out: room for impulse_room
  int impulse_count = 0;
  bool good = true;       ///< out: x and v are there
  double hit = 1;         ///< out: share of the step after which it is hit too fast for one; 1: not
  bool pressed = false;   ///< out: an obstacle pressed
  bool limited = false;   ///< out: its energy was limited
  bool deep = false;      ///< out: something may be deep in a solid
  bool on_trial = false;  ///< in: whether it may stay so is not for the pack to say

  bool tried() const { return deep || on_trial; }
};

/// A plane that stands still.
struct StillPlane {
  int obstacle = 0;
  double normal[3] = {0, 0, 1};
  double offset = 0;  ///< [m]
  double friction = 0, restitution = 0;
};

/// A box, sphere or capsule: what is within a radius of a core, which is a box (half: its halves),
/// a point or a line (half: 0 square to it).
struct Solid {
  int obstacle = 0;
  bool is_box = false, moves = false;
  double half[3] = {0, 0, 0}, radius = 0;               ///< [m]
  double place0[3] = {0, 0, 0}, place1[3] = {0, 0, 0};  ///< [m] at the step's start and end
  double axes0[9], axes1[9];                            ///< likewise, one after the other
  double extent[3] = {0, 0, 0};  ///< [m] half of its bounds over the step, about its mean place
  double friction = 0, restitution = 0;
};

struct PackStep {
  double h = 0;  ///< [s] of bodies that take it together; else each lane has its own
  double gravity[3] = {0, 0, 0};
  const StillPlane* planes = nullptr;
  int plane_count = 0;
  const Solid* solids = nullptr;
  int solid_count = 0;
  StepBounds bounds = kOfPart;  ///< the least of the lanes'
  bool whole = true;  ///< `predicted` of all lanes is wanted; else of those with what is left over
};

/// Where bodies that take a step together touch each other, or one touches itself.
struct PairContact {
  int body[2] = {-1, -1};  ///< of those that take the step; -1: one that does not move
  int feature[2] = {0, 0};
  double weight[2] = {0, 0};     ///< of Feature::b
  double normal[3] = {0, 0, 1};  ///< out of the second
  double gap = 0;                ///< [m] at the step's start
  double reach = 0;              ///< [m] between the axes, along the normal
  double friction = 0;
  double impulse[3] = {0, 0, 0};  ///< [N] on the first; in: in the last step; out
  bool holds = false;             ///< out: friction, which is less than it could be
};

/// A body that takes the step with others, in a pack of its own.
struct Partner {
  const FastBody* body = nullptr;
  Lane* lane = nullptr;
  void* memory = nullptr;
};

struct Partners {
  Partner* bodies = nullptr;
  int count = 0;
  PairContact* contacts = nullptr;
  int contact_count = 0;
  void* memory = nullptr;  ///< PackMethod::partners_memory of it, aligned to 64 bytes
};

/// For one instruction set, number and width. `memory` is aligned to 64 bytes.
struct PackMethod {
  int lanes = 1;
  std::size_t (*memory)(const FastBody& body, int planes);  ///< [bytes]
  /// Free motion: lanes' `predicted`, contacts with solids.
  void (*predict)(const FastBody& body, const PackStep& step, Lane* lanes, void* memory);
  /// The rest of that step: x, v, impulses.
  void (*finish)(const FastBody& body, const PackStep& step, Lane* lanes, void* memory);
  // As `finish`, of bodies that touch each other: of packs of one body; else null.
  std::size_t (*partners_memory)(int bodies, int contacts) = nullptr;  ///< [bytes]
  void (*finish_together)(const PackStep& step, const Partners& partners) = nullptr;
};

/// Most impulses that a lane may have.
inline int impulseRoom(const FastBody& body, int planes) {
  return static_cast<int>(body.features.size()) * (kSlots + planes);
}

}  // namespace ragdoll::fast
