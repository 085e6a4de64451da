// MuJoCo: joint coordinates, so that joints cannot open; soft contacts and limits.
#include "peer.h"
#include "support/mujoco_simulation.h"

namespace ragdoll::peers {
namespace {

class Mujoco : public RigidSimulation {
 public:
  Mujoco(const Scene& scene, double step, bool limits, bool planar, const char* integrator)
      : RigidSimulation(scene, limits, planar), world_(this->scene(), step, integrator) {}

  void step() override { world_.step(); }
  void settle() override { world_.settle(); }
  int resets() const override { return world_.resets(); }

 protected:
  Pose pose(int body) const override { return world_.pose(body); }
  void velocity(int body, Vec3& angular, Vec3& linear) const override {
    world_.velocity(body, angular, linear);
  }

 private:
  test::MujocoSimulation world_;
};

Engine engine(const std::string& name, const char* integrator) {
  return {name, "f64", [integrator](const Scene& scene, double step, bool limits, bool planar) {
            return std::make_unique<Mujoco>(scene, step, limits, planar, integrator);
          }};
}

}  // namespace

std::vector<Engine> mujocoEngines() {
  return {engine("MuJoCo Euler", "Euler"), engine("MuJoCo RK4", "RK4")};
}

}  // namespace ragdoll::peers
