// A scene's first ragdoll as other engines know such things: rigid bodies with the segments'
// masses, centres of mass and inertias, and joints where segments share particles. For comparisons
// with them. World frame unless a name says otherwise; SI.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll::test {

/// Its frame: origin at the centre of mass, axes the model's when the body is at rest.
struct RigidBody {
  std::string name;
  double mass = 0;
  Vec3 com = Vec3::Zero();       ///< model's frame, rest pose
  Vec3 moments = Vec3::Zero();   ///< principal moments of inertia about com [kg m^2]
  Quat axes = Quat::Identity();  ///< principal axes -> model's axes
  std::vector<int> particles;    ///< that it holds
  std::vector<int> spheres;      ///< those among them that it touches a floor with
};

struct RigidJoint {
  std::string name;
  int parent = -1, child = 0;        ///< bodies; parent -1: the world
  Vec3 anchor = Vec3::Zero();        ///< model's frame, rest pose
  bool hinge = false;                ///< about axis; else a ball joint
  Vec3 axis = Vec3::UnitY();         ///< hinge, or the cone's axis, fixed in the parent
  Vec3 bone = Vec3::UnitZ();         ///< cone: the child's direction at rest
  std::optional<AngleRange> range;   ///< hinge [rad]
  std::optional<double> half_angle;  ///< cone [rad]
};

struct RigidScene {
  std::vector<RigidBody> bodies;
  std::vector<RigidJoint> joints;  ///< a tree
  Points rest;                     ///< particles, model's frame
  Eigen::VectorXd radius;          ///< of their spheres
  Pose start;                      ///< model's frame -> world; all at rest
  Vec3 gravity = Vec3::Zero();
  bool floor = false;   ///< z = 0
  double friction = 0;  ///< of the floor

  Pose startOf(int body) const {
    return {start.position + start.orientation * bodies[body].com, start.orientation};
  }
  /// Where `particle` is, as `body` at `pose` has it.
  Vec3 particleOf(int body, int particle, const Pose& pose) const {
    return pose.position + pose.orientation * (rest.col(particle) - bodies[body].com);
  }
};

namespace rigid_detail {

/// A rod has no inertia about its own axis; engines need one. A round bone's is given: as nothing
/// turns a rod about its axis when ball joints on the axis hold it, the motion does not depend on
/// it.
inline RigidBody bodyOf(const SegmentSpec& g, const Skeleton& s) {
  RigidBody body;
  body.name = g.name;
  body.mass = g.mass;
  for (const std::string& name : g.particles) body.particles.push_back(s.particle(name));
  if (g.group) {
    body.com = g.com_point;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(g.inertia);
    Eigen::Matrix3d axes = solver.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    body.moments = solver.eigenvalues();
    body.axes = Quat(axes);
    return body;
  }
  const Vec3 from = s.rest.col(body.particles[0]), to = s.rest.col(body.particles[1]);
  const double length = (to - from).norm();
  const double radius =
      std::max(0.02, 0.5 * (s.radius[body.particles[0]] + s.radius[body.particles[1]]));
  const double across = g.mass * std::pow(g.gyration * length, 2);
  body.com = from + g.com * (to - from);
  body.moments = Vec3(across, across, 0.5 * g.mass * radius * radius);
  body.axes = Quat::FromTwoVectors(Vec3::UnitZ(), to - from);
  return body;
}

inline std::vector<int> shared(const RigidBody& a, const RigidBody& b) {
  std::vector<int> both;
  for (const int p : a.particles)
    for (const int q : b.particles)
      if (p == q) both.push_back(p);
  return both;
}

}  // namespace rigid_detail

/// Bodies that share two particles fold about them; those that share one are held by a ball joint,
/// or, with limits and where the model says hinge, by a hinge. Bodies hang on those named before
/// them. Throws std::runtime_error where segments are no tree or do not carry the whole mass.
inline RigidScene rigidScene(const Scene& scene, const Model& model, bool with_limits) {
  const RagdollSpec& ragdoll = scene.ragdolls.at(0);
  const SkeletonSpec& spec = *ragdoll.skeleton;
  const Skeleton& skeleton = model.skeletonOf(model.ragdolls.at(0));
  RigidScene result;
  result.rest = skeleton.rest.leftCols(skeleton.named);
  result.radius = skeleton.radius.head(skeleton.named);
  result.start = ragdoll.pose;
  result.gravity = scene.gravity;
  result.floor = !scene.obstacles.empty();
  if (result.floor) result.friction = scene.obstacles[0].friction;
  for (const SegmentSpec& segment : spec.segments)
    if (segment.mass > 0) result.bodies.push_back(rigid_detail::bodyOf(segment, skeleton));

  std::vector<bool> touched(skeleton.named, false);
  for (RigidBody& body : result.bodies)
    for (const int p : body.particles)
      if (!touched[p]) touched[p] = true, body.spheres.push_back(p);

  const int count = static_cast<int>(result.bodies.size());
  for (int child = 1; child < count; ++child)
    for (int parent = 0; parent < child; ++parent) {
      const std::vector<int> both =
          rigid_detail::shared(result.bodies[parent], result.bodies[child]);
      if (both.empty()) continue;
      RigidJoint joint;
      joint.name = result.bodies[parent].name + "_" + result.bodies[child].name;
      joint.parent = parent;
      joint.child = child;
      joint.anchor = result.rest.col(both[0]);
      if (both.size() == 2) {
        joint.hinge = true;
        joint.anchor = 0.5 * (joint.anchor + result.rest.col(both[1]));
        joint.axis = (result.rest.col(both[1]) - result.rest.col(both[0])).normalized();
      }
      const std::vector<int>& ends = result.bodies[child].particles;
      joint.bone = (result.rest.col(ends[1]) - result.rest.col(ends[0])).normalized();
      for (const JointSpec& limit : spec.joints) {
        if (!with_limits || limit.parent != result.bodies[parent].name ||
            limit.child != result.bodies[child].name)
          continue;
        joint.axis = limit.axis.normalized();
        if (limit.type == JointSpec::Type::kHinge) {
          joint.hinge = true;
          joint.range = limit.range;
        } else if (limit.type == JointSpec::Type::kCone) {
          joint.half_angle = limit.half_angle;
        }
      }
      result.joints.push_back(joint);
      break;
    }
  if (static_cast<int>(result.joints.size()) != count - 1)
    throw std::runtime_error("the segments are no tree");

  for (const Pin& pin : model.pins)
    for (int body = 0; body < count; ++body) {
      const std::vector<int>& held = result.bodies[body].particles;
      if (std::find(held.begin(), held.end(), pin.particle) == held.end()) continue;
      RigidJoint joint;
      joint.name = "pin_" + result.bodies[body].name;
      joint.child = body;
      joint.anchor = result.rest.col(pin.particle);
      result.joints.push_back(joint);
      break;
    }
  return result;
}

}  // namespace ragdoll::test
