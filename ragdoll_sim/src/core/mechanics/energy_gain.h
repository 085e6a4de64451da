// Energy of one body's motion, by the kernels' products with its mass matrix. Private to the core.
#pragma once

#include "core/linear/stick_solver.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct EnergyScratch {
  Points change;
  PaddedRows pushed;
};

/// Gives what is in it its size.
inline void makeRoom(const StickRows& rows, EnergyScratch& s) {
  s.change.resize(3, rows.n);
  s.pushed.resize(3, rows.columns);
}

/// [kg m/s] V M (3 x n) for V = s.change.
inline auto momentum(const StickRows& rows, EnergyScratch& s) {
  s.pushed.resize(3, rows.columns);
  kernels::multiplyPoints(s.change.data(), rows.M.data(), rows.n, rows.columns, s.pushed.data());
  return s.pushed.leftCols(rows.n);
}

/// [J] of velocities v (3 x n).
template <class V>
double kineticEnergy(const StickRows& rows, const V& v, EnergyScratch& s) {
  s.change = v;
  return 0.5 * momentum(rows, s).cwiseProduct(v).sum();
}

/// [J] of kinetic energy from v0 to v1 less gravity's work along `moved` (3 x n each). The
/// difference of the two energies as (v1 - v0) M (v1 + v0) / 2, which rounds less than either.
template <class V0, class V1>
double energyGain(const StickRows& rows, const V0& v0, const V1& v1, const Points& moved,
                  const Vec3& gravity, EnergyScratch& s) {
  s.change = v1 - v0;
  return 0.5 * momentum(rows, s).cwiseProduct(v0 + v1).sum() -
         gravity.dot(Vec3(moved.lazyProduct(rows.mass)));
}

}  // namespace ragdoll
