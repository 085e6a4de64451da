// What a user is told of a text that is no scene.
#pragma once

#include <string>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/error_of.h"

namespace ragdoll {

using test::errorOf;

/// What a user is told who loads this text under the name scene.yaml.
inline std::string errorOfText(const std::string& text) {
  return errorOf([&] { buildModel(parseScene(text, "scene.yaml")); });
}

/// A scene of one ragdoll made of `model`, an indented block of lines; the model's first line is
/// line 4.
inline std::string sceneWithModel(const std::string& model) {
  return "ragdolls:\n  - name: doll\n    model:\n" + model;
}

}  // namespace ragdoll
