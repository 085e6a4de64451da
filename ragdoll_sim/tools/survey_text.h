// A survey as text: a table for people, CSV for programs.
#pragma once

#include <string>

#include "survey.h"

namespace ragdoll::lab {

/// What `error` means in this survey, in a few words.
std::string whatError(const Survey& survey);

/// How the reference was found and how sure it is, a line.
std::string whatReference(const Survey& survey);

std::string toTable(const Survey& survey, const std::string& scene);
std::string toCsv(const Survey& survey);

}  // namespace ragdoll::lab
