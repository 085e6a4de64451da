// The stability matrix as text: a table for the terminal, and Markdown for docs/extremes_tables.md.
#pragma once

#include <string>

#include "extreme_matrix.h"

namespace ragdoll::lab {

std::string toTable(const Matrix& matrix);
std::string toMarkdown(const Matrix& matrix);

/// `document` with `tables` in place of what stands between its lines <!-- `mark` --> and
/// <!-- /`mark` -->. Throws Error, which names `path`, if it has no such lines.
std::string withTables(const std::string& document, const std::string& mark,
                       const std::string& tables, const std::string& path);

}  // namespace ragdoll::lab
