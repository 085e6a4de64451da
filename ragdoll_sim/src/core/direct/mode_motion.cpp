#include "core/direct/mode_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/dormand_prince.h"
#include "core/direct/driving.h"
#include "core/direct/mode_rows.h"

namespace ragdoll {
namespace {

using namespace dormand_prince;
using Kind = ModeRow::Kind;

/// Vector along the surface from what it has along the two tangents of a row.
Vec3 alongSurface(const Schur& schur, int row, const Eigen::Vector2d& t) {
  return t[0] * schur.row(row + 1).direction + t[1] * schur.row(row + 2).direction;
}

/// Unit direction in which a contact slips: of its velocity, turned into that of the piece's start,
/// so that it stays what it was where the slip ends.
Eigen::Vector2d slipDirection(const Schur& schur, int row, const Vec3& slip, const Vec3& reference) {
  const auto of = [&](const Vec3& u) {
    return Eigen::Vector2d(schur.row(row + 1).direction.dot(u), schur.row(row + 2).direction.dot(u));
  };
  Eigen::Vector2d now = of(slip);
  if (now.norm() < kStill) now = of(reference);
  if (slip.dot(reference) < 0 && slip.norm() >= kStill) now = -now;
  const double length = now.norm();
  return length > 0 ? Eigen::Vector2d(now / length) : Eigen::Vector2d(1, 0);
}

const Compliance& giveOf(const ModeRow& row, const RowPlace& place) {
  return row.kind == Kind::kLimit ? row.give : place.contact.give;
}

/// [N], [N m] While it presses.
double springForce(const ModeRow& row, const RowPlace& place, const Body& body, const double* x,
                   const double* v) {
  const Compliance& give = giveOf(row, place);
  return -place.gap / give.compliance - give.damping * dampedRate(body, row, place, x, v);
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
void accelerateFreely(Body& body, ModePoint& point) {
  Mode& mode = body.mode;
  point.power = 0;
  if (forcesFollow(body))
    point.power = drive(body, point.x.data(), point.v.data(), mode.free);
  else
    mode.free = body.acceleration;
  BodyResponse& response = body.memory->response;
  response.setFree(mode.free);
  response.setEnd(point.x.data());
  response.accelerate(true, point.v.data(), point.a.data());
}

void resize(const Body& body, ModePoint& point) {
  const int size = paddedWidth(3 * body.n);
  for (Eigen::VectorXd* values : {&point.x, &point.v, &point.a})
    if (values->size() != size) values->setZero(size);
}

/// system.b <- second derivatives of the closed rows without their forces.
void evaluateAccelerations(const Body& body, const ModePoint& point, ModeSystem& system) {
  const Mode& mode = body.mode;
  const Schur& schur = body.memory->schur;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0) continue;
    system.b[row] = schur.along(row, point.a.data()) + mode.place[i].curvature;
    if (!(mode.rows[i].friction > 0)) continue;
    for (int k = 1; k < 3; ++k)
      system.b[row + k] = schur.along(row + k, point.a.data()) +
                          schur.row(row + k).direction.dot(mode.place[i].turn);
  }
}

void keepForces(const Body& body, const ModeVector& p, ModeForces& forces) {
  const Mode& mode = body.mode;
  const Schur& schur = body.memory->schur;
  forces.normal.assign(mode.rows.size(), 0);
  forces.friction.assign(mode.rows.size(), Vec3::Zero());
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0) continue;
    forces.normal[i] = p[row];
    if (mode.rows[i].friction > 0)
      forces.friction[i] = alongSurface(schur, row, Eigen::Vector2d(p[row + 1], p[row + 2]));
  }
}

/// Rates of the closed rows at v.
void evaluateModeRates(const Body& body, const double* v, ModeSystem& system) {
  const Schur& schur = body.memory->schur;
  for (int i = 0; i < schur.size(); ++i) system.b[i] = schur.along(i, v);
}

double forceScale(const ModeSystem& system) {
  double scale = 0;
  for (int i = 0; i < system.b.size(); ++i)
    if (system.A(i, i) > kNoAnswer)
      scale = std::max(scale, std::abs(system.b[i]) / system.A(i, i));
  return scale;
}

/// rates: before it.
void logImpact(const Body& body, const ModeSystem& system, const ModeVector& rates,
               const ModePoint& point) {
  if (!body.context->log) return;
  const Mode& mode = body.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0 || mode.rows[i].kind == Kind::kLimit || !(system.p[row] > 0)) continue;
    LoggedImpact impact;
    impact.impulse = system.p[row] * mode.place[i].contact.normal;
    if (mode.rows[i].friction > 0)
      impact.impulse += alongSurface(body.memory->schur, row,
                                     Eigen::Vector2d(system.p[row + 1], system.p[row + 2]));
    impact.approach = std::max(0.0, -rates[row]);
    impact.answer = system.A(row, row);
    logImpulse(body, mode.place[i].contact, impact, point.x.data(), point.v.data());
  }
}

}  // namespace

Vec3 slipOf(const Body& body, const Contact& c, const double* v) {
  const Vec3 rate = motionOf(body, c, v);
  return rate - rate.dot(c.normal) * c.normal;
}

