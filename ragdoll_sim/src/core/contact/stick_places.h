// Where a stick touches one obstacle between its ends, and where that place was before a motion.
#pragma once

#include <array>
#include <optional>

#include "core/contact/axis.h"

namespace ragdoll {

/// Where it is nearest; or both ends of what of it is over a face, or along an edge, as far as that
/// may come into touch.
struct StickPlaces {
  std::array<double, 2> at;  ///< of the stick's length
  bool flat;                 ///< they are two
};

/// reach: [m] what is nearer may touch.
StickPlaces placesOf(const Axis& axis, const Compliance& give, double reach);

/// The place before the motion that place i has come from; nothing if there is none near it.
std::optional<double> placeBefore(const StickPlaces& before, const StickPlaces& now, int i);

}  // namespace ragdoll
