// What bits may depend on besides the source.
#include <Eigen/Core>

#include "golden_list.h"
#if defined(__x86_64__)
#include <cpuid.h>
#endif
#if defined(__GLIBC__)
#include <gnu/libc-version.h>
#endif

namespace ragdoll::golden {
namespace {

std::string compiler() {
#if defined(__clang__)
  std::string text = "clang " __clang_version__;
  return text.substr(0, text.find_last_not_of(' ') + 1);
#elif defined(__GNUC__)
  return "gcc " __VERSION__;
#else
  return "unknown";
#endif
}

/// Vendor and the vectors that the kernels choose on it (lanes.h asks the same).
std::string processor() {
#if defined(__x86_64__)
  unsigned highest = 0, name[3] = {};
  __get_cpuid(0, &highest, &name[0], &name[2], &name[1]);
  const std::string vectors = __builtin_cpu_supports("avx512f") ? "avx512f"
                              : __builtin_cpu_supports("avx2")  ? "avx2"
                                                                : "sse2";
  return std::string(reinterpret_cast<const char*>(name), sizeof name) + ", " + vectors;
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "unknown";
#endif
}

/// The C library's sines and powers; it has others for processors with fused multiply-add.
std::string mathematics() {
#if defined(__GLIBC__)
  std::string text = std::string("glibc ") + gnu_get_libc_version();
#else
  std::string text = "unknown";
#endif
#if defined(__x86_64__)
  text += __builtin_cpu_supports("fma") ? " with fma" : " without fma";
#endif
  return text;
}

/// Eigen sums in vectors, as wide as it is compiled for.
std::string eigen() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION) + ", " + Eigen::SimdInstructionSetsInUse();
}

}  // namespace

Build thisBuild() {
  return {{"compiler", compiler()},
          {"processor", processor()},
          {"mathematics", mathematics()},
          {"eigen", eigen()},
          {"flags", RAGDOLL_GOLDEN_FLAGS}};
}

}  // namespace ragdoll::golden
