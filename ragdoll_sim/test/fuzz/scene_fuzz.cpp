// Any text as a scene and as a model: an error that names it, or what it says. See
// docs/robustness.md.
#include <cstdio>
#include <cstdlib>

#include "support/hostile.h"

namespace {

void require(const ragdoll::test::Taken& outcome) {
  if (outcome.broken.empty()) return;
  std::fprintf(stderr, "%s\n", outcome.broken.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  require(ragdoll::test::takeScene(text));
  require(ragdoll::test::takeModel(text));
  return 0;
}
