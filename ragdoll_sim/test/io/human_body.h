// A shipped human against de Leva's table 4 (males), written down in the tests a second time.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::test {

constexpr double kScale = 1.75 / 1.741;  ///< statures
constexpr double kMass = 75;             ///< [kg]
constexpr double kDigits = 1e-4;         ///< [m], [kg] the file's last digit

struct HumanBody {
  explicit HumanBody(const std::string& name)
      : model(buildModel(parseScene("ragdolls: [{model: " + name + "}]"))) {}

  Vec3 at(const std::string& particle) const {
    return skeleton.rest.col(skeleton.particle(particle));
  }
  double length(const std::string& a, const std::string& b) const { return (at(a) - at(b)).norm(); }
  double mass(const std::string& particle) const {
    return skeleton.M(skeleton.particle(particle), skeleton.particle(particle));
  }

  const Model model;
  const Skeleton& skeleton = model.skeletons[0];
};

/// Height of the centre of mass over the hip joint centres, from the table's segments alone; trunk:
/// its part of it, arm_slope: cosine of the arms' angle to the vertical.
inline double expectedHeight(double trunk, double arm_slope) {
  const double head = 0.0694 * (0.6033 + (1 - 0.5002) * 0.2429);
  const double arm = (0.0271 + 0.0162 + 0.0061) * 0.5155 -
                     arm_slope * (0.0271 * 0.5772 * 0.2817 + 0.0162 * (0.2817 + 0.4574 * 0.2689) +
                                  0.0061 * (0.2817 + 0.2689 + 0.79 * 0.0862));
  const double foot_below_ankle = 0.035 / kScale;
  const double leg = 0.1416 * 0.4095 * 0.4222 + 0.0433 * (0.4222 + 0.4395 * 0.4403) +
                     0.0137 * (0.4222 + 0.4403 + foot_below_ankle);
  return kScale * (trunk + head + 2 * arm - 2 * leg);
}

}  // namespace ragdoll::test
