// What a step of bodies that touch each other works with. Private to the core.
#pragma once

#include <cstdint>
#include <vector>

#include "core/direct/shake_body.h"
#include "core/linear/joint_schur.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// Scratch of islands: as many as the largest has bodies.
struct IslandScratch {
  std::vector<ShakeScratch> bodies;
  std::vector<Contact> pairs, missed, touching;  ///< between bodies; as of one body in ShakeScratch
  std::vector<int> row;                          ///< of each pair in the joint rows, or -1
  std::vector<std::uint8_t> forced;
  std::vector<double> warm;        ///< of touching pairs: impulses of the position stage
  std::vector<Press> known;        ///< between bodies, of the last motion
  std::vector<BodyPair> pressing;  ///< likewise
  JointSchur joint;
  Eigen::VectorXd b, p, total;
  std::vector<Eigen::VectorXd> parts;
};

}  // namespace ragdoll
