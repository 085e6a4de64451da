#include "core/direct/mode_slow_slips.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/direct/mode_constants.h"
#include "core/direct/mode_rows.h"

namespace ragdoll {
namespace {

ModeBlock& blockOf(Mode& mode, int row) {
  return *std::find_if(mode.blocks.begin(), mode.blocks.end(),
                       [&](const ModeBlock& block) { return block.row == mode.first[row]; });
}

/// [m/s^2] Of each slow slip across its direction, by forces p.
SlowVector accelerationsAcross(Mode& mode, const ModeSystem& system, const ModeVector& p) {
  const ModeVector w = system.b + system.A * p;
  SlowVector across(mode.slow.rows.size());
  for (Eigen::Index j = 0; j < across.size(); ++j) {
    const ModeBlock& block = blockOf(mode, mode.slow.rows[j]);
    across[j] = block.across().dot(w.segment<2>(block.row + 1));
  }
  return across;
}

void turnBy(Mode& mode, const SlowVector& angles) {
  for (Eigen::Index j = 0; j < angles.size(); ++j) {
    Eigen::Vector2d& slip = blockOf(mode, mode.slow.rows[j]).slip;
    slip = (Eigen::Rotation2Dd(std::clamp(angles[j], -kMostTurn, kMostTurn)) * slip).normalized();
  }
}

/// Turns the slips until nothing accelerates across them.
bool alignSlowSlips(Mode& mode, ModeSystem& system) {
  for (int k = 0; k < kAlignments; ++k) {
    if (!solveEqualities(system.A, system.b, mode.blocks, system.p)) return false;
    const SlowVector turn = -(mode.slow.turns * accelerationsAcross(mode, system, system.p));
    if (!turn.allFinite()) return false;
    if (turn.cwiseAbs().maxCoeff() < kSlowAligned) return true;
    turnBy(mode, turn);
  }
  return false;
}

/// The rows' directions in space <- those of the blocks.
void keepDirections(Island& island) {
  Mode& mode = island.s.mode;
  for (const int row : mode.slow.rows)
    mode.rows[row].along = alongSurface(island, mode.first[row], blockOf(mode, row).slip);
}

/// mode.slow.rate, by what accelerates across the same directions a moment later.
bool findRates(Island& island, const ModePoint& point, const ModeVector& p) {
  Mode& mode = island.s.mode;
  ModePoint& later = mode.later;
  later = point;
  pushInMode(island, p, point.x.data(), later.a.data());
  later.x += kSlowMoment * point.v;
  later.v += kSlowMoment * later.a;
  ModeSystem system;
  if (!buildAccelerations(island, later, system) ||
      !solveEqualities(system.A, system.b, mode.blocks, system.p))
    return false;
  mode.slow.rate = -(mode.slow.turns * accelerationsAcross(mode, system, system.p)) / kSlowMoment;
  return true;
}

/// [m/s] Of each.
SlowVector speedsOf(Island& island, const ModePoint& point) {
  Mode& mode = island.s.mode;
  SlowVector speed(mode.slow.rows.size());
  for (Eigen::Index j = 0; j < speed.size(); ++j) {
    const ModeRow& row = mode.rows[mode.slow.rows[j]];
    const double *x = point.x.data(), *v = point.v.data();
    speed[j] = slipOf(island, row, placeOf(island, row, x, v, false), x, v).dot(row.along);
  }
  return speed;
}

}  // namespace

void clearSlowSlips(Mode& mode) {
  for (const int row : mode.slow.rows) mode.rows[row].slow = false;
  mode.slow.rows.clear();
}

bool leaveSlowSlips(Island& island) {
  Mode& mode = island.s.mode;
  if (mode.slow.rows.empty()) return false;
  clearSlowSlips(mode);
  return accelerateInMode(island, mode.start);
}

bool solveSlowSlips(Island& island, ModePoint& point, ModeSystem& system) {
  Mode& mode = island.s.mode;
  if (!alignSlowSlips(mode, system)) return false;
  keepDirections(island);
  const SlowVector speeds = speedsOf(island, point);
  const bool known = findRates(island, point, system.p);
  const bool found = buildAccelerations(island, point, system) && known;
  if (found) {
    mode.slow.lag = mode.slow.turns * speeds.cwiseProduct(mode.slow.rate);
    turnBy(mode, mode.slow.lag);
  }
  for (std::size_t j = 0; j < mode.slow.rows.size(); ++j)
    mode.rows[mode.slow.rows[j]].along = mode.slow.start[j];
  return found && solveEqualities(system.A, system.b, mode.blocks, system.p);
}

namespace {

/// [s] In which friction turns a slip of that speed at the start; `row` answers as it last did.
double turningTime(const Island& island, std::size_t row, double speed) {
  const Mode& mode = island.s.mode;
  const int t = mode.first[row] + 1;
  const JointSchur& joint = island.s.joint;
  const double answer = std::min(joint.entry(t, t), joint.entry(t + 1, t + 1));
  return speed / (mode.rows[row].friction * mode.start.forces.normal[row] * answer);
}

Vec3 slipAtStart(Island& island, const ModeRow& row) {
  const ModePoint& start = island.s.mode.start;
  const double *x = start.x.data(), *v = start.v.data();
  return slipOf(island, row, placeOf(island, row, x, v, false), x, v);
}

/// Rows whose slips friction turns at once, as a piece of h sees it.
void listSlowSlips(Island& island, double h) {
  Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size() && mode.slow.rows.size() < kMostSlowSlips; ++i) {
    ModeRow& row = mode.rows[i];
    if (!row.presses || !row.isContact() || row.sticks || row.impending || row.isSoft() ||
        !(row.friction > 0) || !(mode.start.forces.normal[i] > 0))
      continue;
    const Vec3 slip = slipAtStart(island, row);
    if (!(turningTime(island, i, slip.norm()) < kTurnsAtOnce * h)) continue;
    row.slow = true;
    row.along = slip.norm() > kStill ? Vec3(slip.normalized()) : row.slip;
    mode.slow.rows.push_back(static_cast<int>(i));
  }
}

/// mode.slow.turns.
bool findTurns(Mode& mode, const ModeSystem& system) {
  const Eigen::Index m = static_cast<Eigen::Index>(mode.slow.rows.size());
  const SlowVector before = accelerationsAcross(mode, system, system.p);
  SlowMatrix J(m, m);
  ModeVector p;
  for (Eigen::Index j = 0; j < m; ++j) {
    Eigen::Vector2d& slip = blockOf(mode, mode.slow.rows[j]).slip;
    const Eigen::Vector2d kept = slip;
    slip = Eigen::Rotation2Dd(kSlipTurn) * slip;
    if (!solveEqualities(system.A, system.b, mode.blocks, p)) return false;
    J.col(j) = (accelerationsAcross(mode, system, p) - before) / kSlipTurn;
    slip = kept;
  }
  mode.slow.turns = J.fullPivLu().inverse();
  return mode.slow.turns.allFinite();
}

/// [rad] That a direction may be behind.
double mostLag(double allowed) { return std::max(kSmallLag, std::sqrt(allowed)); }

/// Keeps those for which `is` is true of their place in the list; whether that is all.
template <class Is>
bool keepSlow(Mode& mode, const Is& is) {
  std::size_t count = 0;
  const std::size_t all = mode.slow.rows.size();
  for (std::size_t j = 0; j < all; ++j) {
    ModeRow& row = mode.rows[mode.slow.rows[j]];
    row.slow = is(j);
    if (row.slow) mode.slow.rows[count++] = mode.slow.rows[j];
  }
  mode.slow.rows.resize(count);
  return count == all;
}

/// [m/s] Of velocity at the start across the direction at which it would stand still.
SlowVector offManifold(Island& island, const ModeSystem& system) {
  Mode& mode = island.s.mode;
  SlowVector off = mode.slow.turns * accelerationsAcross(mode, system, system.p);
  for (Eigen::Index j = 0; j < off.size(); ++j)
    off[j] *= slipAtStart(island, mode.rows[mode.slow.rows[j]]).norm();
  return off;
}

/// Of the rows at the start those that are not on the manifold are none. Whether all are.
bool keepNear(Island& island, const ModeSystem& system, double allowed) {
  Mode& mode = island.s.mode;
  const SlowVector off = offManifold(island, system);
  return keepSlow(mode, [&](std::size_t j) {
    const double speed = slipAtStart(island, mode.rows[mode.slow.rows[j]]).norm();
    return std::abs(off[j]) < std::max(kOffSlow, allowed) + mostLag(allowed) * speed;
  });
}

/// Likewise those that are too far behind where they would be if they stood still.
bool keepExact(Island& island, double allowed) {
  Mode& mode = island.s.mode;
  return keepSlow(mode, [&](std::size_t j) {
    const int i = mode.slow.rows[j];
    const Vec3 across = alongSurface(island, mode.first[i], blockOf(mode, i).across());
    return std::abs(slipAtStart(island, mode.rows[i]).dot(across)) < std::max(kOffSlow, allowed) &&
           std::abs(mode.slow.lag[j]) < 0.5 * mostLag(allowed);
  });
}

/// [s] Until one of them is too fast.
double lasting(Island& island, const ModeSystem& system, double allowed) {
  Mode& mode = island.s.mode;
  const double most = mostLag(allowed);
  const ModeVector w = system.b + system.A * system.p;
  double time = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < mode.slow.rows.size(); ++j) {
    const ModeRow& row = mode.rows[mode.slow.rows[j]];
    const ModeBlock& block = blockOf(mode, mode.slow.rows[j]);
    const double speed = slipAtStart(island, row).norm();
    const double faster = block.slip.dot(w.segment<2>(block.row + 1));
    const double per_speed = (mode.slow.turns.row(j).cwiseAbs() * mode.slow.rate.cwiseAbs())(0);
    if (faster > 0) time = std::min(time, std::max(0.0, most / per_speed - speed) / faster);
  }
  return time;
}

}  // namespace

