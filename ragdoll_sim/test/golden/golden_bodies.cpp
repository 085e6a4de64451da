// Runs of the golden list that differ in bodies and in how they start.
#include <memory>

#include "golden_scripts.h"

namespace ragdoll::golden {
namespace {

/// All joints give: springs that only push.
void soften(Scene& scene, double stiffness, double damping) {
  for (RagdollSpec& ragdoll : scene.ragdolls) {
    auto own = std::make_shared<SkeletonSpec>(*ragdoll.skeleton);
    for (JointSpec& joint : own->joints) {
      joint.stiffness = stiffness;
      joint.damping = damping;
    }
    ragdoll.skeleton = own;
  }
}

void addSleep(Scripts& scripts) {
  scripts.add(
      "sleeps and is woken", 7,
      human("position: [0, 0, 0.2], rpy_deg: [0, -90, 0]") +
          "obstacles: [{type: plane}, {type: box, position: [3, 0, 0.5], size: [0.2, 2, 1]}]\n"
          "solver: {joint_damping: 5}\n",
      [](Run& run) {
        if (isTime(run, 4)) run.poke("left_hand", 0.1, Vec3(0, 0, 60));
        run.inputs.obstacles.clear();
        if (run.state.time < 6) return;
        run.inputs.obstacles = run.state.obstacles;
        run.inputs.obstacles[1].position.x() = 3 - 2.5 * (timeAfter(run) - 6);
      });
  scripts.add(
      "one falls on one that sleeps", 3,
      "ragdolls: [{name: low, model: human, position: [0, 0, 0.13], rpy_deg: [0, -90, 0]},\n"
      "           {name: high, model: human, position: [0.3, 0, 14], rpy_deg: [0, 80, 20]}]\n"
      "ragdoll_collision: true\nsolver: {joint_damping: 8}\n" +
          kFloor);
}

void addTouching(Scripts& scripts) {
  scripts.add(
      "bodies of every model on each other", 1.2,
      "ragdolls: [{name: a, model: human, position: [0, 0, 0.3], rpy_deg: [0, -90, 0]},\n"
      "           {name: b, model: human_lumped, position: [0.2, 0.1, 0.9], rpy_deg: [0, 80, "
      "30]},\n"
      "           {name: c, model: human_thesis, position: [0, -0.2, 1.5], rpy_deg: [90, 0, 60]},\n"
      "           {name: d, model: human, position: [4, 0, 0.5], rpy_deg: [0, 80, 0]}]\n"
      "ragdoll_collision: true\nself_collision: true\n" +
          kFloor,
      [](Run& run) {
        if (isTime(run, 1)) run.poke("c/torso", 0.1, Vec3(800, 0, 0), Vec3(0, 0.1, 0));
      });
  scripts.add("two that are held run into each other", 2,
              "ragdolls: [{name: a, model: human, position: [0, 0, 2], velocity: [2, 0, 0]},\n"
              "           {name: b, model: human, position: [1, 0.1, 2], velocity: [-2, 0, 0]}]\n"
              "pins: [a/head, b/right_hand]\nragdoll_collision: true\n",
              leadPins);
  scripts.add("folds onto itself", 2,
              human("position: [0, 0, 0.8], rpy_deg: [0, 100, 20], velocity: [0, 0, -6]") +
                  "self_collision: true\n" + kFloor,
              [](Run& run) {
                if (isTime(run, 0.3)) run.poke("left_hand", 0.2, Vec3(0, -300, 0));
                if (isTime(run, 0.3)) run.poke("right_foot", 0.2, Vec3(0, 400, 100));
              });
  scripts.add(
      "impact of one at another", 1.5,
      "ragdolls: [{name: a, model: human, position: [0, 0, 1.2]},\n"
      "           {name: b, model: human, position: [0.4, 0, 1.2], velocity: [-30, 0, 0]}]\n"
      "ragdoll_collision: true\nself_collision: true\n" +
          kFloor,
      [](Run& run) {
        if (isTime(run, 0.2)) run.poke("a/right_hand", 0, Vec3(1e6, 0, 0));
      });
}

void addLimits(Scripts& scripts) {
  const std::string falls = "position: [0, 0, 1.6], rpy_deg: [10, 40, 0]";
  for (const char* model : {"human_lumped", "human_thesis"})
    scripts.add(std::string("falls, ") + model, 2,
                human(falls, model) +
                    "self_collision: true\nsolver: {damping: 0.5, joint_damping: 1}\n" + kFloor);
  for (const char* model : {"human", "human_thesis"}) {
    scripts.add(std::string("soft joints, ") + model, 1.5, human(falls, model) + kFloor, {},
                [](Scene& scene) { soften(scene, 50, 2); });
  }
  scripts.add("stiff joints without damping", 1.5, human(falls) + kFloor, {},
              [](Scene& scene) { soften(scene, 1e5, 0); });
}

void addStarts(Scripts& scripts) {
  const std::string place = ", place: {right_hand: [0.4, 0, 1.6], left_hand: [0.4, 0, 1.6]";
  scripts.add("hands start at one place", 1.5,
              human("position: [0, 0, 1.2]" + place + "}") + kFloor);
  scripts.add("a foot starts far away", 1.5,
              human("position: [0, 0, 1.2]" + place + ", left_foot: [30, 3, 1]}") +
                  "self_collision: true\n" + kFloor);
  scripts.add(
      "two start in each other", 0.05,
      "ragdolls: [{name: a, model: human, position: [0, 0, 0.9], rpy_deg: [0, 60, 0]},\n"
      "           {name: b, model: human, position: [0.2, 0.15, 1], rpy_deg: [0, 60, 40]}]\n"
      "ragdoll_collision: true\nself_collision: true\n" +
          kFloor);
  scripts.add(
      "lies across a box, half in it", 1.5,
      human(kLies) +
          "obstacles: [{type: plane}, {type: box, position: [0, 0, 0.3], size: [0.1, 2, 0.6]}]\n");
}

}  // namespace

void addBodies(Scripts& scripts) {
  addSleep(scripts);
  addTouching(scripts);
  addLimits(scripts);
  addStarts(scripts);
}

}  // namespace ragdoll::golden
