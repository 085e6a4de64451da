// Names of the scene's things as parts of topics' names.
#pragma once

#include <string>
#include <vector>

namespace ragdoll {

/// What topics may not have becomes '_'; where two would be the same, later ones end in _2, _3, ...
std::vector<std::string> topicNames(const std::vector<std::string>& names);

}  // namespace ragdoll
