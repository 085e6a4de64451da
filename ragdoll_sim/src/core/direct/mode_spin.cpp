#include "core/direct/mode_spin.h"

#include <algorithm>
#include <cmath>

#include "core/direct/driving.h"
#include "core/direct/group_motion.h"
#include "core/direct/mode_constants.h"

namespace ragdoll {
namespace {

using ModeKind = ModeRow::Kind;

/// Whether the row is one of two sticks of bodies that spin.
bool spins(const Mode& mode, const ModeRow& row) {
  return row.kind == ModeKind::kPair && row.friction > 0 && mode.spin_of[row.body] >= 0;
}
bool spins(const Mode& mode, std::size_t i) {
  return mode.first[i] >= 0 && spins(mode, mode.rows[i]);
}

/// [m] From the second stick's place to the first's.
Vec3 between(const RowPlace& place) {
  return (place.contact.found + place.gap) * place.contact.normal;
}

/// The same times each tangent.
std::array<Vec3, 2> armsOf(const Mode& mode, std::size_t i) {
  const std::array<Vec3, 3> directions = mode.place[i].contact.directions();
  const Vec3 arm = between(mode.place[i]);
  return {arm.cross(directions[1]), arm.cross(directions[2])};
}

/// [rad/s] That has an angular momentum.
Vec3 turnBy(const GroupSpin& spin, const Vec3& angular) {
  return exactSpinOf(spin.inertia, angular);
}

/// mode.spin_of <- one number for bodies that press on each other; -1: on nothing, or held.
void findGroups(const Island& island, SpinOf which, std::vector<int>& group) {
  const std::vector<ModeRow>& rows = island.s.mode.rows;
  const auto counts = [&](const ModeRow& row) {
    return row.isContact() && (which == SpinOf::kClosed ? row.closed : row.presses);
  };
  group.assign(island.bodies.size(), -1);
  if (which == SpinOf::kEach) startGroups(island, group);
  for (const ModeRow& row : rows) {
    if (!counts(row) || row.kind != ModeKind::kPair) continue;
    for (const int body : {row.body, row.other})
      if (group[body] < 0) group[body] = body;
    joinGroups(row.body, row.other, group);
  }
  const auto hold = [&](int held) {
    if (held >= 0) std::replace(group.begin(), group.end(), held, -1);
  };
  for (const ModeRow& row : rows)
    if (counts(row) && row.kind != ModeKind::kPair) hold(group[row.body]);
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    if (!island.bodies[k]->pinned->pins.empty()) hold(group[k]);
}

/// Of the bodies of one group at x, as they move by v.
GroupSpin spinOfGroup(const Island& island, const double* x, const double* v, int group) {
  const Mode& mode = island.s.mode;
  const auto of = [&](const double* values) {
    return [&, values](const Body& body) {
      const int offset = mode.offset[island.placeOf(body.index)];
      return Eigen::Map<const Points>(values + offset, 3, body.n);
    };
  };
  return spinOfGroup(membersOf(island, mode.spin_of, group), of(x), of(v));
}

/// Adds a spin of a group's bodies at x to motions `out`.
void addSpin(const Island& island, int group, const Vec3& spin, const Vec3& centre, const double* x,
             double* out) {
  const Mode& mode = island.s.mode;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    if (mode.spin_of[k] != group) continue;
    for (int n = mode.offset[k]; n < mode.offset[k] + 3 * island.bodies[k]->n; n += 3)
      Eigen::Map<Vec3>(out + n) += spin.cross(Eigen::Map<const Vec3>(x + n) - centre);
  }
}

/// [rad/s^2] How the spin changes as its bodies move by point.v and accelerate by point.a: by what
/// turns them, and by their inertia, which is of second order in their motion.
Vec3 changeOfSpin(const Island& island, const ModePoint& point, int group) {
  const Mode& mode = island.s.mode;
  const double speed = point.v.cwiseAbs().maxCoeff();
  const Vec3 turned =
      mode.spins[group].inertia * spinOfGroup(island, point.x.data(), point.a.data(), group).rate;
  if (!(speed > 0)) return turnBy(mode.spins[group], turned);
  const double e = kDifference / speed;
  const auto inertiaAfter = [&](double time) -> Eigen::Matrix3d {
    RowValues& x = island.s.mode.beside;
    x = point.x + time * point.v;
    return spinOfGroup(island, x.data(), point.v.data(), group).inertia;
  };
  const Eigen::Matrix3d change = (inertiaAfter(e) - inertiaAfter(-e)) / (2 * e);
  return turnBy(mode.spins[group], turned - change * mode.spins[group].rate);
}

}  // namespace

