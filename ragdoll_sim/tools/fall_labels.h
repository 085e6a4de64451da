// The labels of a fall as columns, the same in every format.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/falls/record.h"

namespace ragdoll::lab {

struct Label {
  enum class Type { kNumber, kWord, kCount };
  const char* name;
  Type type;
  double number = 0;   ///< NaN: it did not happen
  std::string word;    ///< at most kWordLength bytes
};

constexpr std::size_t kWordLength = 24;

/// In the order of the columns.
std::vector<Label> labelsOf(const falls::Record& record);

}  // namespace ragdoll::lab
