// What a step of bodies comes to beside the state: kept apart where they are stepped apart, and put
// together in the order of the bodies, whoever was ready first.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/mechanics/supports.h"
#include "ragdoll_sim/core/contact_log.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

struct Outcome {
  Roomy<CachedImpulse> impulses;
  Roomy<BodyPair> pressing;
  StepReport report;
  ContactLog log;  ///< if anyone asks

  void clear() {
    impulses.clear();
    pressing.clear();
    report = StepReport();
    log.impulses.clear();
  }
};

}  // namespace ragdoll
