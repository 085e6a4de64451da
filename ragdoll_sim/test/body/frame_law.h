// The law of continuous frames, for motions made by hand and by the simulator.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll::test {

inline double angle(const Quat& a, const Quat& b) { return angleOf(a.conjugate() * b); }

/// Expects that no part of the ragdoll has turned by more between the last two updates than the
/// motion of the particles that it is made of explains, that no quaternion has changed its sign,
/// and that bones point where their particles are. Returns the largest step [rad].
inline double expectContinuous(const FrameTracker& tracker, int ragdoll) {
  const FrameTree& tree = tracker.tree(ragdoll);
  const Quat* q0 = &tracker.previous().parts[tracker.firstPart(ragdoll)];
  const Quat* q1 = &tracker.now().parts[tracker.firstPart(ragdoll)];
  const auto direction = [&](const Posture& p, int part) {
    const auto& ends = tree.parts[part].particles;
    const int first = tracker.firstParticle(ragdoll);
    return Vec3((p.x.col(first + ends[1]) - p.x.col(first + ends[0])).normalized());
  };
  const double when = tracker.now().time;
  double largest = 0;
  for (int p = 0; p < static_cast<int>(tree.parts.size()); ++p) {
    const Part& part = tree.parts[p];
    const double step = angle(q0[p], q1[p]);
    largest = std::max(largest, step);
    EXPECT_GT(q0[p].dot(q1[p]), 0) << part.name << " changed its sign at " << when;
    if (part.group || part.parent < 0) continue;
    const Vec3 before = direction(tracker.previous(), p), now = direction(tracker.now(), p);
    EXPECT_LT(angleBetween(q1[p] * part.rest_direction, now), 1e-9) << part.name << " at " << when;
    const double parent = angle(q0[part.parent], q1[part.parent]);
    double motion =
        angleBetween(q0[part.parent].conjugate() * before, q1[part.parent].conjugate() * now);
    if (part.bends >= 0) {
      // As seen from this bone without its pull: at most what the world sees, and this bone's
      // motion.
      motion += angleBetween(direction(tracker.previous(), part.bends),
                             direction(tracker.now(), part.bends)) +
                parent + motion;
    }
    EXPECT_LT(step, parent + (1 + kPullGain) * motion + 1e-9) << part.name << " at " << when;
  }
  return largest;
}

}  // namespace ragdoll::test
