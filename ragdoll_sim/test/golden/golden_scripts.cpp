// Runs of the golden list in which somebody does something.
#include "golden_scripts.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::golden {
namespace {

Vec3 circle(double radius, double angle) {
  return Vec3(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0);
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

void addGravity(Scripts& scripts) {
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

std::string human(const std::string& start, const std::string& model) {
  return "ragdolls: [{name: ragdoll, model: " + model + ", " + start + "}]\n";
}

double timeAfter(const Run& run) { return run.state.time + run.model.solver.step; }

bool isTime(const Run& run, double time) {
  const double half = 0.5 * run.model.solver.step;
  return run.state.time > time - half && run.state.time < time + half;
}

void leadPins(Run& run) {
  run.inputs.pins.clear();
  for (const Pin& pin : run.model.pins)
    run.inputs.pins.push_back(pin.target + circle(0.3, 4 * std::min(timeAfter(run), 1.5)));
}

void Scripts::add(const std::string& name, double seconds, const std::string& text,
                  const Script& script, const std::function<void(Scene&)>& change) {
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

void addActs(Scripts& scripts) {
  addPins(scripts);
  addPokes(scripts);
  addObstacles(scripts);
  addGravity(scripts);
}

void addScripted(std::vector<Case>& cases) {
  Scripts scripts(cases);
  addActs(scripts);
  addBodies(scripts);
  addModels(scripts);
}

}  // namespace ragdoll::golden
