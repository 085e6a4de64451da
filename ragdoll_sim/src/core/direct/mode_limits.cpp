#include "core/direct/mode_limits.h"

#include <algorithm>
#include <cmath>

#include "core/direct/mode_constants.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

/// All positions with this body's at x; valid until the next call.
const Points& poseAt(const Body& body, const double* x) {
  Points& pose = posesOf(*body.context);
  std::copy(x, x + 3 * body.n, pose.data() + 3 * body.first);
  return pose;
}

/// Rate of a limit at x + share v along v.
double limitRate(Body& body, LimitRow& limit, const double* x, const double* v, double share) {
  Points& pose = posesOf(*body.context);
  double* out = pose.data() + 3 * body.first;
  for (int i = 0; i < 3 * body.n; ++i) out[i] = x[i] + share * v[i];
  evaluateLimit(body.context->model, pose, limit);
  return rateOfLimit(body, limit, v);
}

/// By central differences of fourth order of the exact gradient.
double limitCurvature(Body& body, const LimitRow& at_x, const double* x, const double* v) {
  const double speed =
      std::sqrt(Eigen::Map<const Points>(v, 3, body.n).colwise().squaredNorm().maxCoeff());
  if (!(speed > 0)) return 0;
  const double e = kDifference / speed;
  LimitRow limit = at_x;
  const double near = limitRate(body, limit, x, v, e) - limitRate(body, limit, x, v, -e);
  const double far = limitRate(body, limit, x, v, 2 * e) - limitRate(body, limit, x, v, -2 * e);
  return (8 * near - far) / (12 * e);
}

}  // namespace

double rateOfLimit(const Body& body, const LimitRow& limit, const double* v) {
  double rate = 0;
  for (int k = 0; k < limit.count; ++k) {
    const Eigen::Map<const Vec3> of(v + 3 * (limit.particle[k] - body.first));
    rate += limit.gradient[k].dot(of);
  }
  return rate;
}

void placeLimit(Body& body, const ModeRow& row, const double* x, const double* v, bool curvature,
                RowPlace& place) {
  place.limit = limitRow(body.context->model, body.index, row.limit);
  evaluateLimit(body.context->model, poseAt(body, x), place.limit);
  place.gap = place.limit.value;
  if (curvature) place.curvature = limitCurvature(body, place.limit, x, v);
}

}  // namespace ragdoll
