// The part of a scene that may be changed by one key and one value: solver, gravity, collisions,
// coat.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"
#include "reader.h"

namespace ragdoll::io {

const std::vector<std::string>& numbersNames();  ///< in the order of Numbers
const std::vector<std::string>& coatNames();
const std::vector<std::string>& solverKeys();   ///< of the section `solver`
const std::vector<std::string>& settingKeys();  ///< of the scene, without the section `solver`

/// `key` is one of solverKeys(). `preset` replaces all other knobs.
void readSolverKnob(const std::string& key, const Reader& value, SolverSpec& solver);

/// `key` is one of settingKeys().
void readSetting(const std::string& key, const Reader& value, Scene& scene);

/// The section `solver`: the preset first, then its knobs.
SolverSpec readSolver(const Reader& reader);

}  // namespace ragdoll::io
