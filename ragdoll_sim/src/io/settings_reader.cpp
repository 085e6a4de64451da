#include "settings_reader.h"

#include <algorithm>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace io {
namespace {

constexpr int kMaxSweeps = 100000;
constexpr double kSmallestStep = 1e-7;  ///< [s]
constexpr double kLargestStep = 1;      ///< [s]

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

const std::vector<std::string>& numbersNames() {
  static const std::vector<std::string> names = {"double", "float"};
  return names;
}

const std::vector<std::string>& coatNames() {
  static const std::vector<std::string> names = {"none", "sticks", "boxes", "capsules", "skin"};
  return names;
}

const std::vector<std::string>& solverKeys() {
  static const std::vector<std::string> keys = {
      "preset", "method",  "integrator",    "step",  "sweeps",  "tolerance",
      "events", "damping", "joint_damping", "sleep", "numbers", "threads"};
  return keys;
}

const std::vector<std::string>& settingKeys() {
  static const std::vector<std::string> keys = {"gravity", "self_collision", "ragdoll_collision",
                                                "coat"};
  return keys;
}

void readSolverKnob(const std::string& key, const Reader& value, SolverSpec& solver) {
  if (key == "preset") {
    SolverSpec next = preset(presetNames()[value.choice(presetNames())]);
    next.where = solver.where;
    next.joint_damping = solver.joint_damping;  // it belongs to the body
    solver = std::move(next);
  } else if (key == "method") {
    solver.method = static_cast<Method>(value.choice(methodNames()));
  } else if (key == "integrator") {
    solver.integrator = static_cast<Integrator>(value.choice(integratorNames()));
  } else if (key == "step") {
    solver.step = value.within(kSmallestStep, kLargestStep);
  } else if (key == "sweeps") {
    solver.sweeps = value.integer(1, kMaxSweeps);
  } else if (key == "tolerance") {
    const double tolerance = value.number();
    checkTolerance(value.where(), tolerance);
    solver.tolerance = tolerance;
  } else if (key == "events") {
    solver.events = value.boolean();
  } else if (key == "damping") {
    solver.damping = value.notNegative();
  } else if (key == "joint_damping") {
    solver.joint_damping = value.notNegative();
  } else if (key == "sleep") {
    solver.sleep = value.boolean();
  } else if (key == "numbers") {
    solver.numbers = static_cast<Numbers>(value.choice(numbersNames()));
  } else if (key == "threads") {
    solver.threads = value.integer(0, kMaxThreads);
  }
}

void readSetting(const std::string& key, const Reader& value, Scene& scene) {
  if (key == "gravity") {
    scene.gravity = value.vector();
  } else if (key == "self_collision") {
    scene.self_collision = value.boolean();
  } else if (key == "ragdoll_collision") {
    scene.ragdoll_collision = value.boolean();
  } else if (key == "coat") {
    scene.coat = coatNames()[value.choice(coatNames())];
  }
}

SolverSpec readSolver(const Reader& reader) {
  MapReader map(reader);
  SolverSpec solver = preset("balanced");
  solver.where = reader.where();
  for (const std::string& key : solverKeys()) {
    if (const auto value = map.find(key)) readSolverKnob(key, *value, solver);
  }
  map.finish();
  return solver;
}

}  // namespace io

void applySetting(Scene& scene, const std::string& key, const std::string& value) {
  const std::string section = "solver.";
  const bool of_solver = key.compare(0, section.size(), section) == 0;
  const std::string knob = of_solver ? key.substr(section.size()) : key;
  if (!io::contains(of_solver ? io::solverKeys() : io::settingKeys(), knob)) {
    std::vector<std::string> keys = io::settingKeys();
    for (const std::string& name : io::solverKeys()) keys.push_back(section + name);
    throw Error("setting " + io::quoted(key), "unknown; the settings are " + io::joined(keys));
  }
  const auto document = io::parseDocument(value, "setting " + key);
  Scene changed = scene;
  const io::Reader reader(document, "setting", key, 0);
  of_solver ? io::readSolverKnob(knob, reader, changed.solver)
            : io::readSetting(knob, reader, changed);
  changed.text = toYaml(changed);
  scene = std::move(changed);
}

}  // namespace ragdoll