void findSpins(Island& island, const double* x, const double* v, SpinOf which) {
  Mode& mode = island.s.mode;
  findGroups(island, which, mode.spin_of);
  mode.spins.resize(island.bodies.size());
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    if (mode.spin_of[k] == static_cast<int>(k))
      mode.spins[k] = spinOfGroup(island, x, v, static_cast<int>(k));
}

Vec3 spinMotion(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
                const double* v) {
  if (!spins(island.s.mode, row)) return Vec3::Zero();
  const int group = island.s.mode.spin_of[row.body];
  return spinOfGroup(island, x, v, group).rate.cross(between(place));
}

void takeSpinRates(const Island& island, ModeVector& rates) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (!spins(mode, i)) continue;
    const std::array<Vec3, 2> arms = armsOf(mode, i);
    for (int k = 0; k < 2; ++k)
      rates[mode.first[i] + 1 + k] -= arms[k].dot(mode.spins[mode.spin_of[mode.rows[i].body]].rate);
  }
}

void takeSpinAccelerations(const Island& island, const ModePoint& point,
                           ModeVector& accelerations) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (!spins(mode, i)) continue;
    const int group = mode.spin_of[mode.rows[i].body];
    const Vec3 change = changeOfSpin(island, point, group);
    const Vec3 lost =
        change.cross(between(mode.place[i])) + mode.spins[group].rate.cross(mode.place[i].moves);
    const std::array<Vec3, 3> directions = mode.place[i].contact.directions();
    for (int k = 1; k < 3; ++k) accelerations[mode.first[i] + k] -= directions[k].dot(lost);
  }
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

void keepSpins(const Island& island, ModePoint& point) {
  const Mode& mode = island.s.mode;
  for (int group = 0; group < static_cast<int>(island.bodies.size()); ++group) {
    if (mode.spin_of[group] != group) continue;
    const GroupSpin& before = mode.spins[group];
    const GroupSpin now = spinOfGroup(island, point.x.data(), point.v.data(), group);
    const Vec3 lost = before.inertia * before.rate - now.inertia * now.rate;
    if (!lost.isZero(0))
      addSpin(island, group, turnBy(now, lost), now.centre, point.x.data(), point.v.data());
  }
}

void keepSpins(Island& island, const ModePoint& start, double h, ModePoint& end) {
  findSpins(island, start.x.data(), start.v.data(), SpinOf::kEach);
  std::vector<int>& spin_of = island.s.mode.spin_of;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const Body& body = *island.bodies[k];
    const int group = spin_of[k];
    if (group < 0) continue;
    if (isPoked(body)) std::replace(spin_of.begin(), spin_of.end(), group, -1);
    if (group == static_cast<int>(k) && body.damps_within)
      island.s.mode.spins[k].rate *= std::exp(-island.context.model.solver.damping * h);
  }
  keepSpins(island, end);
}

void addSpins(const Island& island, const ModeVector& p, const double* x, double* out) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (!spins(mode, i)) continue;
    const GroupSpin& spin = mode.spins[mode.spin_of[mode.rows[i].body]];
    const std::array<Vec3, 2> arms = armsOf(mode, i);
    const Vec3 couple = p[mode.first[i] + 1] * arms[0] + p[mode.first[i] + 2] * arms[1];
    if (couple.isZero(0)) continue;
    addSpin(island, mode.spin_of[mode.rows[i].body], -turnBy(spin, couple), spin.centre, x, out);
  }
}

}  // namespace ragdoll
