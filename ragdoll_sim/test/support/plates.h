// Flat rigid parts that land on more places than hold them.
#pragma once

#include <string>

#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::test {

/// The model of a plate, and the end of its ragdoll.
inline const std::string kFlatPlate = R"(
     model: {sticks: [[p, q], [q, r], [r, s], [s, p], [p, r], [q, s]],
       segments: {plate: {particles: [p, q, r, s]}},
       particles: {p: {position: [-0.2, -0.15, 0], mass: 1, radius: 0.04},
         q: {position: [0.2, -0.15, 0], mass: 1.2, radius: 0.04},
         r: {position: [0.2, 0.15, 0], mass: 0.8, radius: 0.04},
         s: {position: [-0.2, 0.15, 0], mass: 1.1, radius: 0.04}}}}
)";

/// A plate with an arm that lands flat across an edge of a box.
inline Scene plateAcrossAnEdge() {
  return parseScene(R"(
ragdolls:
  - {position: [-0.0797827, -0.0292798, 0.3], rpy_deg: [1.89723, 1.39044, 85.2011],
     velocity: [0.507992, 0.911313, -1.16961], angular_velocity: [0.110258, -0.157924, -0.254578],
     model: {sticks: [[p, q], [q, r], [r, s], [s, p], [p, r], [q, s], [r, t], [t, w]],
       segments: {plate: {particles: [p, q, r, s]}, arm: {from: r, to: t}, fore: {from: t, to: w}},
       particles: {p: {position: [-0.2, -0.15, 0], mass: 1, radius: 0.04},
         q: {position: [0.2, -0.15, 0], mass: 1.2, radius: 0.04},
         r: {position: [0.2, 0.15, 0], mass: 0.8, radius: 0.04},
         s: {position: [-0.2, 0.15, 0], mass: 1.1, radius: 0.04},
         t: {position: [0.45, 0.2, 0.02], mass: 0.5, radius: 0.03},
         w: {position: [0.7, 0.2, 0.1], mass: 0.4, radius: 0.03}}}}
obstacles:
  - {type: box, position: [0, 0, 0.1], size: [0.161931, 1, 0.2], friction: 0.615334, restitution: 0.1}
  - {type: plane, friction: 0.5}
  - {type: capsule, from: [0.5, -0.4, 0.1], to: [0.5, 0.4, 0.1], radius: 0.05, friction: 0.4}
)");
}

/// A plate that falls onto a capsule: one place touches, it turns about that, and three strike at
/// once.
inline Scene plateOnACapsule() {
  return parseScene(
      R"(
ragdolls:
  - {position: [-0.0263911, -0.0211946, 0.45], rpy_deg: [9.98081, -5.93002, -22.3125],
     velocity: [-0.499886, 0.259534, -1], angular_velocity: [0.440649, 0.99437, -0.165956],
)" + kFlatPlate +
      R"(obstacles: [{type: capsule, from: [-1, 0, 0.2], to: [1, 0.1, 0.25], radius: 0.1, friction: 0.5}]
)");
}

/// A plate that falls onto another body's rod, which lies on the floor.
inline Scene plateOnARod() {
  return parseScene(
      R"(
ragdoll_collision: true
ragdolls:
  - {name: plate, position: [-0.0155298, -0.0534543, 0.25], rpy_deg: [12.6585, 1.23423, -44.0939],
     velocity: [0.369195, -0.26056, -1], angular_velocity: [1.87416, -1.95554, 1.49372],
)" + kFlatPlate +
      R"(  - {name: rod, position: [0, 0, 0.05], model: {sticks: [[m, n]], segments: {bar: {from: m, to: n}},
       particles: {m: {position: [0, -0.6, 0], mass: 3, radius: 0.05},
         n: {position: [0, 0.6, 0], mass: 3, radius: 0.05}}}}
obstacles: [{type: plane, friction: 0.5}]
)");
}

}  // namespace ragdoll::test
