#include "other_start.h"

#include <random>

namespace ragdoll::lab {
namespace {

constexpr double kOtherSpeed = 0.5;  ///< [m/s]
constexpr double kOtherSpin = 1;     ///< [rad/s]

/// Each in [-1, 1], the same on every machine.
Vec3 anyVector(std::mt19937& random) {
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = random() / 2147483648.0 - 1;
  return v;
}

}  // namespace

Scene withOtherStart(Scene scene, unsigned seed) {
  std::mt19937 random(seed);
  for (RagdollSpec& ragdoll : scene.ragdolls) {
    ragdoll.velocity += kOtherSpeed * anyVector(random);
    ragdoll.angular_velocity += kOtherSpin * anyVector(random);
  }
  return scene;
}

}  // namespace ragdoll::lab
