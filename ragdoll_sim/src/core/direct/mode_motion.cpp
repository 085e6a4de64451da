#include "core/direct/mode_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/direct/constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/driving.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_energy.h"
#include "core/direct/mode_rows.h"
#include "core/direct/mode_slow_slips.h"
#include "core/direct/mode_spin.h"
#include "core/direct/rows.h"

namespace ragdoll {

Vec3 alongSurface(const Island& island, int row, const Eigen::Vector2d& t) {
  const JointSchur& joint = island.s.joint;
  return t[0] * joint.row(row + 1).direction + t[1] * joint.row(row + 2).direction;
}

namespace {

/// Unit direction in which a contact slips: of its velocity, turned into that of the piece's start,
/// so that it stays what it was where the slip ends; nearly still it passes into that smoothly.
Eigen::Vector2d slipDirection(const Contact& c, const Vec3& slip, const Vec3& reference) {
  const std::array<Vec3, 3> directions = c.directions();
  const Vec3 turned = slip.dot(reference) < 0 ? Vec3(-slip) : slip;
  const Vec3 u = turned + kBarelyMoves * reference;
  const Eigen::Vector2d now(directions[1].dot(u), directions[2].dot(u));
  const double length = now.norm();
  return length > 0 ? Eigen::Vector2d(now / length) : Eigen::Vector2d(1, 0);
}

const Compliance& giveOf(const ModeRow& row, const RowPlace& place) {
  return row.isContact() ? place.contact.give : row.give;
}

/// [N], [N m] While it presses.
double springForce(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
                   const double* v) {
  const Compliance& give = giveOf(row, place);
  return -place.gap / give.compliance - give.damping * dampedRate(island, row, place, x, v);
}

/// How the body answers to the springs that press, and so the longest piece in which they are
/// followed.
void keepAnswers(Mode& mode, const ModeSystem& system) {
  mode.longest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    ModeRow& row = mode.rows[i];
    if (mode.first[i] < 0 || !row.isSoft()) continue;
    row.answer = system.A(mode.first[i], mode.first[i]);
    const Compliance& give = giveOf(row, mode.place[i]);
    const double rate = std::sqrt(row.answer / give.compliance) + give.damping * row.answer;
    mode.longest = std::min(mode.longest, kSpringPhase / rate);
  }
}

/// Stick accelerations at the point, whose free ones and power are set by it.
void accelerateFreely(Island& island, ModePoint& point) {
  point.power = 0;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    const int offset = island.s.mode.offset[k];
    const double *x = point.x.data() + offset, *v = point.v.data() + offset;
    Points& free = body.v1;
    point.power += drive(body, x, v, free);
    BodyResponse& response = body.memory->response;
    response.setFree(free);
    response.setEnd(x);
    response.accelerate(true, v, point.a.data() + offset);
  }
}

/// system.b <- second derivatives of the closed rows without their forces.
void evaluateAccelerations(const Island& island, const ModePoint& point, ModeSystem& system) {
  const Mode& mode = island.s.mode;
  const JointSchur& joint = island.s.joint;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0) continue;
    system.b[row] = joint.along(row, point.a.data(), mode.offset) + mode.place[i].curvature;
    if (!(mode.rows[i].friction > 0)) continue;
    for (int k = 1; k < 3; ++k)
      system.b[row + k] = joint.along(row + k, point.a.data(), mode.offset) +
                          joint.row(row + k).direction.dot(mode.place[i].turn);
  }
  takeSpinAccelerations(island, point, system.b);
}

}  // namespace

void keepForces(const Island& island, const ModeVector& p, ModeForces& forces) {
  const Mode& mode = island.s.mode;
  forces.normal.assign(mode.rows.size(), 0);
  forces.friction.assign(mode.rows.size(), Vec3::Zero());
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0) continue;
    forces.normal[i] = p[row];
    if (mode.rows[i].friction > 0)
      forces.friction[i] = alongSurface(island, row, Eigen::Vector2d(p[row + 1], p[row + 2]));
  }
}

namespace {

/// Rates of the closed rows at v.
void evaluateModeRates(const Island& island, const double* v, ModeSystem& system) {
  const Mode& mode = island.s.mode;
  const JointSchur& joint = island.s.joint;
  for (int i = 0; i < system.b.size(); ++i) system.b[i] = joint.along(i, v, mode.offset);
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0 || mode.place[i].surface.isZero(0)) continue;
    for (int k = 0; k < rowsOf(mode.place[i].contact); ++k)
      system.b[row + k] -= joint.row(row + k).direction.dot(mode.place[i].surface);
  }
  takeSpinRates(island, system.b);
}

/// Of the weight, too: in free fall nothing but rounding presses.
double forceScale(const Island& island, const ModeSystem& system) {
  double mass = 0;
  for (const Body* body : island.bodies) mass += body->rows->mass.sum();
  return std::max(impulseScale(system.A, system.b),
                  kLeastOfWeight * mass * island.context.model.gravity.norm());
}

