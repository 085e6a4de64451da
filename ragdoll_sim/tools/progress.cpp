#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace ragdoll::lab {
namespace {

constexpr int kWidth = 30;  ///< characters of the bar
constexpr const char* kWipe = "\r\033[K";

}  // namespace

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fputs(kWipe, stderr);
}

void Progress::show(double share, const std::string& doing) {
  if (!terminal_) return;
  shown_ = true;
  const int full = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
  std::fprintf(stderr, "%s[%s%s] %3.0f %%  %s", kWipe, std::string(full, '#').c_str(),
               std::string(kWidth - full, '.').c_str(), 100 * share, doing.c_str());
  std::fflush(stderr);
}

}  // namespace ragdoll::lab
