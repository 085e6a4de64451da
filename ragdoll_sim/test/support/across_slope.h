// A ball that slides across a slope: friction turns its way into the line of fall.
#pragma once

#include <cmath>

#include "support/integrate.h"
#include "support/worlds.h"

namespace ragdoll::test {

struct AcrossSlope {
  static constexpr double kAngle = 0.5, kFriction = 0.3, kRadius = 0.05, kG = 9.81;
  static constexpr double kSpeed = 2, kTime = 0.5;  ///< [m/s] at first, across; [s]

  /// On the plane from the start on.
  static Scene scene() {
    SkeletonSpec ball = oneParticle(1, kRadius);
    Scene scene = sceneOf(ball, kRadius * up());
    scene.gravity = Vec3(0, 0, -kG);
    ObstacleSpec plane = floorPlane(kFriction);
    plane.normal = up();
    scene.obstacles = {plane};
    scene.ragdolls[0].velocity = kSpeed * Vec3::UnitY();
    return scene;
  }

  /// Where it is at kTime, by an integration of two coordinates.
  static Vec3 end() {
    Eigen::Vector4d state(0, 0, 0, kSpeed);  // down, across; their rates
    const auto rate = [](const Eigen::Vector4d& s) {
      const Eigen::Vector2d v = s.tail<2>();
      const Eigen::Vector2d a = Eigen::Vector2d(kG * std::sin(kAngle), 0) -
                                kFriction * kG * std::cos(kAngle) * v.normalized();
      return Eigen::Vector4d(v.x(), v.y(), a.x(), a.y());
    };
    state = integrate(rate, state, kTime);
    const Vec3 fall(-std::cos(kAngle), 0, -std::sin(kAngle));
    return kRadius * up() + state[0] * fall + state[1] * Vec3::UnitY();
  }

 private:
  static Vec3 up() { return {-std::sin(kAngle), 0, std::cos(kAngle)}; }
};

}  // namespace ragdoll::test