bool findSlowSlips(Island& island, double h, double allowed, double& lasts) {
  Mode& mode = island.s.mode;
  const bool were = !mode.slow.rows.empty();
  clearSlowSlips(mode);
  lasts = std::numeric_limits<double>::infinity();
  listSlowSlips(island, h);
  ModeSystem system;
  ModePoint& tried = mode.sample;
  if (!mode.slow.rows.empty()) tried = mode.start;
  for (int k = 0; k < kSlowRounds && !mode.slow.rows.empty(); ++k) {
    mode.slow.start.clear();
    for (const int i : mode.slow.rows) mode.slow.start.push_back(mode.rows[i].along);
    if (!buildAccelerations(island, tried, system) ||
        !solveEqualities(system.A, system.b, mode.blocks, system.p) || !findTurns(mode, system))
      break;
    if (!keepNear(island, system, allowed)) continue;
    if (!solveSlowSlips(island, tried, system)) break;
    if (!keepExact(island, allowed)) continue;
    const double time = lasting(island, system, allowed);
    if (time < kTurnsAtOnce * h) break;
    lasts = time;
    pushInMode(island, system.p, tried.x.data(), tried.a.data());
    keepForces(island, system.p, tried.forces);
    mode.start = tried;
    return true;
  }
  clearSlowSlips(mode);
  return !were || accelerateInMode(island, mode.start);
}

}  // namespace ragdoll
