// The packs that there are, each in a unit of its own instruction set. Private to the fast method.
#pragma once

#include "core/fast/border.h"

namespace ragdoll::fast {

extern const PackMethod kSingle64, kSingle32, kNarrow64, kNarrow32;
#if defined(__x86_64__) && defined(__GNUC__)
extern const PackMethod kMiddle64, kMiddle32, kWide64, kWide32;
// Single bodies in three-operand instructions: a tenth faster.
extern const PackMethod kMiddleSingle64, kMiddleSingle32;
#endif

}  // namespace ragdoll::fast
