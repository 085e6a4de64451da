// What pressed on what in one step, as Workspace::keepContacts asks for it. Only what contacts
// give: pins and fields are the balance's rest (world/contacts.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

constexpr double kImpactSpeed = 0.1;  ///< [m/s] a touch that begins faster is an impact

/// What one contact gave over a part of a step. Several of a step may be of the same contact.
struct ContactImpulse {
  int ragdoll = 0;
  std::array<int, 2> particle{-1, -1};  ///< columns of the state: a sphere's, or a stick's ends
  int obstacle = -1;                    ///< of the model; -1: another body
  int other = -1;                       ///< ragdoll; -1: an obstacle, or the same ragdoll
  std::array<int, 2> other_particle{-1, -1};
  Vec3 point = Vec3::Zero();    ///< [m] of the first body's surface
  Vec3 normal = Vec3::Zero();   ///< unit, towards the first body
  Vec3 impulse = Vec3::Zero();  ///< [N s] on the first body
  double friction = 0;          ///< coefficient; 0 also of what has left since it pressed
  double depth = 0;             ///< [m] of the overlap
  double slip = 0;              ///< [m/s] along the surface, afterwards
  double approach = 0;          ///< [m/s] of an impact, before it
  double effective_mass = 0;    ///< [kg] that a push along the normal meets
  double peak = 0;  ///< [N] of a contact that gives way, also within a step; 0: not known
};

/// Its normal, turned towards its impulse as far as friction's cone needs: of an impulse that came
/// along several normals, or along that of an earlier pose.
Vec3 turnedIntoCone(const ContactImpulse& contact);

struct ContactLog {
  std::vector<ContactImpulse> impulses;
};

/// Before a step: velocities (3 x N) [m/s], and what pressed.
struct PressedBefore {
  Points v;
  std::vector<CachedImpulse> impulses;
};

/// What presses on the ragdolls whose `wanted` is set, as a state alone tells it: the contacts that
/// its cached impulses are of, over a step of that force; of a ragdoll without any (relaxation
/// keeps none) all that touch, without an impulse. before: what begins to press has its approach by
/// that.
void appendPressing(const Model& model, const State& state, const std::vector<std::uint8_t>& wanted,
                    std::vector<ContactImpulse>& out, const PressedBefore* before = nullptr);

}  // namespace ragdoll
