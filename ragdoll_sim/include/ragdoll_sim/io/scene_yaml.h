// Scenes from YAML and back. Only the form is checked here (types, ranges, unknown keys, duplicate
// keys); what the parts mean together is for buildModel, which finds file, line and key in the
// specs' `where`. Lengths in metres, angles in keys that end in _deg in degrees, else in radians.
#pragma once

#include <string>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll {

/// `path` is a file, or the name of a scene that comes with the package. Throws Error that names
/// file, line and key and says what would be right.
Scene loadScene(const std::string& path);

/// `name` is what messages call the text; paths of models are relative to the current folder.
Scene parseScene(const std::string& text, const std::string& name = "<text>");

/// Whether it is a scene's text itself, not the name of a scene or the path of a file.
bool isSceneText(const std::string& scene);

/// The scene as YAML that stands alone: models inlined, every value written out so that parsing it
/// gives the same bits. It is what Scene::text holds after loading.
std::string toYaml(const Scene& scene);

/// For runs without TF: what would follow a frame stays where the scene puts it, like any other
/// obstacle or pin.
void fixFrames(Scene& scene);

/// Changes one setting as if the scene had said so: "solver.step", "0.001". Keys: solver.*,
/// gravity, self_collision, ragdoll_collision, coat. Throws Error that lists the keys.
void applySetting(Scene& scene, const std::string& key, const std::string& value);

}  // namespace ragdoll
