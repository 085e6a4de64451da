// ODE: rigid bodies in maximal coordinates; joints by a direct solver (step) or by relaxation
// (quickstep).
#include <ode/ode.h>

#include <cmath>

#include "peer.h"

namespace ragdoll::peers {
namespace {

constexpr int kMostContacts = 4;  ///< of one sphere

/// The library's global state.
void start() {
  static const bool started = [] {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    return true;
  }();
  (void)started;
}

class Ode : public RigidSimulation {
 public:
  Ode(const Scene& scene, double step, bool limits, bool planar, bool quick)
      : RigidSimulation(scene, limits, planar), step_(step), quick_(quick) {
    start();
    world_ = dWorldCreate();
    space_ = dSimpleSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    const Vec3 g = this->scene().gravity;
    dWorldSetGravity(world_, g.x(), g.y(), g.z());
    for (int i = 0; i < static_cast<int>(this->scene().bodies.size()); ++i) addBody(i);
    for (const test::RigidJoint& joint : this->scene().joints) addJoint(joint);
    if (this->scene().floor) {
      const dGeomID plane = dCreatePlane(space_, 0, 0, 1, 0);
      dGeomSetCategoryBits(plane, 2);
      dGeomSetCollideBits(plane, 1);
    }
  }
  ~Ode() override {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  Ode(const Ode&) = delete;
  Ode& operator=(const Ode&) = delete;

  void step() override {
    for (const Cone& cone : cones_) turnMotor(cone);
    if (scene().floor) dSpaceCollide(space_, this, &Ode::collide);
    if (quick_)
      dWorldQuickStep(world_, step_);
    else
      dWorldStep(world_, step_);
    dJointGroupEmpty(contacts_);
  }

 protected:
  Pose pose(int body) const override {
    const dReal* p = dBodyGetPosition(bodies_[body]);
    const dReal* q = dBodyGetQuaternion(bodies_[body]);
    return {Vec3(p[0], p[1], p[2]), Quat(q[0], q[1], q[2], q[3])};
  }
  void velocity(int body, Vec3& angular, Vec3& linear) const override {
    const dReal* w = dBodyGetAngularVel(bodies_[body]);
    const dReal* v = dBodyGetLinearVel(bodies_[body]);
    angular = Vec3(w[0], w[1], w[2]);
    linear = Vec3(v[0], v[1], v[2]);
  }

 private:
  /// ODE has no cone: a motor about the axis in which the bone leaves it, set anew every step.
  struct Cone {
    const test::RigidJoint* joint;
    dJointID motor;
  };

  void addBody(int i) {
    const test::RigidBody& b = scene().bodies[i];
    const Eigen::Matrix3d axes = b.axes.toRotationMatrix();
    const Eigen::Matrix3d inertia = axes * b.moments.asDiagonal() * axes.transpose();
    dMass mass;
    dMassSetParameters(&mass, b.mass, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2),
                       inertia(0, 1), inertia(0, 2), inertia(1, 2));
    const dBodyID body = dBodyCreate(world_);
    bodies_.push_back(body);
    dBodySetMass(body, &mass);
    const Pose at = scene().startOf(i);
    const dQuaternion q = {at.orientation.w(), at.orientation.x(), at.orientation.y(),
                           at.orientation.z()};
    dBodySetPosition(body, at.position.x(), at.position.y(), at.position.z());
    dBodySetQuaternion(body, q);
    if (!scene().floor) return;
    for (const int p : b.spheres) {
      const dGeomID sphere = dCreateSphere(space_, scene().radius[p]);
      const Vec3 offset = scene().rest.col(p) - b.com;
      dGeomSetBody(sphere, body);
      dGeomSetOffsetPosition(sphere, offset.x(), offset.y(), offset.z());
      dGeomSetCategoryBits(sphere, 1);
      dGeomSetCollideBits(sphere, 2);
    }
  }

  void addJoint(const test::RigidJoint& joint) {
    const Pose& start = scene().start;
    const Vec3 anchor = start.position + start.orientation * joint.anchor;
    const dBodyID child = bodies_[joint.child];
    const dBodyID parent = joint.parent < 0 ? nullptr : bodies_[joint.parent];
    if (joint.hinge) {
      const dJointID hinge = dJointCreateHinge(world_, nullptr);
      dJointAttach(hinge, child, parent);
      dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
      const Vec3 axis = start.orientation * joint.axis;
      dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
      if (joint.range) {
        dJointSetHingeParam(hinge, dParamLoStop, joint.range->begin);
        dJointSetHingeParam(hinge, dParamHiStop, joint.range->end);
      }
      return;
    }
    const dJointID ball = dJointCreateBall(world_, nullptr);
    dJointAttach(ball, child, parent);
    dJointSetBallAnchor(ball, anchor.x(), anchor.y(), anchor.z());
    if (!joint.half_angle) return;
    const dJointID motor = dJointCreateAMotor(world_, nullptr);
    dJointAttach(motor, child, parent);
    dJointSetAMotorMode(motor, dAMotorUser);
    dJointSetAMotorNumAxes(motor, 1);
    dJointSetAMotorParam(motor, dParamLoStop, -dInfinity);
    dJointSetAMotorParam(motor, dParamHiStop, *joint.half_angle);
    cones_.push_back({&joint, motor});
  }

  void turnMotor(const Cone& cone) const {
    const Vec3 axis = pose(cone.joint->parent).orientation * cone.joint->axis;
    const Vec3 bone = pose(cone.joint->child).orientation * cone.joint->bone;
    const Vec3 about = axis.cross(bone);
    if (about.norm() < 1e-9) return;
    const Vec3 n = about.normalized();
    dJointSetAMotorAxis(cone.motor, 0, 0, n.x(), n.y(), n.z());
    dJointSetAMotorAngle(cone.motor, 0, std::atan2(about.norm(), axis.dot(bone)));
  }

  static void collide(void* self, dGeomID a, dGeomID b) {
    const Ode& world = *static_cast<Ode*>(self);
    dContact contact[kMostContacts] = {};
    const int count = dCollide(a, b, kMostContacts, &contact[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      contact[i].surface.mode = dContactApprox1;
      contact[i].surface.mu = world.scene().friction;
      const dJointID joint = dJointCreateContact(world.world_, world.contacts_, &contact[i]);
      dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  double step_;
  bool quick_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dBodyID> bodies_;
  std::vector<Cone> cones_;
};

Engine engine(const std::string& name, bool quick) {
  const char* numbers = dCheckConfiguration("ODE_double_precision") == 1 ? "f64" : "f32";
  return {name, numbers, [quick](const Scene& scene, double step, bool limits, bool planar) {
            return std::make_unique<Ode>(scene, step, limits, planar, quick);
          }};
}

}  // namespace

std::vector<Engine> odeEngines() {
  return {engine("ODE step", false), engine("ODE quickstep", true)};
}

}  // namespace ragdoll::peers
