// Runs of the golden list in which somebody does something.
#include <cmath>
#include <limits>
#include <memory>

#include "golden_cases.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::golden {
namespace {

const std::string kLies = "position: [0, 0, 0.3], rpy_deg: [0, -90, 0]";
const std::string kFloor = "obstacles: [{type: plane}]\n";

std::string human(const std::string& start, const std::string& model = "human") {
  return "ragdolls: [{name: ragdoll, model: " + model + ", " + start + "}]\n";
}

/// [s] The end of the step that comes.
double timeAfter(const Run& run) { return run.state.time + run.model.solver.step; }

/// Whether the step that comes is the first at or after `time` [s].
bool isTime(const Run& run, double time) {
  const double half = 0.5 * run.model.solver.step;
  return run.state.time > time - half && run.state.time < time + half;
}

Vec3 circle(double radius, double angle) {
  return Vec3(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0);
}

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

/// Adds a run by each kind of method.
class Scripts {
 public:
  explicit Scripts(std::vector<Case>& cases) : cases_(cases) {}

  void add(const std::string& name, double seconds, const std::string& text,
           const Script& script = {}, const std::function<void(Scene&)>& change = {}) {
    SolverSpec rk = preset("reference");
    rk.step = 1.0 / 240;
    SolverSpec adaptive = rk;
    adaptive.step = 1.0 / 60;
    adaptive.tolerance = 1e-3;
    const std::pair<const char*, SolverSpec> methods[] = {{"shake", preset("balanced")},
                                                          {"rk", rk},
                                                          {"adaptive rk", adaptive},
                                                          {"jakobsen", preset("thesis")}};
    for (const auto& [method, solver] : methods)
      cases_.push_back({"scripted", "scripted: " + name + ", " + method, [=, solver = solver] {
                          Scene scene = parseScene(text, "golden");
                          const double damping = scene.solver.damping;
                          const double joint_damping = scene.solver.joint_damping;
                          scene.solver = solver;
                          scene.solver.damping = damping;
                          scene.solver.joint_damping = joint_damping;
                          if (change) change(scene);
                          return outcomeOf(scene, seconds, script);
                        }});
  }

