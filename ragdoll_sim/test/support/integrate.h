// Motions of a few coordinates apart from the product's code.
#pragma once

#include <Eigen/Core>

namespace ragdoll::test {

/// The state after `time`, by Runge and Kutta's classical formula: 20000 steps of fourth order.
template <class Rate, class State>
State integrate(const Rate& rate, State state, double time) {
  const int steps = 20000;
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const State k1 = rate(state), k2 = rate(state + 0.5 * h * k1), k3 = rate(state + 0.5 * h * k2),
                k4 = rate(state + h * k3);
    state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return state;
}

}  // namespace ragdoll::test
