// Bodies that touch bodies, direct methods.
//
// Bodies that meet in a step, or pressed on each other in the last one, make an island and take the
// step together (shake_island.h); all others take it alone. Who meets is found on the way to where
// each would go by itself; what islands push together beyond that makes larger islands, which take
// the step anew.
#pragma once

#include <vector>

#include "core/contact/contact.h"
#include "core/direct/island_scratch.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

struct ShakePairs {
  Points x0, v0;
  std::vector<double> multipliers0;
  std::vector<Contact> found;
  std::vector<int> head;  ///< per ragdoll: of its island, by way of others
  struct Own {
    std::vector<int> island;     ///< bodies that it took the step with; empty: none yet
    std::vector<int> sleepers;   ///< that it came near
    std::vector<int> took;       ///< island's first: sleepers that it took the step with
    std::vector<Press> presses;  ///< island's first: of all its bodies
    std::vector<BodyPair> pressing;
    StepReport report;
  };
  std::vector<Own> own;  ///< per ragdoll
  IslandScratch island;
};

/// As a step of every awake body in turn, and keeps them apart.
void stepTogether(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                  State& state, StepReport& report);

}  // namespace ragdoll
