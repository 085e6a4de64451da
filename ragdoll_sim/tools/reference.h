// What would have happened: the scene's motion at a step so small that halving it changes nothing
// that matters. Motion in contact is chaotic: after a second two answers that both are right lie
// metres apart. There the motion is cut into short windows that all methods start from the same
// states, those of one fine run, and each window's end is converged for itself.
#pragma once

#include <functional>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll::lab {

struct Window {
  State start;
  Points end;               ///< [m] where the window's motion ends
  double energy_end = 0;    ///< [J]
  double uncertainty = 0;   ///< [m] RMS between the two finest runs, or `disagreement`
  double disagreement = 0;  ///< [m] RMS between the end and that of another method, at the nearest
  double finest = 0;        ///< [s] the smallest step taken
  /// Starts that differ by 1e-10 m over the window end 1e-5 m or more apart: what then happens (a
  /// fall over an edge, or back from it) is not told by the start. It counts in no mean.
  bool forks = false;
  double fork_time = 0;  ///< [s] when the two have parted by a hundredth of that
};

struct Reference {
  std::vector<Window> windows;
  double window = 0;        ///< [s] length of each
  double uncertainty = 0;   ///< [m] mean of the windows that count
  double worst = 0;         ///< [m] largest of these
  double finest = 0;        ///< [s]
  double disagreement = 0;  ///< [m] mean of these
  int forks = 0;            ///< windows
  Method method = Method::kRk, other = Method::kShake;
};

/// The model with another solver; bodies stay awake, so that all methods have the same work.
Model withSolver(const Model& model, const SolverSpec& solver);

/// Has the scene anything to touch?
bool hasContact(const Model& model);

/// `horizon` is split into windows of length `window`, which must divide it. `report` hears of the
/// share that is done. `agreement` [m]: two runs, one at half the step of the other, are near
/// enough at that; 0: as near as double precision is good for. Throws Error where even the
/// reference leaves the finite numbers.
Reference makeReference(const Model& model, double horizon, double window,
                        const std::function<void(double)>& report, double agreement = 0);

/// Whether its error counts in means: all windows do if all fork.
bool counts(const Reference& reference, const Window& window);
/// How many do.
int countOf(const Reference& reference);

/// `steps` steps of `solver` from the window's start. Throws nothing; the result may not be finite.
State follow(const Model& model, const SolverSpec& solver, const Window& window, int steps);

/// Whole steps of length `step` in `window`, or 0 where they do not fit.
int stepsIn(double window, double step);

/// [m] RMS over the particles that users see.
double rmsDistance(const Model& model, const Points& a, const Points& b);

}  // namespace ragdoll::lab
