// Two rods with segment inertia, hinged together and hung up: as a scene, and as a Lagrangian in
// the two angles that is integrated apart from the product's code. Motion in the plane of x and z.
#pragma once

#include <array>
#include <cmath>

#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll::test::double_pendulum {

struct Rod {
  double length, mass;   ///< [m], [kg]
  double com, gyration;  ///< fractions of the length
};

constexpr Rod kUpper{0.45, 2.0, 0.43, 0.31}, kLower{0.55, 1.3, 0.52, 0.27};
constexpr double kStart[2] = {1.9, 0.6};  ///< [rad] from hanging
constexpr double kSeconds = 1;

using Angles = std::array<double, 4>;  ///< angles from hanging and their rates

/// With A, C the moments of inertia about the joints (the upper carries the lower's mass at its
/// end), B the coupling and P, Q the weights' moments, D = a - b:
///   A a'' + B cos D b'' = -B sin D b'^2 - P sin a
///   B cos D a'' + C b'' =  B sin D a'^2 - Q sin b
inline Angles rates(const Angles& s) {
  const double L = kUpper.length, c = kLower.com * kLower.length;
  const double A =
      L * L *
      (kUpper.mass * (std::pow(kUpper.com, 2) + std::pow(kUpper.gyration, 2)) + kLower.mass);
  const double C = kLower.mass * (c * c + std::pow(kLower.gyration * kLower.length, 2));
  const double B = kLower.mass * L * c;
  const double P = (kUpper.mass * kUpper.com + kLower.mass) * L * kG, Q = kLower.mass * c * kG;
  const double co = std::cos(s[0] - s[1]), si = std::sin(s[0] - s[1]);
  const double f = -B * si * s[3] * s[3] - P * std::sin(s[0]);
  const double g = B * si * s[2] * s[2] - Q * std::sin(s[1]);
  const double det = A * C - B * B * co * co;
  return {s[2], s[3], (C * f - B * co * g) / det, (A * g - B * co * f) / det};
}

/// The free end after kSeconds from rest, by the classic Runge-Kutta method.
inline Vec3 tipByLagrangian(int steps) {
  Angles s{kStart[0], kStart[1], 0, 0};
  const double h = kSeconds / steps;
  const auto at = [&](const Angles& k, double share) {
    Angles out = s;
    for (int i = 0; i < 4; ++i) out[i] += share * h * k[i];
    return out;
  };
  for (int n = 0; n < steps; ++n) {
    const Angles k1 = rates(s), k2 = rates(at(k1, 0.5)), k3 = rates(at(k2, 0.5)),
                 k4 = rates(at(k3, 1));
    for (int i = 0; i < 4; ++i) s[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  }
  return kUpper.length * Vec3(std::sin(s[0]), 0, -std::cos(s[0])) +
         kLower.length * Vec3(std::sin(s[1]), 0, -std::cos(s[1]));
}

/// Rods, or (lumped) masses at their ends with the same centres of mass.
inline Scene pendulum(Method method, double step, bool lumped = false) {
  const Vec3 middle = kUpper.length * Vec3(std::sin(kStart[0]), 0, -std::cos(kStart[0]));
  const Vec3 tip = middle + kLower.length * Vec3(std::sin(kStart[1]), 0, -std::cos(kStart[1]));
  SkeletonSpec s;
  s.name = "pendulum";
  s.particles = {particle("top", Vec3::Zero(), 0), particle("middle", middle, 0),
                 particle("tip", tip, 0)};
  s.sticks = {stick("top", "middle"), stick("middle", "tip")};
  s.segments = {bone("upper", "top", "middle"), bone("lower", "middle", "tip")};
  for (int i = 0; i < 2; ++i) {
    const Rod& rod = i == 0 ? kUpper : kLower;
    if (lumped) {
      s.particles[i].mass += rod.mass * (1 - rod.com);
      s.particles[i + 1].mass += rod.mass * rod.com;
    } else {
      s.segments[i].mass = rod.mass;
      s.segments[i].com = rod.com;
      s.segments[i].gyration = rod.gyration;
    }
  }
  Scene scene = sceneOf(s);
  scene.pins = {pinOf("top")};
  scene.solver.method = method;
  scene.solver.step = step;
  return scene;
}

}  // namespace ragdoll::test::double_pendulum
