// What must hold of any text taken as a scene and of any bytes taken as a snapshot. Shared by the
// mutation test and by the fuzzers (test/fuzz/).
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/snapshot.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/model_yaml.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::test {

/// How an input was taken: `broken` names the law that does not hold.
struct Taken {
  bool accepted = false;
  std::string broken;
};

inline Taken refusedWith(const std::string& message, const std::string& place) {
  if (message.find(place) == std::string::npos) return {false, "no '" + place + "' in: " + message};
  if (message.size() > Error::kLongest + 10) return {false, "a message of " + std::to_string(message.size())};
  return {false, ""};
}

/// An error that names the text, or a scene whose own text is the same scene.
inline Taken takeScene(const std::string& text) {
  try {
    const Scene scene = parseScene(text, "input.yaml");
    const Model model = buildModel(scene);
    if (startState(model).x.cols() != model.size()) return {true, "a state of another size"};
    if (parseScene(scene.text, "again.yaml").text != scene.text) return {true, "another text"};
    return {true, ""};
  } catch (const Error& e) {
    return refusedWith(e.what(), "input.yaml");
  }
}

/// The same for a model file, in a scene of one body.
inline Taken takeModel(const std::string& text) {
  try {
    Scene scene;
    scene.where = "input.yaml";
    scene.ragdolls.emplace_back();
    scene.ragdolls[0].skeleton = parseModel(text, "input.yaml");
    buildModel(scene);
    return {true, ""};
  } catch (const Error& e) {
    return refusedWith(e.what(), "input.yaml");
  }
}

/// The last eight bytes become the checksum of those before, so that damage gets past it.
inline void sealSnapshot(std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < sizeof(std::uint64_t)) return;
  const std::size_t size = bytes.size() - sizeof(std::uint64_t);
  std::uint64_t h = 14695981039346656037ull;  // FNV-1a 64
  for (std::size_t i = 0; i < size; ++i) h = (h ^ bytes[i]) * 1099511628211ull;
  std::memcpy(bytes.data() + size, &h, sizeof h);
}

/// A scene with something in every part of a snapshot.
inline Scene snapshotScene() {
  return parseScene(R"(
ragdolls:
  - {name: one, model: human_thesis, position: [0, 0, 0.9], velocity: [1, 0, 0]}
  - {name: two, model: human, position: [0, 1, 0.9], rpy_deg: [0, 80, 0]}
obstacles: [{type: plane}, {type: box, position: [1, 0, 0], size: [1, 1, 1], frame: table}]
pins: [two/right_hand, {particle: one/head, frame: crane}]
pokes: [{at: 0.01, body: two/torso, force: [10, 0, 5], point: [0, 0.1, 0], duration: -1}]
solver: {preset: draft}
)");
}

/// The snapshot of that scene after so many steps.
inline std::vector<std::uint8_t> snapshotAfter(const Model& model, int steps) {
  State state = startState(model);
  const Inputs inputs = startInputs(model);
  Workspace workspace;
  for (int i = 0; i < steps; ++i) step(model, inputs, workspace, state);
  return toBytes(model, {state, model.pokes, model.pins, model.gravity, model.solver});
}

/// An error that says snapshot, or a moment with which the world goes on and which gives the same
/// bytes again.
inline Taken takeSnapshot(const Model& model, const std::vector<std::uint8_t>& bytes) {
  try {
    const Moment moment = fromBytes(model, bytes);
    if (toBytes(model, moment) != bytes) return {true, "other bytes"};
    Model pinned = model;
    setPins(pinned, moment.pins);
    State state = moment.state;
    const Inputs inputs{moment.pokes, {}, {}};
    Workspace workspace;
    step(pinned, inputs, workspace, state);
    if (state.step != moment.state.step + 1) return {true, "no step"};
    return {true, ""};
  } catch (const Error& e) {
    return refusedWith(e.what(), "snapshot");
  }
}

}  // namespace ragdoll::test
