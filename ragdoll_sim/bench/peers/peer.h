// What the comparison asks of every engine, ours among them: step, and say where the body is.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"
#include "support/rigid_bodies.h"

namespace ragdoll::peers {

class Simulation {
 public:
  virtual ~Simulation() = default;
  virtual void step() = 0;
  /// Called before any of those below and never timed.
  virtual void settle() {}
  virtual Vec3 particle(int index) const = 0;  ///< [m] world
  virtual Vec3 centreOfMass() const = 0;       ///< [m] world
  virtual double energy() const = 0;           ///< [J] kinetic and of gravity
  virtual double speed() const = 0;            ///< [m/s] of the fastest particle
  virtual double gap() const = 0;              ///< [m] widest joint, or longest change of a stick
  virtual double penetration() const = 0;      ///< [m] of particles' spheres in the floor, >= 0
  virtual double limitViolation() const = 0;   ///< [rad] >= 0
  virtual int resets() const { return 0; }     ///< silent restarts
};

/// An engine with one of its ways to step.
struct Engine {
  std::string name;
  std::string numbers;  ///< "f32" or "f64"
  /// The first ragdoll of the scene at `step` [s]. Joints get limits if asked for; for a motion in
  /// the plane of x and z ball joints may be hinges about y.
  std::function<std::unique_ptr<Simulation>(const Scene& scene, double step, bool limits,
                                            bool planar)>
      make;
};

/// For engines of rigid bodies: all that follows from poses and velocities.
class RigidSimulation : public Simulation {
 public:
  RigidSimulation(const Scene& scene, bool limits, bool planar);
  Vec3 particle(int index) const override;
  Vec3 centreOfMass() const override;
  double energy() const override;
  double speed() const override;
  double gap() const override;
  double penetration() const override;
  double limitViolation() const override;

 protected:
  virtual Pose pose(int body) const = 0;
  /// Of the centre of mass [m/s] and angular [rad/s], world.
  virtual void velocity(int body, Vec3& angular, Vec3& linear) const = 0;
  const test::RigidScene& scene() const { return scene_; }

 private:
  test::RigidScene scene_;
};

/// [rad] by which a hinge has turned from rest.
double turnOf(const test::RigidJoint& joint, const Quat& parent, const Quat& child);

// Each in a file of its own, built where its library is.
std::vector<Engine> ragdollEngines();
std::vector<Engine> bulletEngines();
std::vector<Engine> odeEngines();
std::vector<Engine> mujocoEngines();

}  // namespace ragdoll::peers
