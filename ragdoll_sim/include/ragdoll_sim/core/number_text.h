// Numbers in messages.
#pragma once

#include <string>

namespace ragdoll {

/// Six digits at most, whatever the locale: "0.25", "1e-09", "inf"; "nan" whatever its sign.
std::string numberText(double number);

}  // namespace ragdoll
