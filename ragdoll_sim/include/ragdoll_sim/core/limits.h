// The joint limits of a state as one-sided rows C(X) >= 0 with exact gradients: what every solver
// projects on. Geometry: limit.h, and plane_limits.h: a `planes` joint has for the relaxation one
// row, where its child has left the regions, C = minus the angle back to its last allowed
// direction; for the direct methods a row for each border of a region.
#pragma once

#include <array>
#include <vector>

#include "ragdoll_sim/core/limit.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// C and its gradient at one state. Sum of gradients and sum of x cross gradient are zero.
struct LimitRow {
  static constexpr int kMaxParticles = 8;
  int ragdoll = 0;
  int limit = 0;  ///< of the skeleton: Skeleton::limits, or -1 - k of Skeleton::plane_limits
  int joint = 0;  ///< of the skeleton
  int count = 0;  ///< how many of the particles are used, each once; 0: gradient not evaluated
  std::array<int, kMaxParticles> particle;   ///< columns of the state
  std::array<Vec3, kMaxParticles> gradient;  ///< [rad/m]
  double value = 0;                          ///< [rad] C; < 0: violated by that angle
  Vec3 allowed = Vec3::Zero();               ///< planes: the direction to return to
  int border = 0;        ///< kWedge: -1, 1: of that border alone, as if it went on; 0: of the wedge
  bool returns = false;  ///< hard planes: was outside, on its way back there
  double opening = 0;    ///< [rad] violated by that much at the start, let be
  double compliance = 0;  ///< [rad/(N m)]; 0: hard
  double damping = 0;     ///< [N m s/rad], soft limits only
  double start = 0;       ///< [rad] soft limits: C at the step's start, <= 0
  double before = 0;      ///< [rad] direct methods: C at the substep's start

  /// The torque of a soft limit, a spring and a damper that only push, as a row of the position
  /// stage: C + offset + compliance p >= 0, p >= 0, one of the two zero (docs/equations.md#soft).
  struct Softness {
    double compliance = 0;  ///< [rad/(N m s^2)]
    double offset = 0;      ///< [rad]
  };
  /// p = h^2 torque, of the step's end: backward Euler.
  Softness eulerSoftness(double h) const;

  bool isSoft() const { return compliance > 0; }
  Compliance give() const { return {compliance, damping}; }
};

/// Rows of hinges and cones of all awake ragdolls with a value < margin [rad] at the positions x (3
/// x N), values only: evaluateLimit has the gradient.
void findLimits(const Model& model, const Points& x, const State& state, double margin,
                std::vector<LimitRow>& rows);

/// The row of one of the skeleton's limits, the regions of `planes` among them; not evaluated.
LimitRow limitRow(const Model& model, int ragdoll, int limit);

/// Appends a row for every planes joint of the awake ragdolls, to be evaluated.
void listPlanes(const Model& model, const State& state, std::vector<LimitRow>& rows);

/// Sets row.start from the positions at the step's start.
void startLimit(const Model& model, const Points& x, LimitRow& row);

/// Value and gradient at x. Of planes: 0, without particles, where they allow x.
void evaluateLimit(const Model& model, const Points& x, LimitRow& row);

/// [rad] The value alone at x.
double valueAt(const Model& model, const Points& x, const LimitRow& row);

/// Keeps the directions that the planes allow now in state.allowed: once at the end of a step.
void keepAllowed(const Model& model, State& state);

/// State::allowed at the start: where the children point, or the rest pose if that is forbidden.
Points startAllowed(const Model& model);

/// [rad] C alone of one limit; x: coordinates of the body's first particle.
double limitValue(const Limit& limit, const double* x);

/// [rad] by how much the worst limit of the ragdoll, of any type, is violated; >= 0.
double limitViolation(const Model& model, const Points& x, int ragdoll);

}  // namespace ragdoll
