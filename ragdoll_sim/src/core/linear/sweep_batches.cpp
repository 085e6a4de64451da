#include "core/linear/sweep_batches.h"

#include <algorithm>
#include <cmath>

namespace ragdoll {

void SweepBatches::putAllowed(const std::vector<SchurBlock>& blocks, RowValues& p) const {
  const auto put = [&](int i) { p[i] = scale_[i] > 0 ? better_[i] / scale_[i] : p[i]; };
  for (const SchurBlock& block : blocks) {
    double* now = p.data() + block.row;
    put(block.row);
    now[0] = std::max(0.0, now[0]);
    if (!block.has_tangents) continue;
    put(block.row + 1);
    put(block.row + 2);
    const double limit = block.friction * now[0], length = std::hypot(now[1], now[2]);
    if (length <= limit) continue;
    now[1] *= limit / length;
    now[2] *= limit / length;
  }
}

}  // namespace ragdoll
