// Packs of the least instruction set that there is, and single bodies.
#include "core/fast/lane_together.h"
#include "core/fast/methods.h"

namespace ragdoll::fast {

const PackMethod kSingle64 = methodOf<LaneWork<double, 1>>();
const PackMethod kSingle32 = methodOf<LaneWork<float, 1>>();
const PackMethod kNarrow64 = methodOf<LaneWork<double, 2>>();
const PackMethod kNarrow32 = methodOf<LaneWork<float, 4>>();

}  // namespace ragdoll::fast
