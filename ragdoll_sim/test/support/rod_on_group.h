// A rod of 2 kg on a rigid group that pins hold: its joint allows a region about the group's axis
// y.
#pragma once

#include <string>

namespace ragdoll::test {

/// The scene's ragdoll `r` and pins. end: "[x, y, z]" [m], the rod's from the origin on; region:
/// "[first, last]" [deg].
inline std::string rodOnGroup(const std::string& end, const std::string& region) {
  return R"(
ragdolls:
  - name: r
    model:
      name: rod
      particles:
        a: {position: [0, 0, 0], mass: 1}
        b: {position: [0.3, 0, 0], mass: 1}
        c: {position: [0, 0.3, 0], mass: 1}
        d: {position: [0, 0, 0.3], mass: 1}
        e: {position: )" +
         end + R"(}
      sticks: [[a, b], [a, c], [b, c], [a, d], [b, d], [c, d], [a, e]]
      segments:
        trunk: {particles: [a, b, c, d]}
        rod: {from: a, to: e, mass: 2, gyration: 0.289}
      joints:
        j: {type: planes, parent: trunk, child: rod, yz_deg: )" +
         region + R"(}
pins: [r/a, r/b, r/c]
)";
}

}  // namespace ragdoll::test