 private:
  std::vector<Case>& cases_;
};

/// Every pin on a circle of its own, from where it starts; stops after 1.5 s.
void leadPins(Run& run) {
  run.inputs.pins.clear();
  for (const Pin& pin : run.model.pins)
    run.inputs.pins.push_back(pin.target + circle(0.3, 4 * std::min(timeAfter(run), 1.5)));
}

/// Both pins to one place above the floor, as no joint allows, and back.
void leadPinsTogether(Run& run) {
  const double t = timeAfter(run), way = t < 1 ? std::min(1.0, 4 * t) : std::max(0.0, 2 - t);
  run.inputs.pins.clear();
  for (const Pin& pin : run.model.pins)
    run.inputs.pins.push_back(pin.target + way * (Vec3(0, 0, 0.9) - pin.target));
}

void addPins(Scripts& scripts) {
  scripts.add(
      "pins that move", 2.5,
      human("position: [0, 0, 1.3], rpy_deg: [0, 60, 0]") + "pins: [right_hand, left_foot]\n" +
          "obstacles: [{type: plane}, {type: box, position: [0, 0, 0.3], size: [0.4, 1, 0.6]}]\n",
      leadPins);
  scripts.add("pins led where joints do not go", 2.5,
              human(kLies) + "pins: [right_foot, head]\n" + kFloor + "solver: {joint_damping: 2}\n",
              leadPinsTogether);
  scripts.add("pins of the rigid torso", 2,
              human("position: [0, 0, 1.5]") + "pins: [left_shoulder, right_hip, neck]\n",
              leadPins);
  scripts.add(
      "a body held by all it has", 0.5,
      human("position: [0, 0, 1.5], place: {head: [0.1, 0, 2.2]}") +
          "pins: [head, neck, left_shoulder, right_shoulder, left_hip, right_hip, left_hand]\n",
      leadPins);
  scripts.add("attached and let go", 2.5,
              human("position: [0, 0, 1.2], rpy_deg: [0, 30, 0]") + kFloor, [](Run& run) {
                if (isTime(run, 0.3)) run.hold({"head"});
                if (isTime(run, 0.8)) run.hold({"head", "left_foot"});
                if (isTime(run, 1.2)) run.hold({"left_foot"});
                if (isTime(run, 1.6)) run.hold({});
                if (run.state.time > 0.4 && !run.model.pins.empty()) {
                  run.inputs.pins.clear();
                  for (Pin& pin : run.model.pins)
                    run.inputs.pins.push_back(pin.target += Vec3(0.004, 0, 0.006));
                }
              });
}

void addPokes(Scripts& scripts) {
  scripts.add(
      "pokes", 2.5,
      human("position: [0, 0, 1.1]") + kFloor +
          "pokes: [{at: 0.1, body: head, force: [200, 0, 0], duration: 0.1},\n"
          "        {at: 0.1, body: head, force: [0, 150, 40]},\n"
          "        {at: 0.3, body: torso, force: [0, 900, 0], point: [0, 0, 0.2], duration: "
          "0.05},\n"
          "        {at: 0.5, body: right_forearm, force: [0, 0, 400], point: [0.1, 0.1, 0]},\n"
          "        {at: 0.6, body: pelvis, force: [0, 0, 900], duration: 0.3}]\n",
      [](Run& run) {
        if (isTime(run, 1)) run.poke("left_shank", -1, Vec3(0, 0, 60), Vec3(0, 0.1, 0));
        if (isTime(run, 1.5)) run.inputs.pokes.clear();
        if (isTime(run, 1.7)) run.poke("left_hand", 0, Vec3(0, 2000, 300));
      });
  for (const auto& [name, force] : {std::pair("1e5", 1e5), std::pair("1e8", 1e8)})
    scripts.add(
        std::string("pokes of ") + name + " N", 1.5,
        human("position: [0, 0, 1.1]") +
            "self_collision: true\n"
            "obstacles: [{type: plane}, {type: sphere, position: [0.5, 0, 0.4], radius: 0.4}]\n",
        [force = force](Run& run) {
          if (isTime(run, 0.2)) run.poke("right_hand", 0, Vec3(force, 0, -force));
          if (isTime(run, 0.6)) run.poke("torso", 0.1, Vec3(0, force, -force), Vec3(0, 0, 0.1));
          if (isTime(run, 0.9)) run.poke("left_foot", 0.05, Vec3(-force, 0, 0.1 * force));
        });
}

void addObstacles(Scripts& scripts) {
  scripts.add("obstacles that move", 3,
              human("position: [0, -0.2, 0.13], rpy_deg: [0, -90, 90]") +
                  "obstacles:\n- {type: plane, friction: 0.6}\n"
                  "- {type: box, position: [-0.8, 0, 0.3], size: [0.1, 0.6, 0.6], friction: 0.4}\n"
                  "- {type: sphere, position: [0.3, 0, 1.5], radius: 0.3, restitution: 0.5}\n"
                  "- {type: capsule, from: [-1, 1, 0.1], to: [1, 1, 0.1], radius: 0.05}\n"
                  "solver: {joint_damping: 2}\n",
              [](Run& run) {
                const double t = timeAfter(run);
                std::vector<Pose>& to = run.inputs.obstacles = run.state.obstacles;
                for (std::size_t i = 0; i < to.size(); ++i) to[i] = run.model.obstacles[i].pose;
                to[0].position.z() = 0.05 * std::sin(6 * t);
                to[0].orientation = Quat(Eigen::AngleAxisd(0.1 * std::sin(3 * t), Vec3::UnitX())) *
                                    to[0].orientation;
                to[1].position.x() += std::min(t, 2.0);
                to[1].orientation = Quat(Eigen::AngleAxisd(std::min(t, 2.0), Vec3::UnitZ()));
                to[2].position.z() -= t < 1 ? 0.9 * t : 1.8 - 0.9 * std::min(t, 2.0);
                to[3].position.y() -= 4 * std::max(0.0, t - 2);
              });
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

void addBodies(Scripts& scripts) {
  scripts.add(
      "bodies of every model on each other", 2,
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
      "blow of one at another", 1.5,
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
      "           {name: b, model: human, position: [0.05, 0.05, 1], rpy_deg: [0, 60, 40]}]\n"
      "ragdoll_collision: true\nself_collision: true\n" +
          kFloor);
  scripts.add(
      "lies across a box, half in it", 1.5,
      human(kLies) +
          "obstacles: [{type: plane}, {type: box, position: [0, 0, 0.3], size: [0.1, 2, 0.6]}]\n");
  scripts.add(
      "gravity that turns", 2,
      human("position: [0, 0, 1.1]") +
          "obstacles: [{type: plane}, {type: plane, point: [0, 0, 4], normal: [0, 0, -1]}]\n",
      [](Run& run) {
        if (isTime(run, 0.7)) run.setGravity(Vec3(3, 0, 12));
        if (isTime(run, 1.6)) run.setGravity(Vec3(0, 0, 0));
      });
}

}  // namespace

void addScripted(std::vector<Case>& cases) {
  Scripts scripts(cases);
  addPins(scripts);
  addPokes(scripts);
  addObstacles(scripts);
  addSleep(scripts);
  addBodies(scripts);
  addLimits(scripts);
  addStarts(scripts);
}

}  // namespace ragdoll::golden
