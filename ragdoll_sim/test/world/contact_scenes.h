// Scenes and sums that the tests of contacts share.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/findings.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/world/contacts.h"
#include "support/gravity.h"

namespace ragdoll {

using test::kG;

inline double massOf(const Model& model, int ragdoll) {
  return pointMasses(model.skeletonOf(model.ragdolls[ragdoll])).sum();
}

/// [N s]
inline Vec3 momentumOf(const Model& model, int ragdoll, const State& state) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  return state.v.middleCols(r.first, s.size()) * s.M.rowwise().sum();
}

/// What the contacts of a report give to a body.
inline Vec3 impulseOn(int ragdoll, const std::vector<Touch>& touches) {
  Vec3 sum = Vec3::Zero();
  for (const Touch& touch : touches) {
    const ContactImpulse& c = touch.contact;
    if (c.ragdoll == ragdoll && (c.obstacle >= 0 || c.other >= 0)) sum += c.impulse;
    if (c.other == ragdoll) sum -= c.impulse;
  }
  return sum;
}

/// A ball of `mass` for each name, in a row above each other.
inline std::string balls(const std::string& heights, double mass, const std::string& rest) {
  std::string text = "ragdolls:\n", height;
  int i = 0;
  for (const char c : heights + " ") {
    if (c != ' ') {
      height += c;
      continue;
    }
    text += "  - {name: ball_" + std::to_string(i++) +
            ", model: {particles: {p: {position: [0, 0, 0], mass: " + std::to_string(mass) +
            ", radius: 0.1}}}, position: [0, 0, " + height + "]}\n";
    height.clear();
  }
  return text + rest;
}

}  // namespace ragdoll
