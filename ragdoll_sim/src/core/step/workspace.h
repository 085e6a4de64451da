// Scratch of a step, sized by the first one. Private to the core: users hold it as Workspace.
#pragma once

#include <vector>

#include "core/contact/contact.h"
#include "core/contact/detect.h"
#include "core/contact/pair_detect.h"
#include "core/direct/shake_body.h"
#include "core/direct/shake_pairs.h"
#include "core/fast/fast.h"
#include "core/limits/limit_projection.h"
#include "core/relaxation/projection.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

struct Workspace::Impl {
  Points force;                       ///< [N] 3 x N of pokes
  bool forced = false;                ///< any poke this step
  std::vector<std::uint8_t> pressed;  ///< per ragdoll: an obstacle pressed on it in this step
  std::vector<BodyPair> pressing;     ///< bodies that pressed on each other
  Points x0, v0;                      ///< at the step's start, relaxation
  Points x1, v1;                      ///< after free motion
  Points acceleration;                ///< of one ragdoll
  std::vector<Contact> contacts;
  PairDetector pairs;
  LimitProjection limits;
  ContactProjection projection;

  // Direct methods.
  std::vector<SweptObstacle> obstacles;
  std::vector<ShakeBody> bodies;  ///< per ragdoll
  std::vector<int> first_stick;   ///< per ragdoll: its first multiplier in the state
  ShakeScratch shake;
  ShakePairs together;
  std::vector<Press> presses;  ///< of this step

  FastScratch fast;

  bool unguarded = false;  ///< the step guard is off: to measure what it costs, for nothing else
};

}  // namespace ragdoll