/// rates: before it.
void logImpact(const Island& island, const ModeSystem& system, const ModeVector& rates,
               const ModePoint& point) {
  if (!isLogged(island)) return;
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0 || !mode.rows[i].isContact() || !(system.p[row] > 0)) continue;
    LoggedImpact impact;
    impact.impulse = system.p[row] * mode.place[i].contact.normal;
    if (mode.rows[i].friction > 0)
      impact.impulse +=
          alongSurface(island, row, Eigen::Vector2d(system.p[row + 1], system.p[row + 2]));
    impact.approach = std::max(0.0, -rates[row]);
    impact.answer = system.A(row, row);
    logImpulse(island, mode.place[i].contact, impact, point.x.data(), point.v.data());
  }
}

/// Bodies that the impact has pushed against each other.
void keepMet(Island& island, const ModeVector& p) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (mode.first[i] < 0 || !mode.rows[i].isShared() || !(p[mode.first[i]] > 0)) continue;
    const Contact& c = mode.place[i].contact;
    island.pairs.met.push_back({c.ragdoll, c.other, false});
  }
}

/// Adds a closed row to what its bodies answer to, and its block.
void addRow(Island& island, std::size_t i, const double* x, const double* v) {
  Mode& mode = island.s.mode;
  const ModeRow& row = mode.rows[i];
  const RowPlace& place = mode.place[i];
  ModeBlock block;
  block.row = mode.first[i];
  block.presses = row.presses;
  block.sticks = row.sticks;
  block.impending = row.impending;
  block.slips = row.moves;
  block.given = row.isSoft();
  if (block.given && row.presses) block.force = springForce(island, row, place, x, v);
  if (row.isContact()) block.friction = row.friction;
  if (block.friction > 0 && !row.sticks)
    block.slip = row.slow
                     ? slipDirection(place.contact, row.along, row.along)
                     : slipDirection(place.contact, slipOf(island, row, place, x, v), row.slip);
  mode.blocks.push_back(block);
}

/// The rows of closed contacts and limits: each body's own, and then those of two. False: they are
/// not smooth at x.
bool buildRows(Island& island, const double* x, const double* v, bool curvature) {
  Mode& mode = island.s.mode;
  JointSchur& joint = island.s.joint;
  joint.clear(island.opensOverlaps());
  std::size_t i = 0;
  const auto place = [&] {
    mode.place[i] = placeOf(island, mode.rows[i], x, v, curvature);
    return mode.place[i].regular;
  };
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Schur& schur = island.bodies[k]->memory->schur;
    schur.start(island.bodies[k]->first);
    for (; i < mode.rows.size(); ++i) {
      const ModeRow& row = mode.rows[i];
      if (row.isShared() || row.body != static_cast<int>(k)) break;
      if (!row.closed) continue;
      if (!place()) return false;
      mode.first[i] = joint.size() + schur.size();
      if (row.isContact())
        schur.addContact(mode.place[i].contact, static_cast<int>(i));
      else
        schur.addLimit(mode.place[i].limit, static_cast<int>(i));
      addRow(island, i, x, v);
    }
    joint.addBody(schur);
  }
  for (; i < mode.rows.size(); ++i) {
    if (!mode.rows[i].closed) continue;
    if (!place()) return false;
    mode.first[i] = addPairRows(island, mode.place[i].contact, static_cast<int>(i));
    addRow(island, i, x, v);
  }
  return true;
}

}  // namespace

void pushInMode(Island& island, const ModeVector& p, const double* x, double* out) {
  IslandScratch& s = island.s;
  s.p = p;
  s.joint.split(s.p, s.parts);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Schur& schur = island.bodies[k]->memory->schur;
    if (!schur.empty()) schur.move(s.parts[k], out + s.mode.offset[k]);
  }
  addSpins(island, p, x, out);
}

Vec3 slipOf(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
            const double* v) {
  const Vec3 rate = motionOf(island, place.contact, v) - place.surface;
  return tangentialPart(rate - spinMotion(island, row, place, x, v), place.contact.normal);
}

bool buildModeSystem(Island& island, const double* x, const double* v, bool curvature,
                     ModeSystem& system) {
  Mode& mode = island.s.mode;
  JointSchur& joint = island.s.joint;
  mode.place.resize(mode.rows.size());
  mode.first.assign(mode.rows.size(), -1);
  mode.blocks.clear();
  if (!buildRows(island, x, v, curvature)) return false;
  const int m = joint.size();
  if (m > kMostModeRows) return false;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    BodyMemory& memory = *island.bodies[k]->memory;
    memory.response.setEnd(x + mode.offset[k]);
    if (!memory.schur.empty()) memory.response.assemble(memory.schur, true);
  }
  system.A.resize(m, m);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) system.A(i, j) = joint.entry(i, j);
  system.b.setZero(m);
  system.p.setZero(m);
  return true;
}

