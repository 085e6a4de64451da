// Scratch of a step, sized by the first one. Private to the core: users hold it as Workspace.
#pragma once

#include "core/direct/workspace.h"
#include "core/fast/fast.h"
#include "core/mechanics/supports.h"
#include "core/relaxation/workspace.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

struct Workspace::Impl {
  Points force;       ///< [N] 3 x N of pokes
  Supports supports;  ///< of this step
  RelaxationWorkspace relaxation;
  DirectWorkspace direct;
  FastScratch fast;
  ContactLog* log = nullptr;
  std::vector<std::uint8_t> unlogged;  ///< ragdolls that a method without a log has moved
  PressedBefore before;                ///< of the step, where the method has no log
  bool guarded = true;  ///< false: the step guard is off
};

}  // namespace ragdoll
