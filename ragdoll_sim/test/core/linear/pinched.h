// A stick between two contacts that all but contradict each other.
#pragma once

#include "core/linear/joint_schur.h"
#include "ragdoll_sim/core/build_model.h"
#include "support/worlds.h"

namespace ragdoll::test {

/// A stick whose end b lies on the floor, and which something presses down near that end.
class Pinched {
 public:
  Pinched(double nearness, double friction) : model_(buildModel(sceneOf(oneStick()))) {
    const StickRows& rows = *model_.systemOf(model_.ragdolls[0]).direct.rows;
    StickSolver sticks;
    sticks.resize(rows);
    const State state = startState(model_);
    sticks.setPose(rows, state.x.data());
    Contact floor, above;
    floor.particle = {1};
    floor.weight = {1};
    floor.count = 1;
    above.particle = {0, 1};
    above.weight = {nearness, 1 - nearness};
    above.count = 2;
    above.normal = -Vec3::UnitZ();
    floor.friction = above.friction = friction;
    schur.start(0);
    schur.addContact(floor, 0);
    schur.addContact(above, 1);
    schur.assemble(rows, sticks);
    joint.clear(false);
    joint.addBody(schur);
  }

  Schur schur;
  JointSchur joint;

 private:
  Model model_;
};

}  // namespace ragdoll::test
