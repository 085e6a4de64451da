#include "core/limits/limit_angles.h"

#include <algorithm>
#include <cstring>

namespace ragdoll {

void LimitAngles::Pose::evaluate(const Model& model, const Points& x, LimitRow& row) {
  LimitRow& known = row_[row.limit];
  if (known.count == 0) {
    known.ragdoll = row.ragdoll;
    known.limit = row.limit;
    evaluateLimit(model, x, known);
  }
  row.value = known.value;
  row.count = known.count;
  std::copy_n(known.particle.begin(), known.count, row.particle.begin());
  std::copy_n(known.gradient.begin(), known.count, row.gradient.begin());
}

bool LimitAngles::Pose::is(const double* coordinates, std::size_t count) const {
  return coordinates_.size() == count &&
         std::memcmp(coordinates_.data(), coordinates, count * sizeof(double)) == 0;
}

void LimitAngles::Pose::set(const std::vector<Limit>& limits, const double* coordinates,
                            std::size_t count) {
  coordinates_.assign(coordinates, coordinates + count);
  value_.resize(limits.size());
  row_.resize(limits.size());
  for (std::size_t k = 0; k < limits.size(); ++k) {
    value_[k] = limitValue(limits[k], coordinates);
    row_[k].count = 0;
  }
}

LimitAngles::Pose& LimitAngles::at(const Model& model, const Points& x, int ragdoll) {
  const Skeleton& skeleton = model.skeletonOf(model.ragdolls[ragdoll]);
  const double* body = x.data() + 3 * model.ragdolls[ragdoll].first;
  const std::size_t count = 3 * static_cast<std::size_t>(skeleton.size());
  ++calls_;
  std::size_t oldest = 0;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (poses_[i].is(body, count)) {
      last_call_[i] = calls_;
      return poses_[i];
    }
    if (last_call_[i] < last_call_[oldest]) oldest = i;
  }
  last_call_[oldest] = calls_;
  poses_[oldest].set(skeleton.limits, body, count);
  return poses_[oldest];
}

}  // namespace ragdoll
