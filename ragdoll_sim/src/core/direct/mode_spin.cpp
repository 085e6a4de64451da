#include "core/direct/mode_spin.h"

#include <algorithm>
#include <numeric>

#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

using Kind = ModeRow::Kind;

/// Whether the row is one of two sticks of bodies that spin.
bool spins(const Mode& mode, std::size_t i) {
  const ModeRow& row = mode.rows[i];
  return mode.first[i] >= 0 && row.kind == Kind::kPair && row.friction > 0 &&
         mode.spin_of[row.body] >= 0;
}

/// [m] From the second stick's place to the first's, times each tangent.
std::array<Vec3, 2> armsOf(const Mode& mode, std::size_t i) {
  const Contact& c = mode.place[i].contact;
  const std::array<Vec3, 3> directions = c.directions();
  const Vec3 between = (c.found + mode.place[i].gap) * c.normal;
  return {between.cross(directions[1]), between.cross(directions[2])};
}

/// That has an angular momentum: exact but for the guard of bodies on a line.
Vec3 turnBy(const ModeSpin& spin, const Vec3& angular) {
  const Vec3 once = spinOf(spin.inertia, angular);
  return once + spinOf(spin.inertia, angular - spin.inertia * once);
}

/// mode.spin_of <- one number for bodies that press on each other; -1: on nothing, or held.
void findGroups(const Island& island, SpinOf which, std::vector<int>& group) {
  const std::vector<ModeRow>& rows = island.s.mode.rows;
  const auto counts = [&](const ModeRow& row) {
    return row.isContact() && (which == SpinOf::kPressing ? row.presses : row.closed);
  };
  group.assign(island.bodies.size(), -1);
  for (const ModeRow& row : rows) {
    if (!counts(row) || row.kind != Kind::kPair) continue;
    for (const int body : {row.body, row.other})
      if (group[body] < 0) group[body] = body;
    const int kept = std::min(group[row.body], group[row.other]);
    const int gone = std::max(group[row.body], group[row.other]);
    std::replace(group.begin(), group.end(), gone, kept);
  }
  const auto hold = [&](int held) {
    if (held >= 0) std::replace(group.begin(), group.end(), held, -1);
  };
  for (const ModeRow& row : rows)
    if (counts(row) && row.kind != Kind::kPair) hold(group[row.body]);
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    if (!island.bodies[k]->pinned->pins.empty()) hold(group[k]);
}

/// Of the bodies of one group at x.
ModeSpin spinOfGroup(const Island& island, const double* x, int group) {
  const Mode& mode = island.s.mode;
  ModeSpin spin;
  RigidMotion motion;
  double mass = 0;
  const auto forEach = [&](const auto& part) {
    for (std::size_t k = 0; k < island.bodies.size(); ++k)
      if (mode.spin_of[k] == group)
        part(*island.bodies[k],
             Eigen::Map<const Points>(x + mode.offset[k], 3, island.bodies[k]->n));
  };
  forEach([&](Body& body, const Eigen::Map<const Points>& pose) {
    spin.centre += pose.lazyProduct(body.rows->mass);
    mass += body.rows->mass.sum();
  });
  motion.centre = spin.centre /= mass;
  forEach([&](Body& body, const Eigen::Map<const Points>& pose) {
    spin.inertia += rotationOf(massOf(body), pose, pose, motion).inertia;
  });
  return spin;
}

}  // namespace

void findSpins(Island& island, const double* x, SpinOf which) {
  Mode& mode = island.s.mode;
  findGroups(island, which, mode.spin_of);
  mode.spins.resize(island.bodies.size());
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    if (mode.spin_of[k] == static_cast<int>(k))
      mode.spins[k] = spinOfGroup(island, x, static_cast<int>(k));
}

void coupleFriction(const Island& island, ModeMatrix& A) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (!spins(mode, i)) continue;
    const int group = mode.spin_of[mode.rows[i].body];
    const std::array<Vec3, 2> own = armsOf(mode, i);
    for (std::size_t j = 0; j < mode.rows.size(); ++j) {
      if (!spins(mode, j) || mode.spin_of[mode.rows[j].body] != group) continue;
      const std::array<Vec3, 2> other = armsOf(mode, j);
      for (int k = 0; k < 2; ++k)
        for (int l = 0; l < 2; ++l)
          A(mode.first[i] + 1 + k, mode.first[j] + 1 + l) -=
              own[k].dot(turnBy(mode.spins[group], other[l]));
    }
  }
}

void addSpins(const Island& island, const ModeVector& p, const double* x, double* out) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (!spins(mode, i)) continue;
    const ModeSpin& spin = mode.spins[mode.spin_of[mode.rows[i].body]];
    const std::array<Vec3, 2> arms = armsOf(mode, i);
    const Vec3 couple = p[mode.first[i] + 1] * arms[0] + p[mode.first[i] + 2] * arms[1];
    if (couple.isZero(0)) continue;
    const Vec3 turn = -turnBy(spin, couple);
    for (std::size_t k = 0; k < island.bodies.size(); ++k) {
      if (mode.spin_of[k] != mode.spin_of[mode.rows[i].body]) continue;
      for (int n = mode.offset[k]; n < mode.offset[k] + 3 * island.bodies[k]->n; n += 3)
        Eigen::Map<Vec3>(out + n) += turn.cross(Eigen::Map<const Vec3>(x + n) - spin.centre);
    }
  }
}

}  // namespace ragdoll
