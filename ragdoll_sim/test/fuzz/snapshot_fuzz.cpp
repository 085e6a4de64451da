// Any bytes with a right checksum as a snapshot: an error, or a moment from which the world goes on.
// See docs/robustness.md.
#include <cstdio>
#include <cstdlib>

#include "ragdoll_sim/core/build_model.h"
#include "support/hostile.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ragdoll::Model model = ragdoll::buildModel(ragdoll::test::snapshotScene());
  std::vector<std::uint8_t> bytes(data, data + size);
  ragdoll::test::sealSnapshot(bytes);
  const ragdoll::test::Taken outcome = ragdoll::test::takeSnapshot(model, bytes);
  if (outcome.broken.empty()) return 0;
  std::fprintf(stderr, "%s\n", outcome.broken.c_str());
  std::abort();
}
