#include "core/direct/mode_limits.h"

#include <algorithm>
#include <cmath>

#include "core/direct/mode_constants.h"
#include "core/direct/workspace.h"
#include "core/limits/limit_value.h"

namespace ragdoll {
namespace {

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

/// At x, and as the motion goes on.
void evaluateAhead(const Body& body, const double* x, const double* v, LimitRow& limit) {
  Points& pose = posesOf(*body.context);
  double* ahead = pose.data() + 3 * body.first;
  for (int i = 0; i < 3 * body.n; ++i) ahead[i] = x[i] + kMoment * v[i];
  evaluateLimit(body.skeleton->limits[limit.limit], x, ahead, body.first, limit);
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

int borderOf(const ModeRow& limit) { return limit.presses ? limit.feature[0] : 0; }

void placeLimit(Body& body, const ModeRow& row, const double* x, const double* v, bool curvature,
                RowPlace& place) {
  place.limit = limitRow(body.context->model, body.index, row.limit);
  place.limit.border = borderOf(row);
  evaluateAhead(body, x, v, place.limit);
  place.feature[0] = place.limit.border;
  place.gap = place.limit.value;
  if (curvature) place.curvature = limitCurvature(body, place.limit, x, v);
}

}  // namespace ragdoll
