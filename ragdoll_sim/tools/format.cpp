#include "format.h"

#include <cstdarg>
#include <cstdio>

namespace ragdoll::lab {

std::string format(const char* pattern, ...) {
  char line[400];
  va_list values;
  va_start(values, pattern);
  std::vsnprintf(line, sizeof line, pattern, values);
  va_end(values);
  return line;
}

}  // namespace ragdoll::lab
