// Runs of the golden list by models that are not shipped, and by starts that loading puts right.
#include "golden_scripts.h"

namespace ragdoll::golden {
namespace {

/// A lamp on a foot: a rigid group, a bone that a cone hangs on it, bones that hinges hang on that.
/// stretch: of the bones' lengths over what their positions say; least [deg]: of the elbow.
std::string lamp(double stretch, double least, const std::string& start) {
  const std::string length = std::to_string(0.4 * stretch);
  return "ragdolls:\n"
         "- name: lamp\n"
         "  model:\n"
         "    particles:\n"
         "      base: {position: [0, 0, 0], mass: 5, radius: 0.1}\n"
         "      base_side: {position: [0.1, 0, 0], mass: 1, radius: 0.1}\n"
         "      base_back: {position: [0, 0.1, 0], mass: 1, radius: 0.1}\n"
         "      elbow: {position: [0, 0, 0.4], radius: 0.02}\n"
         "      lamp: {position: [0, 0, 0.8], mass: 0.5, radius: 0.08}\n"
         "      bulb: {position: [0, 0, 1], mass: 0.2, radius: 0.03}\n"
         "    sticks: [[base, base_side], [base, base_back], [base_side, base_back],\n"
         "             [base, elbow, " +
         length + "], [elbow, lamp, " + length +
         "], [lamp, bulb]]\n"
         "    segments:\n"
         "      foot: {particles: [base, base_side, base_back]}\n"
         "      lower: {from: base, to: elbow, mass: 0.8, gyration: 0.289}\n"
         "      upper: {from: elbow, to: lamp, mass: 0.6, gyration: 0.289}\n"
         "      shade: {from: lamp, to: bulb}\n"
         "    joints:\n"
         "      foot: {type: cone, parent: foot, child: lower, axis: [0, 0, 1], half_angle_deg: "
         "60}\n"
         "      elbow: {type: hinge, parent: lower, child: upper, axis: [0, 1, 0],\n"
         "              range_deg: [" +
         std::to_string(least) +
         ", 150], twist_deg: 20}\n"
         "      shade: {type: cone, parent: upper, child: shade, axis: [0.1, 0, 1],\n"
         "              half_angle_deg: 40}\n"
         "  " +
         start + "\n";
}

/// Bones in a row without any group: nothing shows how they are turned about themselves.
const std::string kTail =
    "ragdolls:\n"
    "- name: tail\n"
    "  model:\n"
    "    particles:\n"
    "      a: {position: [0, 0, 0], mass: 1, radius: 0.05}\n"
    "      b: {position: [0.3, 0, 0], mass: 0.5, radius: 0.05}\n"
    "      c: {position: [0.6, 0, 0], mass: 0.5, radius: 0.04}\n"
    "      d: {position: [0.9, 0, 0], mass: 0.2, radius: 0.03}\n"
    "    sticks: [[a, b], [b, c], [c, d]]\n"
    "    segments: {ab: {from: a, to: b}, bc: {from: b, to: c}, cd: {from: c, to: d}}\n"
    "    joints:\n"
    "      b: {type: cone, parent: ab, child: bc, axis: [1, 0, 0], half_angle_deg: 50}\n"
    "      c: {type: hinge, parent: bc, child: cd, axis: [0, 1, 0], range_deg: [0, 70]}\n"
    "  position: [0, 0, 1]\n"
    "  angular_velocity: [0, 3, 2]\n";

const std::string kBalls =
    "ragdolls:\n"
    "- name: ball\n"
    "  model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.1}}}\n"
    "  count: 4\n"
    "  spacing: [0.21, 0.21, 0]\n"
    "  position: [0, 0, 1]\n"
    "  velocity: [1, 0.4, 0]\n";

}  // namespace

void addModels(Scripts& scripts) {
  const std::string falls = "position: [0, 0, 0.6]\n  rpy_deg: [30, 20, 0]\n  velocity: [0, 1, 0]";
  scripts.add("a lamp falls", 2, lamp(1, 0, falls) + kFloor);
  scripts.add("a lamp of longer bones than drawn", 1, lamp(1.02, 0, falls) + kFloor);
  scripts.add("a lamp drawn outside its limits", 1, lamp(1, 0.8, falls) + kFloor);
  scripts.add("a tail without a body", 2, kTail + kFloor);
  scripts.add("a tail that is held", 2, kTail + "pins: [a]\n", leadPins);
  scripts.add("balls", 2,
              kBalls +
                  "ragdoll_collision: true\n"
                  "obstacles: [{type: plane, restitution: 0.7},\n"
                  "            {type: box, position: [1, 0, 0.5], size: [0.2, 3, 1]}]\n",
              [](Run& run) {
                if (isTime(run, 1)) run.poke("ball_2/p", 0, Vec3(1e7, 0, 1e5));
              });
  scripts.add(
      "a knee is placed bent forwards", 1,
      human("position: [0, 0, 1.2], place: {right_foot: [0.153347, -0.0864, 0.254803]}") + kFloor);
  scripts.add(
      "hangs and sleeps, then its pin moves", 8,
      human("position: [0, 0, 2]") + "pins: [head]\nsolver: {damping: 5, joint_damping: 5}\n",
      [](Run& run) {
        run.inputs.pins.clear();
        const double moved = 0.2 * (timeAfter(run) - 7);
        if (moved > 0) run.inputs.pins = {run.model.pins[0].target + Vec3(moved, 0, 0)};
      });
}

}  // namespace ragdoll::golden
