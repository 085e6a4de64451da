// Which packs this processor runs.
#pragma once

#include "core/fast/border.h"

namespace ragdoll::fast {

/// The widest pack that the processor has in one vector, and that has no more lanes than there are
/// bodies to fill most of it. most: lanes allowed, 0: any.
const PackMethod& packFor(bool single_precision, int bodies, int most);

}  // namespace ragdoll::fast