bool buildModeSystem(Body& body, const double* x, const double* v, bool curvature,
                     ModeSystem& system) {
  Mode& mode = body.mode;
  Schur& schur = body.memory->schur;
  schur.start(body.first);
  mode.place.resize(mode.rows.size());
  mode.first.assign(mode.rows.size(), -1);
  mode.blocks.clear();
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.closed) continue;
    RowPlace& place = mode.place[i] = placeOf(body, row, x, v, curvature);
    if (!place.regular) return false;
    mode.first[i] = schur.size();
    ModeBlock block;
    block.row = schur.size();
    block.presses = row.presses;
    block.sticks = row.sticks;
    block.slips = row.moves;
    block.given = row.isSoft();
    if (block.given && row.presses) block.force = springForce(row, place, body, x, v);
    if (row.kind == Kind::kLimit) {
      schur.addLimit(place.limit, static_cast<int>(i), 0);
    } else {
      schur.addContact(place.contact, static_cast<int>(i));
      block.friction = row.friction;
      if (row.friction > 0 && !row.sticks)
        block.slip = slipDirection(schur, block.row, slipOf(body, place.contact, v), row.slip);
    }
    mode.blocks.push_back(block);
  }
  const int m = schur.size();
  if (m > kMostModeRows) return false;
  body.memory->response.setEnd(x);
  if (m > 0) body.memory->response.assemble(schur, true);
  system.A = schur.matrix();
  system.b.setZero(m);
  system.p.setZero(m);
  return true;
}

bool accelerateInMode(Body& body, ModePoint& point) {
  ModeSystem system;
  accelerateFreely(body, point);
  if (!buildModeSystem(body, point.x.data(), point.v.data(), true, system)) return false;
  if (system.b.size() > 0) {
    evaluateAccelerations(body, point, system);
    if (!solveEqualities(system.A, system.b, body.mode.blocks, system.p)) return false;
    body.memory->schur.move(system.p, point.a.data());
  }
  keepForces(body, system.p, point.forces);
  return point.a.allFinite();
}

bool findMode(Body& body, ModePoint& point) {
  Mode& mode = body.mode;
  ModeSystem system;
  accelerateFreely(body, point);
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    ModeRow& row = mode.rows[i];
    row.sticks = row.moves = false;
    if (!row.isSoft()) row.presses = false;
    if (!row.closed || row.kind == Kind::kLimit) continue;
    const Vec3 slip = slipOf(
        body, placeOf(body, row, point.x.data(), point.v.data(), false).contact, point.v.data());
    row.moves = row.friction > 0 && slip.norm() > kStill;
    row.slip = row.moves ? Vec3(slip.normalized()) : Vec3(Vec3::Zero());
  }
  if (!buildModeSystem(body, point.x.data(), point.v.data(), true, system)) return false;
  keepAnswers(mode, system);
  if (system.b.size() > 0) {
    evaluateAccelerations(body, point, system);
    mode.force_scale = forceScale(system);
    if (!solveComplementarity(system.A, system.b, mode.force_scale, mode.blocks, system.p))
      return false;
    body.memory->schur.move(system.p, point.a.data());
  }
  keepForces(body, system.p, point.forces);
  std::size_t k = 0;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    if (mode.first[i] < 0) continue;
    ModeRow& row = mode.rows[i];
    const ModeBlock& block = mode.blocks[k++];
    row.presses = block.presses;
    row.sticks = block.sticks;
    if (block.presses && row.friction > 0 && !block.sticks && !row.moves)
      row.slip = alongSurface(body.memory->schur, mode.first[i], block.slip);
    row.feature = mode.place[i].feature;
  }
  return point.a.allFinite();
}

bool takeModeImpact(Body& body, ModePoint& point) {
  Mode& mode = body.mode;
  ModeSystem system;
  for (ModeRow& row : mode.rows) row.presses = row.sticks = row.moves = false;
  if (!buildModeSystem(body, point.x.data(), point.v.data(), false, system)) return false;
  evaluateModeRates(body, point.v.data(), system);
  const ModeVector rates = system.b;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const int row = mode.first[i];
    if (row < 0 || mode.rows[i].kind == Kind::kLimit) continue;
    if (-system.b[row] > kRestApproach) system.b[row] *= 1 + mode.rows[i].restitution;
  }
  if (!solveComplementarity(system.A, system.b, forceScale(system), mode.blocks, system.p))
    return false;
  body.memory->schur.move(system.p, point.v.data());
  logImpact(body, system, rates, point);
  return point.v.allFinite();
}

bool projectVelocities(Body& body, ModePoint& point, bool begins) {
  ModeSystem system;
  BodyResponse& response = body.memory->response;
  response.setEnd(point.x.data());
  response.projectAtEnd(point.v.data());
  if (!buildModeSystem(body, point.x.data(), point.v.data(), false, system)) return false;
  if (system.b.size() == 0) return true;
  evaluateModeRates(body, point.v.data(), system);
  for (ModeBlock& block : body.mode.blocks) {  // sliding contacts by the normal alone
    if (begins && !block.slips) block.sticks = block.friction > 0;
    if (!block.sticks) block.slip.setZero();
    block.force = 0;
  }
  if (!solveEqualities(system.A, system.b, body.mode.blocks, system.p)) return false;
  body.memory->schur.move(system.p, point.v.data());
  return true;
}

