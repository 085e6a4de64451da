// Numbers with units, as people type them: "1mm", "0.5 cm", "50us".
#pragma once

#include <string>

namespace ragdoll::lab {

/// [m] from um, mm, cm or m. Throws Error that names the option.
double parseLength(const std::string& option, const std::string& text);

/// [s] from us, ms or s; "50us/s" says the same. Throws Error that names the option.
double parseTime(const std::string& option, const std::string& text);

/// Three digits and a unit that suits: "0.81 mm", "95.2 us".
std::string lengthText(double metres);
std::string timeText(double seconds);

}  // namespace ragdoll::lab
