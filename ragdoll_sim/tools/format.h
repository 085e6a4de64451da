// printf into a string, for tables.
#pragma once

#include <string>

namespace ragdoll::lab {

/// At most 399 characters; the rest is cut off.
__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...);

}  // namespace ragdoll::lab