bool projectPositions(Body& body, ModePoint& point) {
  BodyResponse& response = body.memory->response;
  Points& dx = body.kept;
  Eigen::VectorXd& lambda = body.tension;
  const auto alongSticks = [&] {
    dx.setZero(3, body.n);
    lambda.setZero(body.rows->width);
    const Eigen::Map<const Points> x(point.x.data(), 3, body.n);
    if (!response.alongEnd(body.lengths, x, dx, lambda)) return false;
    point.x.head(3 * body.n) += Eigen::Map<const Eigen::VectorXd>(dx.data(), 3 * body.n);
    return true;
  };
  Mode& mode = body.mode;
  for (int k = 0; k < kModeProjections; ++k) {
    if (!alongSticks()) return false;
    double worst = 0;
    for (const ModeRow& row : mode.rows)
      if (row.presses && !row.isSoft()) worst = std::max(worst, std::abs(gapOf(body, row, point.x.data())));
    if (worst < kProjected) return true;
    ModeSystem system;
    if (!buildModeSystem(body, point.x.data(), point.v.data(), false, system)) return false;
    for (std::size_t i = 0; i < mode.rows.size(); ++i)
      if (mode.first[i] >= 0) system.b[mode.first[i]] = mode.place[i].gap;
    for (ModeBlock& block : mode.blocks) {
      if (block.friction > 0) block.sticks = false, block.slip.setZero();
      block.force = 0;
    }
    if (!solveEqualities(system.A, system.b, mode.blocks, system.p)) return false;
    body.memory->schur.move(system.p, point.x.data());
  }
  return false;
}

bool moveInMode(Body& body, double h, ModePoint& end) {
  Mode& mode = body.mode;
  ModePoint& stage = mode.stage;
  resize(body, stage);
  resize(body, end);
  const Eigen::Index size = mode.start.x.size();
  mode.slopes.resize(kStages, 2 * size);
  mode.stages.resize(kStages);
  mode.work = 0;
  const auto sum = [&](const double* weights, int count, ModePoint& out) {
    out.x = mode.start.x;
    out.v = mode.start.v;
    for (int j = 0; j < count; ++j) {
      out.x += (h * weights[j]) * mode.slopes.row(j).head(size).transpose();
      out.v += (h * weights[j]) * mode.slopes.row(j).tail(size).transpose();
    }
  };
  for (int i = 0; i < kStages; ++i) {
    ModePoint& point = i == 0 ? mode.start : stage;
    if (i > 0) {
      sum(kA[i], i, stage);
      if (!accelerateInMode(body, stage)) return false;
    }
    mode.slopes.row(i).head(size) = point.v.transpose();
    mode.slopes.row(i).tail(size) = point.a.transpose();
    mode.stages[i] = point.forces;
    mode.work += h * kB[i] * point.power;
  }
  sum(kB, kStages, end);
  return end.x.allFinite() && projectPositions(body, end) && projectVelocities(body, end, false);
}

double errorOfPiece(Body& body, double h) {
  Mode& mode = body.mode;
  const Eigen::Index size = mode.start.x.size();
  Eigen::VectorXd& error = mode.p;
  error = kE[kStages] * mode.end.a;
  for (int j = 0; j < kStages; ++j) error += kE[j] * mode.slopes.row(j).tail(size).transpose();
  const Eigen::Map<const Points> of(error.data(), 3, body.n);
  return h * std::sqrt(of.colwise().squaredNorm().maxCoeff());
}

void interpolate(const ModePoint& start, const ModePoint& end, double h, double share,
                 ModePoint& out) {
  const double s = share, s2 = s * s, s3 = s2 * s;
  // Hermite of degree 5: values, first and second derivatives at both ends.
  const double x1 = s3 * (10 - 15 * s + 6 * s2), v0 = s - s3 * (6 - 8 * s + 3 * s2),
               v1 = s3 * (-4 + 7 * s - 3 * s2), a0 = 0.5 * (s2 - s3 * (3 - 3 * s + s2)),
               a1 = 0.5 * s3 * (1 - 2 * s + s2);
  out.x = start.x + x1 * (end.x - start.x) + h * (v0 * start.v + v1 * end.v) +
          h * h * (a0 * start.a + a1 * end.a);
  const double dx1 = 30 * s2 * (1 - 2 * s + s2), dv0 = 1 - s2 * (18 - 32 * s + 15 * s2),
               dv1 = s2 * (-12 + 28 * s - 15 * s2), da0 = 0.5 * (2 * s - s2 * (9 - 12 * s + 5 * s2)),
               da1 = 0.5 * s2 * (3 - 8 * s + 5 * s2);
  out.v = (dx1 / h) * (end.x - start.x) + dv0 * start.v + dv1 * end.v +
          h * (da0 * start.a + da1 * end.a);
}

}  // namespace ragdoll
