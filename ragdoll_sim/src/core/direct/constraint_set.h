// The contacts and limits that one motion of a body may meet, and which of them it is solved for.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"
#include "core/direct/spring.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// What a candidate is to the present motion.
enum class Role : std::uint8_t {
  kIfNear,  ///< a row while it is near
  kActive,  ///< a row in any case
  kComing,  ///< reached from afar: no row before its time is known
  kHit,     ///< reached at the motion's end: the impact that the motion was cut short for
  kBeyond,  ///< reached from afar after that end, or with it: as kIfNear, but nothing rubs on it
            ///< yet
};

/// Whether what is reached stops, but does not rub: a gap that rounding leaves is no force, which
/// friction could take for one that has held the limb all the way here.
inline bool isReached(Role role) { return role == Role::kHit || role == Role::kBeyond; }
/// Whether it is a row only while it is near.
inline bool isOnlyNear(Role role) { return role == Role::kIfNear || role == Role::kBeyond; }

/// Which overlaps have no way out and are ignored: they may stay as they are.
enum class OverlapPolicy : std::uint8_t {
  kResolve,     ///< none
  kIgnoreDeep,  ///< those deeper than kClose
  kIgnoreAll,
  kFilter,  ///< moving pins drag the body through the obstacles that it is in: no contacts there
};

/// Contacts that a motion may meet, of a body with obstacles and itself or between bodies.
struct ContactSet {
  Roomy<Contact> contacts;
  Roomy<Role> role;          ///< of each
  Roomy<int> row;            ///< the first of each, or -1
  Roomy<SpringRow> springs;  ///< of each
  Roomy<Contact> scratch;    ///< of who looks for others
};

/// Those of them that touch at the motion's end: what its velocities are solved for.
struct TouchingContacts {
  Roomy<Contact> contacts;
  Roomy<std::uint8_t> hit;  ///< of each: Role::kHit
  Roomy<double> warm;       ///< of all rows: the position stage's impulses over h

  void clear() {
    contacts.clear();
    hit.clear();
    warm.clear();
  }
};

/// A body's own.
struct ConstraintSet : ContactSet {
  Roomy<LimitRow> limits;
  Roomy<Role> limit_role;
  Roomy<int> limit_row;            ///< of each, or -1
  Roomy<SpringRow> limit_springs;  ///< of each
  int own_rows = 0;                ///< rows of contacts with other bodies come after
  double overlap = 0;              ///< [m] the deepest, at the motion's start
  Roomy<int> filtered;             ///< obstacles that the body is dragged through
};

/// A body's own; warm: of the contacts' rows, then of the limits'.
struct TouchingSet : TouchingContacts {
  Roomy<LimitRow> limits;
  Roomy<std::uint8_t> limit_hit;  ///< of each: Role::kHit

  void clear() {
    TouchingContacts::clear();
    limits.clear();
    limit_hit.clear();
  }
};

}  // namespace ragdoll
