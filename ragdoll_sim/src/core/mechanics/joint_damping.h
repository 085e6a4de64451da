// Damping of a body's inner motion: limbs stop swinging, the body as a whole is not held back.
//
// Velocities are drawn towards those of the rigid motion with the same momentum and angular
// momentum (about its pin, if it has one), v <- v_rigid + (v - v_rigid) exp(-c h), as in
// [Mueller2007, sec. 3.5]. Linear and angular momentum of a free body do not change; sticks stay
// satisfied.
#pragma once

#include <vector>

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
  const Eigen::MatrixXd& M;     ///< n x n
  const Eigen::VectorXd& sums;  ///< n, of its rows
};

/// Inertia [kg m^2] and angular momentum [kg m^2/s] about a point.
struct Turning {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vec3 angular = Vec3::Zero();

  /// Of a body about the motion's centre, as seen from its drift.
  void add(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
           const Eigen::Ref<const Points>& v, const RigidMotion& motion);
  /// [rad/s] Of what turns as one.
  Vec3 spin() const;
};

/// The rigid motion with the momentum and angular momentum of velocities v: what the body would do
/// if its joints froze. Pinned: about the pin; by two pins: none.
RigidMotion rigidMotion(const MassMatrix& mass, const std::vector<int>& pins,
                        const Eigen::Ref<const Points>& x, const Eigen::Ref<const Points>& v);

/// x, v: 3 x n of one body; pins: its pinned particles; keep: exp(-c h) in (0, 1].
void dampInnerMotion(const MassMatrix& mass, const std::vector<int>& pins, double keep,
                     const Eigen::Ref<const Points>& x, Eigen::Ref<Points> v);

}  // namespace ragdoll
