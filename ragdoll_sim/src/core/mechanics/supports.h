// What bodies lie on in a step: who may fall asleep (sleep.h) and whose energy is whose.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"

namespace ragdoll {

struct Supports {
  std::vector<std::uint8_t> pressed;  ///< per ragdoll: an obstacle pressed on it
  Roomy<BodyPair> pressing;           ///< bodies that pressed on each other
  std::vector<std::uint8_t> gripped;  ///< per ragdoll: by an obstacle that its friction holds it on
};

/// Whether a contact that presses by `normal` sticks: `friction`, the tangential part, is inside
/// the cone and not at its border, where what slides is.
inline bool isInsideCone(double coefficient, double normal, double friction) {
  constexpr double kBorder = 1e-6;  ///< of the cone's radius
  return normal > 0 && friction < (1 - kBorder) * coefficient * normal;
}

}  // namespace ragdoll
