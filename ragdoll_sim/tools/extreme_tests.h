// The stability matrix's tests: scenes at an extreme, and the laws that each must keep.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll::lab {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// What a run must keep. All numbers must stay finite besides.
struct Laws {
  double energy_rise = 1e-2;    ///< of the energy in play: largest above the least before plus
                                ///< work since; by relaxation above the start plus work
  double stick_error = 1e-3;    ///< relative, from `joined` on
  double joined = 1;            ///< [s]
  double settled = 0;           ///< [s] from which on nothing is driven; only then energy is watched
  double depth = 5e-3;          ///< [m] in any obstacle, from `joined` on (0: from the start)
  bool squeezed = false;        ///< deeper where the report says that there was no way out
  double lowest = -kUnbounded;  ///< [m] z of any particle, ever
  double speed = kUnbounded;    ///< [m/s] of any particle, ever
  double drift = kUnbounded;    ///< [m] of the centre of mass after half of the time
  bool rest = false;            ///< nothing moves at the end; with joint_damping 2/s, without
                                ///< which a limb that hangs free swings on as it should
};

struct Extreme {
  std::string group, name;  ///< "step", "0.1 s, falls"
  Scene scene;              ///< its solver is the method's, but for what follows
  double seconds = 10;      ///< [s] simulated
  double step = 0;          ///< [s]; 0: the method's own
  int sweeps = 0;           ///< 0: the method's own; else only jakobsen is tested
  bool sleep = true;
  bool only_default = false;  ///< too long for the other methods
  Laws laws;
  /// Obstacles that move: their poses at `time` [s]; empty: none does.
  std::function<void(double time, std::vector<Pose>& obstacles)> drive;
  /// Pins that move, likewise.
  std::function<void(double time, std::vector<Vec3>& pins)> drive_pins;
};

/// Every test but the random scenes. quick: a part of them that takes seconds.
std::vector<Extreme> extremeTests(bool quick);

}  // namespace ragdoll::lab
