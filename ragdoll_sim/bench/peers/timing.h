// CPU time of this thread, medians, and numbers as the tables show them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace ragdoll::peers {

/// [s]
inline double cpuTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/// Two digits, or all of those before the point.
inline std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, value >= 99.5 && value < 1e6 ? "%.0f" : "%.2g", value);
  return text;
}

}  // namespace ragdoll::peers
