// What gives way where it is touched: obstacles, and the regions of a body.
#pragma once

#include <string>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// where: of the part in the file whose keys they are. Throws Error.
Compliance complianceOf(const ContactSpec& contact, const std::string& where);

/// Of the skeleton's particles and sticks, from its segments'.
void addContactRegions(Skeleton& skeleton);

}  // namespace ragdoll
