// Packs for AVX2: compiled with -mavx2 where the compiler has it (CMakeLists.txt).
#include "core/fast/lane_together.h"
#include "core/fast/methods.h"

namespace ragdoll::fast {

const PackMethod kMiddle64 = methodOf<LaneWork<double, 4>>();
const PackMethod kMiddle32 = methodOf<LaneWork<float, 8>>();
const PackMethod kMiddleSingle64 = methodOf<LaneWork<double, 1, 2>>();
const PackMethod kMiddleSingle32 = methodOf<LaneWork<float, 1, 2>>();

}  // namespace ragdoll::fast
