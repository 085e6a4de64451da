// Packs for AVX-512: compiled with -mavx512f -mavx512dq where the compiler has them
// (CMakeLists.txt).
#include "core/fast/lane_together.h"
#include "core/fast/methods.h"

namespace ragdoll::fast {

const PackMethod kWide64 = methodOf<LaneWork<double, 8>>();
const PackMethod kWide32 = methodOf<LaneWork<float, 16>>();

}  // namespace ragdoll::fast
