#include "core/direct/rigid_fallback.h"

#include <algorithm>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/driving.h"
#include "core/direct/energy.h"
#include "core/direct/velocity_solver.h"
#include "core/linear/constants.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

/// [m/s] of what several pins carry along, which need not be rigid. In the body's scratch.
const Points& findCarried(Body& body) {
  Points& carried = body.moved;
  carried.setZero(3, body.n);
  if (body.pinned->pins.size() > 1) addCarried(body, body.saved.v, 1, carried);
  return carried;
}

/// The motion dx over t from where the body is, with what pins carry along; motion.spin is
/// shortened to what one motion can turn.
void setRigidMotion(Body& body, const Points& carried, double t, RigidMotion& motion) {
  const double angle = motion.spin.norm() * t;
  if (angle > kLargestTurn) motion.spin *= kLargestTurn / angle;
  Points& dx = body.motion.dx;
  dx = t * carried;
  if (angle > 0) {
    const Eigen::AngleAxisd turn(std::min(angle, kLargestTurn), motion.spin.normalized());
    const Eigen::Matrix3d turned = turn.toRotationMatrix() - Eigen::Matrix3d::Identity();
    for (int i = 0; i < body.n; ++i) dx.col(i) += turned * (body.x().col(i) - motion.centre);
  }
  dx.colwise() += t * motion.drift;
}

/// [m] by how much the motion goes deeper into anything than it was.
double deepening(const Body& body) {
  double deepest = 0;
  for (const Contact& c : body.constraints.contacts) {
    const double gap = gapAfter(body, c) + c.offset - c.found;  // none of it may stay
    deepest = std::max(deepest, std::min(0.0, c.gap_start) - gap);
  }
  return deepest;
}

/// body.motion.dx over t [s], which shrinks to the part of it before the first touch.
RigidMotion findRigidMotion(Body& body, const Points& carried, double& t) {
  const std::vector<int>& pins = body.pinned->pins;
  RigidMotion motion;
  const double h = t;
  for (int i = 0; i < kMaxShortenings; ++i, t *= 0.5) {
    if (i + 1 == kMaxShortenings) t = 0;
    body.v1 = body.v() + t * body.acceleration;
    motion = rigidMotion(massOf(body), pins, body.x(), body.v1);
    if (pins.size() > 1) motion.drift.setZero();
    setRigidMotion(body, carried, t, motion);
    if (!body.motion.dx.allFinite()) continue;
    findCandidates(body, h);
    if (deepening(body) < kTouchDepth) break;
  }
  if (!body.motion.dx.allFinite()) {
    body.motion.dx.setZero();
    findCandidates(body, h);  // those that are there may be another body's
  }
  return motion;
}

}  // namespace

bool moveRigidly(Island& island, double h, StepReport& report) {
  ++report.rigid;
  Body& body = *island.bodies[0];
  const std::vector<int>& pins = body.pinned->pins;
  const Points& carried = findCarried(body);
  double t = h;
  RigidMotion motion = findRigidMotion(body, carried, t);
  body.cache.clear();
  std::fill(body.multipliers(), body.multipliers() + 2 * body.rows->s, 0.0);
  findTouching(body, 0);
  body.x() += body.motion.dx;
  motion.centre += t * motion.drift;
  for (int i = 0; i < body.n; ++i)
    body.v().col(i) = motion.velocityAt(body.x().col(i)) + carried.col(i);
  BodyResponse& response = body.memory->response;
  response.setEnd(body.xData());
  response.projectAtEnd(body.vData());
  solveVelocities(island, Stage::kMotion, 0, 0);
  response.endIsStart();
  report.unresolved += !body.v().allFinite();
  const bool touches = !pins.empty() || !body.touching.contacts.empty();
  if (!body.v().allFinite() ||
      (touches && gainedEnergy(body, h, 0) > kRigidGain * kineticEnergy(body))) {
    body.v().setZero();
    return true;
  }
  return false;
}

}  // namespace ragdoll
