// Where the scenes and models that come with the package are.
#pragma once

#include <string>
#include <vector>

namespace ragdoll {

/// Folders that hold scenes/ and models/, most wanted first: $RAGDOLL_SHARE_DIR, beside the
/// installed program, the source tree, the install tree, what ROS_PACKAGE_PATH names.
std::vector<std::string> shareDirectories();

/// The file that `scene` means: a path, or the name of a file in scenes/ ("fall"). Throws Error
/// that lists the names.
std::string findScene(const std::string& scene);

/// The file that `model` means: the name of a file in models/ ("human"), or a path, relative to
/// `folder`. `where` is for the Error, which lists the names.
std::string findModel(const std::string& model, const std::string& folder,
                      const std::string& where);

}  // namespace ragdoll
