// Packs for AVX-512: compiled with -mavx512f -mavx512dq where the compiler has them
// (CMakeLists.txt).
#include "core/fast/pack_operations.h"

namespace ragdoll::test {

const PackUnit kWideUnit = unitOf<8, 16>();

}  // namespace ragdoll::test
