// Memory of the relaxation, sized by the first step.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/contact/detect.h"
#include "core/contact/pair_detect.h"
#include "core/limits/limit_projection.h"
#include "core/mechanics/energy_gain.h"
#include "core/mechanics/energy_removal.h"
#include "core/relaxation/projection.h"

namespace ragdoll {

struct RelaxationWorkspace {
  Points x0, v0;        ///< at the step's start
  Points x1, v1;        ///< after free motion
  Points acceleration;  ///< of one ragdoll
  Roomy<Contact> contacts;
  PairDetector pairs;
  LimitProjection limits;
  ContactProjection projection;
  // Of its guard.
  Points moved, force;
  EnergyScratch energy;
  RemovalScratch removal;
  Roomy<Contact> passed;
  std::vector<SweptObstacle> obstacles;
  Roomy<int> bodies;
};

}  // namespace ragdoll
