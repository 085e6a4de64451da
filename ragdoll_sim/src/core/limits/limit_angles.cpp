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

LimitAngles::Pose& LimitAngles::at(const Model& model, const Points& x, int ragdoll) {
  const Skeleton& skeleton = model.skeletonOf(model.ragdolls[ragdoll]);
  const std::vector<Limit>& limits = skeleton.limits;
  const double* body = x.data() + 3 * model.ragdolls[ragdoll].first;
  const std::size_t count = 3 * static_cast<std::size_t>(skeleton.size());
  ++calls_;
  Pose* oldest = &poses_[0];
  for (Pose& pose : poses_) {
    if (pose.coordinates_.size() == count &&
        std::memcmp(pose.coordinates_.data(), body, count * sizeof(double)) == 0) {
      pose.last_call_ = calls_;
      return pose;
    }
    if (pose.last_call_ < oldest->last_call_) oldest = &pose;
  }
  Pose& pose = *oldest;
  pose.last_call_ = calls_;
  pose.coordinates_.assign(body, body + count);
  pose.value_.resize(limits.size());
  pose.row_.resize(limits.size());
  for (std::size_t k = 0; k < limits.size(); ++k) {
    pose.value_[k] = limitValue(limits[k], body);
    pose.row_[k].count = 0;
  }
  return pose;
}

}  // namespace ragdoll
