// A survey as a picture: cost against error, both logarithmic, a line per family. Drawn by gnuplot,
// a program of its own, where there is one.
#pragma once

#include <string>

#include "survey.h"

namespace ragdoll::lab {

/// Writes <base>.png and <base>.svg. Returns "" or, in one line, why there is no picture.
std::string draw(const Survey& survey, const std::string& title, const std::string& base);

/// What gnuplot is told, for one of its terminals ("pngcairo", "svg").
std::string plotScript(const Survey& survey, const std::string& title, const std::string& terminal,
                       const std::string& file);

}  // namespace ragdoll::lab
