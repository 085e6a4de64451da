#include <algorithm>
#include <cmath>

#include "peer.h"
#include "ragdoll_sim/core/build_model.h"

namespace ragdoll::peers {

RigidSimulation::RigidSimulation(const Scene& scene, bool limits, bool planar)
    : scene_(test::rigidScene(scene, buildModel(scene), limits)) {
  if (!planar) return;
  for (test::RigidJoint& joint : scene_.joints) {
    joint.hinge = true;
    joint.axis = Vec3::UnitY();
  }
}

Vec3 RigidSimulation::particle(int index) const {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
    for (const int p : scene_.bodies[i].particles)
      if (p == index) return scene_.particleOf(static_cast<int>(i), p, pose(static_cast<int>(i)));
  return Vec3::Constant(NAN);
}

Vec3 RigidSimulation::centreOfMass() const {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    sum += scene_.bodies[i].mass * pose(static_cast<int>(i)).position;
    mass += scene_.bodies[i].mass;
  }
  return sum / mass;
}

double RigidSimulation::energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const test::RigidBody& body = scene_.bodies[i];
    const Pose at = pose(static_cast<int>(i));
    Vec3 angular, linear;
    velocity(static_cast<int>(i), angular, linear);
    const Vec3 w = (at.orientation * body.axes).conjugate() * angular;
    sum += 0.5 * body.mass * linear.squaredNorm() + 0.5 * w.cwiseAbs2().dot(body.moments) -
           body.mass * scene_.gravity.dot(at.position);
  }
  return sum;
}

double RigidSimulation::speed() const {
  double worst = 0;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    Vec3 angular, linear;
    velocity(static_cast<int>(i), angular, linear);
    const Pose at = pose(static_cast<int>(i));
    for (const int p : scene_.bodies[i].particles) {
      const Vec3 arm = scene_.particleOf(static_cast<int>(i), p, at) - at.position;
      worst = std::max(worst, (linear + angular.cross(arm)).norm());
    }
  }
  return worst;
}

double RigidSimulation::gap() const {
  double worst = 0;
  for (const test::RigidJoint& joint : scene_.joints) {
    const auto anchor = [&](int body) -> Vec3 {
      if (body < 0) return scene_.start.position + scene_.start.orientation * joint.anchor;
      const Pose at = pose(body);
      return at.position + at.orientation * (joint.anchor - scene_.bodies[body].com);
    };
    worst = std::max(worst, (anchor(joint.parent) - anchor(joint.child)).norm());
  }
  return worst;
}

double RigidSimulation::penetration() const {
  double worst = 0;
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
    for (const int p : scene_.bodies[i].spheres) {
      const Vec3 at = scene_.particleOf(static_cast<int>(i), p, pose(static_cast<int>(i)));
      worst = std::max(worst, scene_.radius[p] - at.z());
    }
  return worst;
}

double RigidSimulation::limitViolation() const {
  double worst = 0;
  for (const test::RigidJoint& joint : scene_.joints) {
    if (joint.parent < 0) continue;
    const Quat parent = pose(joint.parent).orientation, child = pose(joint.child).orientation;
    if (joint.range) {
      const double turn = turnOf(joint, parent, child);
      worst = std::max({worst, joint.range->begin - turn, turn - joint.range->end});
    }
    if (joint.half_angle) {
      const Vec3 a = parent * joint.axis, b = child * joint.bone;
      worst = std::max(worst, std::atan2(a.cross(b).norm(), a.dot(b)) - *joint.half_angle);
    }
  }
  return worst;
}

double turnOf(const test::RigidJoint& joint, const Quat& parent, const Quat& child) {
  const Quat turn = parent.conjugate() * child;
  return std::remainder(2 * std::atan2(turn.vec().dot(joint.axis), turn.w()), 2 * M_PI);
}

}  // namespace ragdoll::peers