bool buildAccelerations(Island& island, ModePoint& point, ModeSystem& system) {
  accelerateFreely(island, point);
  findSpins(island, point.x.data(), point.v.data(), SpinOf::kPressing);
  if (!buildModeSystem(island, point.x.data(), point.v.data(), true, system)) return false;
  if (system.b.size() == 0) return true;
  coupleFriction(island, system.A);
  evaluateAccelerations(island, point, system);
  return true;
}

namespace {

void keepIdleLoads(const Island& island, const ModeSystem& system, ModeForces& forces) {
  const Mode& mode = island.s.mode;
  forces.idle.assign(mode.rows.size(), -std::numeric_limits<double>::infinity());
  if (system.b.size() == 0) return;
  std::vector<double>& loads = island.s.loads;
  findIdleLoads(system.A, mode.blocks, system.p, loads);
  for (std::size_t i = 0, k = 0; i < mode.rows.size(); ++i)
    if (mode.first[i] >= 0) forces.idle[i] = loads[k++];
}

}  // namespace

bool accelerateInMode(Island& island, ModePoint& point) {
  ModeSystem system;
  if (!buildAccelerations(island, point, system)) return false;
  if (system.b.size() > 0) {
    const bool slow = !island.s.mode.slow.rows.empty();
    if (slow ? !solveSlowSlips(island, point, system)
             : !solveEqualities(system.A, system.b, island.s.mode.blocks, system.p))
      return false;
    pushInMode(island, system.p, point.x.data(), point.a.data());
  }
  keepForces(island, system.p, point.forces);
  keepIdleLoads(island, system, point.forces);
  return point.a.allFinite();
}

namespace {

/// What closed rows do at the point but press: whether they slip, and where to.
void startModes(Island& island, const ModePoint& point) {
  for (ModeRow& row : island.s.mode.rows) {
    row.sticks = row.impending = row.moves = false;
    if (!row.isSoft()) row.presses = false;
    if (!row.closed || !row.isContact()) continue;
    const double *x = point.x.data(), *v = point.v.data();
    const Vec3 slip = slipOf(island, row, placeOf(island, row, x, v, false), x, v);
    row.moves = row.friction > 0 && slip.norm() > kStill;
    row.slip = row.moves ? Vec3(slip.normalized()) : Vec3(Vec3::Zero());
  }
}

/// Rows as the solution's blocks say.
void keepMode(Island& island) {
  Mode& mode = island.s.mode;
  std::size_t k = 0;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (mode.first[i] < 0) continue;
    ModeRow& row = mode.rows[i];
    const ModeBlock& block = mode.blocks[k++];
    row.presses = block.presses;
    row.sticks = block.sticks;
    row.impending = block.presses && !block.sticks && block.impending;
    if (block.presses && row.friction > 0 && !block.sticks && !row.moves)
      row.slip = alongSurface(island, mode.first[i], block.slip);
    row.feature = mode.place[i].feature;
  }
}

/// Rows' states and point.a, from the accelerations without what presses.
bool findPressing(Island& island, ModePoint& point) {
  Mode& mode = island.s.mode;
  ModeSystem system;
  if (!buildModeSystem(island, point.x.data(), point.v.data(), true, system)) return false;
  keepAnswers(mode, system);
  if (system.b.size() > 0) {
    coupleFriction(island, system.A);
    evaluateAccelerations(island, point, system);
    mode.force_scale = forceScale(island, system);
    if (!solveComplementarity(system.A, system.b, mode.force_scale, mode.blocks, system.p))
      return false;
    pushInMode(island, system.p, point.x.data(), point.a.data());
  }
  keepForces(island, system.p, point.forces);
  keepMode(island);
  return point.a.allFinite();
}

}  // namespace

bool findMode(Island& island, ModePoint& point) {
  Mode& mode = island.s.mode;
  findSpins(island, point.x.data(), point.v.data(), SpinOf::kClosed);
  for (int k = 0; k < kSpinRounds; ++k) {
    accelerateFreely(island, point);
    startModes(island, point);
    if (!findPressing(island, point)) return false;
    // What lets go holds no more: then bodies slip beside their common spin.
    mode.found_of = mode.spin_of;
    findSpins(island, point.x.data(), point.v.data(), SpinOf::kPressing);
    if (mode.spin_of == mode.found_of) return true;
  }
  return false;
}

namespace {

/// What stays closed after an impact holds its body, pressed or not. rates: after it.
void holdWhatStays(Mode& mode, const ModeVector& rates) {
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    ModeRow& row = mode.rows[i];
    if (mode.first[i] < 0 || row.obstacle < 0 || !row.isContact()) continue;
    row.presses = row.presses || rates[mode.first[i]] < kParting;
  }
}

}  // namespace

