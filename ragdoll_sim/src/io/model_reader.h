// Reads a model where it stands in a tree: a model file's root, or a mapping inside a scene.
#pragma once

#include <string>

#include "ragdoll_sim/core/scene.h"
#include "reader.h"

namespace ragdoll::io {

/// `name` is the model's if it has no key `name`.
SkeletonSpec readModel(const Reader& reader, const std::string& name);

}  // namespace ragdoll::io
