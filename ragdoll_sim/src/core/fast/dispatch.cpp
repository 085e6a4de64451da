#include "core/fast/dispatch.h"

#include <array>

#include "core/fast/methods.h"

namespace ragdoll::fast {
namespace {

/// Widest first; null: not on this processor.
using Methods = std::array<const PackMethod*, 4>;

Methods methods(bool single_precision) {
  Methods all = {nullptr, nullptr, single_precision ? &kNarrow32 : &kNarrow64,
                 single_precision ? &kSingle32 : &kSingle64};
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
    all[0] = single_precision ? &kWide32 : &kWide64;
  if (__builtin_cpu_supports("avx2")) {
    all[1] = single_precision ? &kMiddle32 : &kMiddle64;
    all[3] = single_precision ? &kMiddleSingle32 : &kMiddleSingle64;
  }
#endif
  return all;
}

}  // namespace

const PackMethod& packFor(bool single_precision, int bodies, int most) {
  static const Methods kAll[2] = {methods(false), methods(true)};
  const Methods& all = kAll[single_precision];
  for (const PackMethod* method : all)
    if (method && (most == 0 || method->lanes <= most) && bodies > 1 &&
        kPackFull * method->lanes <= bodies)
      return *method;
  return *all.back();
}

}  // namespace ragdoll::fast
