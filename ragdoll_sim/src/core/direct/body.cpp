#include "core/direct/body.h"

#include "core/direct/workspace.h"
#include "core/linear/constants.h"

namespace ragdoll {

void Body::bind(const StepContext& c, int r) {
  context = &c;
  index = r;
  ragdoll = &c.model.ragdolls[r];
  skeleton = &c.model.skeletonOf(*ragdoll);
  pinned = &c.model.systemOf(*ragdoll);
  system = &pinned->direct;
  rows = system->rows.get();
  memory = &c.ws.bodies[r];
  first = ragdoll->first;
  n = rows->n;
  memory->response.bind(*system);
  lengths = {rows->length2.data(), rows->inverse_length2.data(), kLengthTolerance};
  pin_speed = 0;
  driven = pushed = damps_within = false;
  given = damped = 0;
  from = took = 0;
  located = 0;
  overlaps = OverlapPolicy::kResolve;
  constraints.overlap = 0;
  touching.clear();
  cache.clear();
}

double* Body::multipliers() const {
  return context->state.multipliers.data() + context->ws.first_multiplier[index];
}

Points& posesOf(const StepContext& context) {
  Points& poses = scratchOf(context).poses;
  poses.resize(3, context.model.size());
  return poses;
}

const Points& poseAfter(const Body& body) {
  Points& pose = posesOf(*body.context);
  const double *x = body.xData(), *dx = body.motion.dx.data();
  double* out = pose.data() + 3 * body.first;
  for (int i = 0; i < 3 * body.n; ++i) out[i] = x[i] + dx[i];
  return pose;
}

LimitAngles::Pose& anglesAt(const Body& body, const Points& pose) {
  return body.memory->angles.at(body.context->model, pose, body.index);
}

LimitAngles::Pose& anglesAfter(const Body& body) { return anglesAt(body, poseAfter(body)); }

LimitAngles::Pose& anglesBefore(const Body& body) { return anglesAt(body, body.context->state.x); }

}  // namespace ragdoll
