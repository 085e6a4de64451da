// A scene that is run within a tolerance, and what it told meanwhile.
#pragma once

#include <cmath>

#include "support/ends.h"

namespace ragdoll::test {

struct ToleranceRun {
  Points x;
  StepReport report;
  int parts = 0;
};

/// From the scene's start, or from a state that another run has come to.
inline ToleranceRun runOf(Scene scene, Method method, double step, double tolerance, double seconds,
                          const State* start = nullptr, bool events = false) {
  scene.solver.method = method;
  if (events) scene.solver.events = true;
  scene.solver.step = step;
  scene.solver.tolerance = tolerance;
  World world(scene);
  if (start) {
    world.state = *start;
    world.state.step = 0;
    world.state.time = 0;
  }
  ToleranceRun run;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / step)); ++i) {
    const StepReport report = world.steps(1);
    run.report += report;
    run.parts += report.substeps;
  }
  run.x = world.state.x;
  return run;
}

/// [m] The largest of any particle.
inline double distance(const Points& a, const Points& b) { return largest(a - b); }

}  // namespace ragdoll::test
