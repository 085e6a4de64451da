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
  tolerances = tolerancesFor(c.h);
  lengths = {rows->length2.data(), rows->inverse_length2.data(), kLengthTolerance};
  pin_speed = 0;
  driven = limited = false;
  located = 0;
  overlaps = OverlapPolicy::kResolve;
  constraints.overlap = 0;
  touching.clear();
  cache.clear();
}

double* Body::multipliers() const {
  return context->state.multipliers.data() + context->ws.first_multiplier[index];
}

const Points& poseAfter(const Body& body) {
  Points& pose = body.context->ws.predicted;
  pose.middleCols(body.first, body.n) = body.x() + body.motion.dx;
  return pose;
}

LimitAngles::Pose& anglesAfter(const Body& body) {
  return body.memory->angles.at(body.context->model, poseAfter(body), body.index);
}

LimitAngles::Pose& anglesBefore(const Body& body) {
  return body.memory->angles.at(body.context->model, body.context->state.x, body.index);
}

}  // namespace ragdoll
