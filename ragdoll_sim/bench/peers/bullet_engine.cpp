// Bullet: rigid bodies in maximal coordinates, joints and contacts by sequential impulses with its
// default of 10 iterations.
#include <btBulletDynamicsCommon.h>

#include <cmath>

#include "peer.h"

namespace ragdoll::peers {
namespace {

constexpr int kBody = 1, kFloor = 2;  ///< collision groups

btVector3 toBullet(const Vec3& v) {
  return btVector3(static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()),
                   static_cast<btScalar>(v.z()));
}
btQuaternion toBullet(const Quat& q) {
  return btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                      static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w()));
}
Vec3 fromBullet(const btVector3& v) { return Vec3(v.x(), v.y(), v.z()); }

class Bullet : public RigidSimulation {
 public:
  Bullet(const Scene& scene, double step, bool limits, bool planar)
      : RigidSimulation(scene, limits, planar),
        step_(step),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(toBullet(this->scene().gravity));
    for (int i = 0; i < static_cast<int>(this->scene().bodies.size()); ++i) addBody(i);
    for (const test::RigidJoint& joint : this->scene().joints) addJoint(joint);
    if (!this->scene().floor) return;
    shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)));
    floor_ = std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(0, nullptr, shapes_.back().get()));
    floor_->setFriction(1);  // factors of the two are multiplied
    world_.addRigidBody(floor_.get(), kFloor, kBody);
  }
  ~Bullet() override {
    for (const auto& joint : joints_) world_.removeConstraint(joint.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    if (floor_) world_.removeRigidBody(floor_.get());
  }

  void step() override { world_.stepSimulation(static_cast<btScalar>(step_), 0); }

 protected:
  Pose pose(int body) const override {
    const btTransform& at = bodies_[body]->getWorldTransform();
    const btQuaternion q = at.getRotation();
    const Quat principal(q.w(), q.x(), q.y(), q.z());
    return {fromBullet(at.getOrigin()), principal * scene().bodies[body].axes.conjugate()};
  }
  void velocity(int body, Vec3& angular, Vec3& linear) const override {
    angular = fromBullet(bodies_[body]->getAngularVelocity());
    linear = fromBullet(bodies_[body]->getLinearVelocity());
  }

 private:
  /// A frame of the model's, seen from the body, whose own axes are the principal ones.
  btTransform seenFrom(int body, const Vec3& point, const Quat& axes) const {
    const test::RigidBody& b = scene().bodies[body];
    const Quat inverse = b.axes.conjugate();
    return btTransform(toBullet(Quat(inverse * axes)), toBullet(Vec3(inverse * (point - b.com))));
  }

  void addBody(int i) {
    const test::RigidBody& b = scene().bodies[i];
    auto compound = std::make_unique<btCompoundShape>();
    for (const int p : b.spheres) {
      shapes_.push_back(std::make_unique<btSphereShape>(
          static_cast<btScalar>(std::max(1e-3, scene().radius[p]))));
      compound->addChildShape(seenFrom(i, scene().rest.col(p), Quat::Identity()),
                              shapes_.back().get());
    }
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(b.mass), nullptr,
                                                  compound.get(), toBullet(b.moments));
    const Pose at = scene().startOf(i);
    info.m_startWorldTransform =
        btTransform(toBullet(Quat(at.orientation * b.axes)), toBullet(at.position));
    info.m_friction = static_cast<btScalar>(scene().friction);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get(), kBody, scene().floor ? kFloor : 0);
    shapes_.push_back(std::move(compound));
  }

  void addJoint(const test::RigidJoint& joint) {
    btRigidBody& child = *bodies_[joint.child];
    btRigidBody& fixed = btTypedConstraint::getFixedBody();
    btRigidBody& parent = joint.parent < 0 ? fixed : *bodies_[joint.parent];
    const auto inParent = [&](const Quat& axes) {
      if (joint.parent >= 0) return seenFrom(joint.parent, joint.anchor, axes);
      const Pose& start = scene().start;
      return btTransform(toBullet(Quat(start.orientation * axes)),
                         toBullet(Vec3(start.position + start.orientation * joint.anchor)));
    };
    if (joint.hinge) {  // about z of its frames
      const Quat axes = Quat::FromTwoVectors(Vec3::UnitZ(), joint.axis);
      auto hinge = std::make_unique<btHingeConstraint>(parent, child, inParent(axes),
                                                       seenFrom(joint.child, joint.anchor, axes));
      if (joint.range)  // Bullet counts a hinge's angle the other way round
        hinge->setLimit(static_cast<btScalar>(-joint.range->end),
                        static_cast<btScalar>(-joint.range->begin));
      joints_.push_back(std::move(hinge));
    } else if (joint.half_angle) {  // about x of its frames
      const Quat axes = Quat::FromTwoVectors(Vec3::UnitX(), joint.axis);
      const Quat swung = Quat::FromTwoVectors(joint.axis, joint.bone) * axes;
      auto cone = std::make_unique<btConeTwistConstraint>(
          parent, child, inParent(axes), seenFrom(joint.child, joint.anchor, swung));
      const btScalar half = static_cast<btScalar>(*joint.half_angle);
      cone->setLimit(half, half, SIMD_PI);
      joints_.push_back(std::move(cone));
    } else {
      joints_.push_back(std::make_unique<btPoint2PointConstraint>(
          parent, child, inParent(Quat::Identity()).getOrigin(),
          seenFrom(joint.child, joint.anchor, Quat::Identity()).getOrigin()));
    }
    world_.addConstraint(joints_.back().get());
  }

  double step_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::unique_ptr<btRigidBody> floor_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};

}  // namespace

std::vector<Engine> bulletEngines() {
  return {{"Bullet", sizeof(btScalar) == 4 ? "f32" : "f64",
           [](const Scene& scene, double step, bool limits, bool planar) {
             return std::make_unique<Bullet>(scene, step, limits, planar);
           }}};
}

}  // namespace ragdoll::peers
