// runSteps of common.h.
#pragma once

#include <chrono>

#include "common.h"

namespace ragdoll::python {

constexpr double kLookEvery = 0.05;  ///< [s] for Ctrl-C

template <class Advance>
void runSteps(std::uint64_t steps, Advance advance) {
  using Clock = std::chrono::steady_clock;
  std::uint64_t chunk = 1;
  while (steps > 0) {
    const std::uint64_t now = chunk < steps ? chunk : steps;
    {
      const py::gil_scoped_release release;
      const Clock::time_point begin = Clock::now();
      advance(now);
      const std::chrono::duration<double> took = Clock::now() - begin;
      if (took.count() < kLookEvery / 2) chunk *= 2;
      if (took.count() > kLookEvery && chunk > 1) chunk /= 2;
    }
    steps -= now;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

}  // namespace ragdoll::python
