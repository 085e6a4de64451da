#include "ragdoll_sim/world/text.h"

#include <cstddef>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {

std::string shown(const Vec3& v) {
  return "(" + numberText(v.x()) + ", " + numberText(v.y()) + ", " + numberText(v.z()) + ")";
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 20;  // more helps nobody
  if (names.size() <= kMost) return joined(names);
  return joined({names.begin(), names.begin() + kMost}) + " and " +
         std::to_string(names.size() - kMost) + " more";
}

void checkFinite(const Vec3& v, const char* name, const char* unit) {
  if (!v.allFinite())
    throw Error(name, "is " + shown(v) + "; it must be three finite numbers " + unit);
}

std::string fullName(const Model& model, const BodyRef& body, const std::string& name) {
  return model.ragdolls[body.ragdoll].name + "/" + name.substr(name.find('/') + 1);
}

std::string contents(const Model& model) {
  return counted(model.ragdolls.size(), "ragdoll") + ", " +
         counted(model.obstacles.size(), "obstacle");
}

}  // namespace ragdoll
