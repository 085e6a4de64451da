// Packs for AVX2: compiled with -mavx2 where the compiler has it (CMakeLists.txt).
#include "core/fast/pack_operations.h"

namespace ragdoll::test {

const PackUnit kMiddleUnit = unitOf<4, 8>();

}  // namespace ragdoll::test
