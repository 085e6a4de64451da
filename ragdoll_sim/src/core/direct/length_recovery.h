// Sticks that are far from their lengths: particles placed apart, or held too far apart by pins.
// They are drawn towards their lengths by positions alone, so that speeds do not rise.
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

/// Before a step of h. Where it draws sticks in, they keep in this step the lengths that they then
/// have (body.lengths). Whether there was anything to draw in.
bool restoreLengths(Body& body, double h);

}  // namespace ragdoll
