// Words for answers and messages.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// "(1, 2, 3)"
std::string shown(const Vec3& v);

/// "a, b, c and 7 more"
std::string listed(const std::vector<std::string>& names);

/// "2 ragdolls, 1 obstacle"
std::string contents(const Model& model);

/// "ragdoll/right_hand" of whatever name the body was asked for by.
std::string fullName(const Model& model, const BodyRef& body, const std::string& name);

/// Throws Error.
void checkFinite(const Vec3& v, const char* name, const char* unit);

}  // namespace ragdoll
