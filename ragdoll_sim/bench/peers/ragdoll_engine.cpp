// Ours: particles and sticks, by every method that has a place here.
#include <algorithm>
#include <cmath>

#include "peer.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/step.h"
#include "support/worlds.h"

namespace ragdoll::peers {
namespace {

class Ours : public Simulation {
 public:
  explicit Ours(const Scene& scene) : world_(scene) {}

  void step() override { world_.steps(1); }
  Vec3 particle(int index) const override { return world_.x(index); }
  Vec3 centreOfMass() const override {
    return ragdoll::centreOfMass(world_.model, world_.state, 0);
  }
  double energy() const override {
    return kineticEnergy(world_.model, world_.state) + potentialEnergy(world_.model, world_.state);
  }
  double speed() const override { return world_.state.v.colwise().norm().maxCoeff(); }
  double gap() const override {
    double worst = 0;
    for (const Stick& s : world_.model.skeletons[0].sticks)
      worst = std::max(worst, std::abs((world_.x(s.b) - world_.x(s.a)).norm() - s.length));
    return worst;
  }
  double penetration() const override { return maxPenetration(world_.model, world_.state); }
  double limitViolation() const override { return maxLimitViolation(world_.model, world_.state); }

 private:
  test::World world_;
};

Engine engine(const std::string& name, Method method, int sweeps) {
  return {name, "f64", [=](Scene scene, double step, bool limits, bool) {
            scene.solver.method = method;
            scene.solver.sweeps = sweeps;
            scene.solver.step = step;
            scene.solver.sleep = false;
            if (!limits) {
              auto skeleton = std::make_shared<SkeletonSpec>(*scene.ragdolls[0].skeleton);
              skeleton->joints.clear();
              scene.ragdolls[0].skeleton = skeleton;
            }
            return std::make_unique<Ours>(scene);
          }};
}

}  // namespace

std::vector<Engine> ragdollEngines() {
  return {engine("ours, jakobsen 10", Method::kJakobsen, 10),
          engine("ours, shake", Method::kShake, 10), engine("ours, rk", Method::kRk, 10),
          engine("ours, fast", Method::kFast, 10)};
}

}  // namespace ragdoll::peers
