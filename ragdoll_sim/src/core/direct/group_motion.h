// Bodies of an island that press on each other, seen as one: how they drift and turn together.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/direct/island.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {

/// Each body by itself.
inline void startGroups(const Island& island, std::vector<int>& group_of) {
  group_of.resize(island.bodies.size());
  std::iota(group_of.begin(), group_of.end(), 0);
}

/// Makes one of two groups of bodies; group_of: a number for each body, the place of its first.
inline void joinGroups(int a, int b, std::vector<int>& group_of) {
  const int kept = std::min(group_of[a], group_of[b]), gone = std::max(group_of[a], group_of[b]);
  std::replace(group_of.begin(), group_of.end(), gone, kept);
}

/// The bodies of one group, until the next call.
inline const std::vector<Body*>& membersOf(const Island& island, const std::vector<int>& group_of,
                                           int group) {
  std::vector<Body*>& members = island.s.grouped;
  members.clear();
  for (std::size_t k = 0; k < group_of.size(); ++k)
    if (group_of[k] == group) members.push_back(island.bodies[k]);
  return members;
}

/// of(bodies) of each group.
template <class Of>
void forEachGroup(const Island& island, const std::vector<int>& group_of, const Of& of) {
  for (int k = 0; k < static_cast<int>(group_of.size()); ++k)
    if (group_of[k] == k) of(membersOf(island, group_of, k));
}

/// The motion of the bodies' common centre of mass, at x, v of each: of(body).
template <class OfX, class OfV>
RigidMotion driftOf(const std::vector<Body*>& bodies, const OfX& x, const OfV& v) {
  RigidMotion drift;
  double mass = 0;
  for (const Body* body : bodies) {
    const Eigen::VectorXd& own = body->rows->mass;
    drift.centre += x(*body).lazyProduct(own);
    drift.drift += v(*body).lazyProduct(own);
    mass += own.sum();
  }
  drift.centre /= mass;
  drift.drift /= mass;
  return drift;
}

template <class OfX, class OfV>
Rotation rotationOf(const std::vector<Body*>& bodies, const RigidMotion& drift, const OfX& x,
                    const OfV& v) {
  Rotation all;
  for (Body* body : bodies) {
    const Rotation own = rotationOf(massOf(*body), x(*body), v(*body), drift);
    all.angular += own.angular;
    all.inertia += own.inertia;
  }
  return all;
}

/// Of the bodies as one, at x, v of each.
template <class OfX, class OfV>
GroupSpin spinOfGroup(const std::vector<Body*>& bodies, const OfX& x, const OfV& v) {
  const RigidMotion drift = driftOf(bodies, x, v);
  const Rotation all = rotationOf(bodies, drift, x, v);
  return {drift.centre, all.inertia, exactSpinOf(all.inertia, all.angular)};
}

}  // namespace ragdoll
