// Packs of the least instruction set that there is, and single numbers.
#include "core/fast/pack_operations.h"

namespace ragdoll::test {

const PackUnit kSingleUnit = unitOf<1, 1>();
const PackUnit kNarrowUnit = unitOf<2, 4>();

}  // namespace ragdoll::test
