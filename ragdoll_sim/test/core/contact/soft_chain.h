// A body whose sticks share the springs of their ends.
#pragma once

#include "support/direct_island.h"

namespace ragdoll::test {

/// Three particles that two sticks join, and a box of 2000 N/m and 12 N s/m.
inline Scene chainOnASoftBox() {
  Scene scene = sceneOf(chainOfThree());
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.contact.stiffness = 2000;
  box.contact.damping = 12;
  scene.obstacles = {box};
  return scene;
}

}  // namespace ragdoll::test
