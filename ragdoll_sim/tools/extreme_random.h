// Scenes drawn at random for the stability matrix, the same on every machine.
#pragma once

#include <cstdint>

#include "extreme_tests.h"

namespace ragdoll::lab {

/// Random scene number `seed`: a human that is thrown, obstacles, a pin, a poke.
Extreme randomExtreme(std::uint32_t seed);

/// Random pile number `seed`: two to four bodies that are thrown at each other, obstacles, a pin, a
/// poke; steps of 30 to 240 Hz.
Extreme randomPile(std::uint32_t seed);

/// Random scene number `seed` in which obstacles and a pin are driven for two seconds, given step by
/// step at up to 6 m/s, and then stand: a human that is thrown among them; steps as of piles.
Extreme randomDriven(std::uint32_t seed);

}  // namespace ragdoll::lab
