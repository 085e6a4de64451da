#include "core/direct/body.h"

#include "core/direct/mode_constants.h"
#include "core/direct/workspace.h"
#include "core/linear/constants.h"

namespace ragdoll {

void makeRoom(const Skeleton& skeleton, const DirectSystem& system, BodyMemory& memory) {
  memory.response.bind(system);
  memory.angles.makeRoom(skeleton);
}

void Body::makeRoom(const DirectSystem& of) {
  const StickRows& r = *of.rows;
  for (Points* values : {&motion.dx, &free.dx, &acceleration, &force, &v1, &moved, &kept})
    values->resize(3, r.n);
  ragdoll::makeRoom(r, saved);
  ragdoll::makeRoom(r, energy);
  for (Eigen::VectorXd* values :
       {&motion.lambda, &free.lambda, &tension, &row_sums, &lengths2, &inverse_lengths2})
    values->resize(r.width);
  ragdoll::makeRoom(of, implicit);
}

void Body::bind(const StepContext& c, int r) {
  context = &c;
  index = r;
  ragdoll = &c.model.ragdolls[r];
  skeleton = &c.model.skeletonOf(*ragdoll);
  pinned = &c.model.systemOf(*ragdoll);
  system = &pinned->direct;
  rows = system->rows.get();
  memory = c.ws.lends ? &scratchOf(c).lent[ragdoll->skeleton] : c.ws.bodies[r].get();
  if (c.ws.lends) memory->schur.forget();  // what it has is of another body
  first = ragdoll->first;
  n = rows->n;
  makeRoom(*system);
  memory->response.bind(*system);
  lengths = {rows->length2.data(), rows->inverse_length2.data(), kLengthTolerance};
  pin_speed = 0;
  driven = pushed = damps_within = false;
  given = damped = 0;
  time = 0;
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

const double* aheadOf(const Body& body) {
  Points& pose = posesOf(*body.context);
  const double *x = body.xData(), *dx = body.motion.dx.data(), *v = body.vData();
  double* out = pose.data() + 3 * body.first;
  for (int i = 0; i < 3 * body.n; ++i) out[i] = x[i] + dx[i] + kMoment * v[i];
  return out;
}

LimitAngles::Pose& anglesAt(const Body& body, const Points& pose) {
  return body.memory->angles.at(body.context->model, pose, body.index);
}

LimitAngles::Pose& anglesAfter(const Body& body) { return anglesAt(body, poseAfter(body)); }

LimitAngles::Pose& anglesBefore(const Body& body) { return anglesAt(body, body.context->state.x); }

}  // namespace ragdoll
