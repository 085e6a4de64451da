// What several rooms are tuned by; direct/constants.h says how these files are to be read.
#pragma once

namespace ragdoll {

/// Of a length: what is shorter has no direction and no angle, and is at a stick's end.
constexpr double kNoLength = 0.02;

}  // namespace ragdoll
