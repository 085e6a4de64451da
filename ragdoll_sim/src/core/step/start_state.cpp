#include "ragdoll_sim/core/start_state.h"

#include <cstdio>

#include "core/direct/start_velocities.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {
namespace {

constexpr double kToldEnergy = 1e-6;  ///< [J] less is rounding

}  // namespace

State startState(const Model& model, double* taken) {
  State state;
  state.x = model.start_position;
  state.v = model.start_velocity;
  for (const Obstacle& o : model.obstacles) state.obstacles.push_back(o.pose);
  state.asleep.assign(model.ragdolls.size(), 0);
  state.quiet.assign(model.ragdolls.size(), 0.0);
  state.allowed = startAllowed(model);
  const double energy = settlePins(model, state);
  if (taken) *taken = energy;
  return state;
}

double settlePins(const Model& model, State& state) {
  const double taken = makeConsistent(model, state);
  for (const Pin& p : model.pins) state.v.col(p.particle).setZero();
  return taken;
}

std::string takenText(double taken) {
  if (!(taken > kToldEnergy)) return {};
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", taken);
  return "velocities contradicted pins, sticks, limits or contacts; what these leave free has " +
         std::string(text) + " J less";
}

}  // namespace ragdoll