bool takeModeImpact(Island& island, ModePoint& point) {
  Mode& mode = island.s.mode;
  ModeSystem system;
  for (ModeRow& row : mode.rows) row.presses = row.sticks = row.impending = row.moves = false;
  findSpins(island, point.x.data(), point.v.data(), SpinOf::kClosed);
  if (!buildModeSystem(island, point.x.data(), point.v.data(), false, system)) return false;
  evaluateModeRates(island, point.v.data(), system);
  const ModeVector rates = system.b;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0 || !mode.rows[i].isContact()) continue;
    if (-system.b[row] > kRestApproach) system.b[row] *= 1 + mode.rows[i].restitution;
  }
  if (!solveComplementarity(system.A, system.b, impulseScale(system.A, system.b), mode.blocks,
                            system.p))
    return false;
  keepMode(island);
  holdWhatStays(mode, rates + system.A * system.p);
  findSpins(island, point.x.data(), point.v.data(), SpinOf::kPressing);  // after it, as shake
  std::vector<double>& energies = island.s.energies;
  findEnergies(island, point, energies);
  pushInMode(island, system.p, point.x.data(), point.v.data());
  takeImpactGains(island, system.p, energies, point);
  logImpact(island, system, rates, point);
  keepMet(island, system.p);
  return point.v.allFinite();
}

bool projectVelocities(Island& island, ModePoint& point, bool begins) {
  ModeSystem system;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    BodyResponse& response = island.bodies[k]->memory->response;
    response.setEnd(point.x.data() + island.s.mode.offset[k]);
    response.projectAtEnd(point.v.data() + island.s.mode.offset[k]);
  }
  findSpins(island, point.x.data(), point.v.data(), SpinOf::kPressing);
  if (!buildModeSystem(island, point.x.data(), point.v.data(), false, system)) return false;
  if (system.b.size() == 0) return true;
  coupleFriction(island, system.A);
  evaluateModeRates(island, point.v.data(), system);
  // Sliding contacts by the normal alone. But what is taken to be closed as a mode begins and opens
  // (closeChatter) hops: the force that it is to have meanwhile rubs, and so is taken back with
  // that.
  for (ModeBlock& block : island.s.mode.blocks) {
    if (begins && !block.slips) {
      block.sticks = block.friction > 0;
      block.impending = false;
    }
    if (!block.sticks && !block.impending && !begins) block.slip.setZero();
    block.force = 0;
  }
  if (!solveEqualities(system.A, system.b, island.s.mode.blocks, system.p, kLeaving)) return false;
  pushInMode(island, system.p, point.x.data(), point.v.data());
  return true;
}

namespace {

/// The bodies' positions back to the lengths of their sticks.
bool projectLengths(Island& island, ModePoint& point) {
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    const int offset = island.s.mode.offset[k], count = 3 * body.n;
    Points& dx = body.kept;
    Eigen::VectorXd& lambda = body.tension;
    dx.setZero(3, body.n);
    lambda.setZero(body.rows->width);
    const Eigen::Map<const Points> x(point.x.data() + offset, 3, body.n);
    if (!body.memory->response.alongEnd(body.lengths, x, dx, lambda)) return false;
    point.x.segment(offset, count) += Eigen::Map<const Eigen::VectorXd>(dx.data(), count);
  }
  return true;
}

/// Onto the sticks and what presses, in turn.
bool moveOntoRows(Island& island, ModePoint& point) {
  Mode& mode = island.s.mode;
  for (int k = 0; k < kModeProjections; ++k) {
    if (!projectLengths(island, point)) return false;
    double worst = 0;
    for (const ModeRow& row : mode.rows)
      if (row.presses && !row.isSoft())
        worst = std::max(worst, std::abs(gapOf(island, row, point.x.data())));
    if (worst < kProjected) return true;
    ModeSystem system;
    if (!buildModeSystem(island, point.x.data(), point.v.data(), false, system)) return false;
    for (std::size_t i = 0; i < mode.rows.size(); ++i)
      if (mode.first[i] >= 0) system.b[mode.first[i]] = mode.place[i].gap;
    for (ModeBlock& block : mode.blocks) {
      if (block.friction > 0) block.sticks = block.impending = false, block.slip.setZero();
      block.force = 0;
    }
    if (!solveEqualities(system.A, system.b, mode.blocks, system.p)) return false;
    pushInMode(island, system.p, point.x.data(), point.x.data());
  }
  return false;
}

}  // namespace

bool projectPositions(Island& island, ModePoint& point) {
  findSpins(island, point.x.data(), point.v.data(), SpinOf::kEach);
  if (!moveOntoRows(island, point)) return false;
  keepSpins(island, point);
  return true;
}

}  // namespace ragdoll
