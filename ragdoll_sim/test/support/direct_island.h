// The bodies of a scene as an island of the direct methods at the beginning of a step, so that
// single stages can be called.
#pragma once

#include <numeric>
#include <vector>

#include "core/direct/begin_step.h"
#include "core/direct/direct_step.h"
#include "support/worlds.h"

namespace ragdoll::test {

struct DirectIsland {
  World world;
  DirectWorkspace ws;
  Supports supports;
  StepContext context;
  Island island;
  StepReport report;
  const double h;  ///< [s] the whole step

  explicit DirectIsland(const Scene& scene)
      : world(scene),
        context{world.model, world.inputs, world.model.solver.step,
                nullptr,     true,         false,
                world.state, ws,           supports},
        island(context, scratchOf(context).island),
        h(context.h) {
    supports.pressed.assign(world.model.ragdolls.size(), 0);
    supports.gripped = supports.pressed;
    prepareDirect(context);
    std::vector<int> all(world.model.ragdolls.size());
    std::iota(all.begin(), all.end(), 0);
    bindIsland(island, all, {});
    beginStep(island, report);
    for (Body* body : island.bodies) body->memory->response.setStart(body->xData());
  }

  Body& body() { return *island.bodies[0]; }
};

/// Three particles of 1 kg along x, 1 m apart, that two sticks join.
inline SkeletonSpec chainOfThree() {
  SkeletonSpec s = oneStick();
  s.particles.push_back(particle("c", 2 * Vec3::UnitX()));
  s.sticks.push_back(stick("b", "c"));
  s.segments.push_back(bone("bc", "b", "c"));
  return s;
}

}  // namespace ragdoll::test
