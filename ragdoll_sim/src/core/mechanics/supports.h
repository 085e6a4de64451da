// What bodies lie on in a step: who may fall asleep (sleep.h) and whose energy is whose.
#pragma once

#include <cstdint>
#include <vector>

#include "core/contact/contact.h"

namespace ragdoll {

struct Supports {
  std::vector<std::uint8_t> pressed;  ///< per ragdoll: an obstacle pressed on it
  std::vector<BodyPair> pressing;     ///< bodies that pressed on each other
};

}  // namespace ragdoll
