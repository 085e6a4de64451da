// Damping of a body's inner motion: limbs stop swinging, the body as a whole is not held back.
//
// Velocities are drawn towards those of the rigid motion with the same momentum and angular
// momentum (about its pin, or the line through its pins), v <- v_rigid + (v - v_rigid) exp(-c h),
// as in [Mueller2007, sec. 3.5]. Linear and angular momentum of a free body do not change; sticks
// stay satisfied.
#pragma once

#include <vector>

#include "core/linear/stick_solver.h"
#include "core/mechanics/energy_gain.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// A motion that changes no distances.
struct RigidMotion {
  Vec3 centre = Vec3::Zero();  ///< [m] of mass; pinned: the first pin
  Vec3 drift = Vec3::Zero();   ///< [m/s] of the centre
  Vec3 spin = Vec3::Zero();    ///< [rad/s]

  Vec3 velocityAt(const Vec3& x) const { return drift + spin.cross(Vec3(x - centre)); }
};

/// [kg] Of one body.
struct MassMatrix {
  const StickRows& rows;   ///< whose M and mass are used
  EnergyScratch& scratch;  ///< of the kernels' products with it
};

/// The rigid motion with the momentum and angular momentum of velocities v: what the body would do
/// if its joints froze. Pinned: about the pin; by pins on a line: about that; by
/// others: none.
RigidMotion rigidMotion(const MassMatrix& mass, const std::vector<int>& pins,
                        const Eigen::Ref<const Points>& x, const Eigen::Ref<const Points>& v);

/// The motion of its centre of mass: without a spin.
RigidMotion driftOf(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
                    const Eigen::Ref<const Points>& v);

/// How bodies turn about the centre of a motion, beside that motion's drift.
struct Rotation {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< [kg m^2]
  Vec3 angular = Vec3::Zero();                        ///< [kg m^2/s]
};
Rotation rotationOf(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
                    const Eigen::Ref<const Points>& v, const RigidMotion& motion);
/// Its angular momentum alone.
Vec3 angularOf(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
               const Eigen::Ref<const Points>& v, const RigidMotion& motion);

/// [rad/s] The spin that has an angular momentum, but for what bodies on a line cannot have, about
/// it: of a momentum that is not theirs that is large.
Vec3 spinOf(const Eigen::Matrix3d& inertia, const Vec3& angular);
/// The same of any momentum, exact but for rounding: nothing about an axis that has no inertia.
Vec3 exactSpinOf(const Eigen::Matrix3d& inertia, const Vec3& angular);

/// x, v: 3 x n of one body; pins: its pinned particles; keep: exp(-c h) in (0, 1].
void dampInnerMotion(const MassMatrix& mass, const std::vector<int>& pins, double keep,
                     const Eigen::Ref<const Points>& x, Eigen::Ref<Points> v);

}  // namespace ragdoll
