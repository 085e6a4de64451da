#include "ragdoll_sim/core/number_text.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace ragdoll {

std::string numberText(double number) {
  if (std::isnan(number)) return "nan";
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream << number;
  return stream.str();
}

}  // namespace ragdoll
