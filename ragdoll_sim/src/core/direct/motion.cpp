#include "core/direct/motion.h"

#include "core/direct/driving.h"
#include "core/direct/velocity_solver.h"

namespace ragdoll {

bool freeMotion(Body& body, double h) {
  Motion& motion = body.motion;
  const int s = body.rows->s;
  motion.dx = h * body.v() + (0.5 * h * h) * body.acceleration;
  motion.lambda.setZero(body.rows->width);
  double* warm = body.multipliers();  // per h^2: of the last motion,
  double* before = warm + s;          // and of the one before it; extrapolated to this one
  for (int k = 0; k < s; ++k) motion.lambda[k] = (2 * warm[k] - before[k]) * h * h;
  body.memory->response.impulse(motion.lambda.data(), motion.dx);
  const bool whole = satisfySticks(body);
  for (int k = 0; k < s; ++k) {
    before[k] = warm[k];
    warm[k] = motion.lambda[k] / (h * h);
  }
  return whole;
}

bool satisfySticks(Body& body) {
  return body.memory->response.alongStart(body.lengths, body.motion.dx, body.motion.lambda);
}

bool satisfySticksAlongNew(Body& body) {
  return body.memory->response.alongEnd(body.lengths, body.x(), body.motion.dx, body.motion.lambda);
}

void makeMotion(Body& body, double h, bool leapfrog) {
  const Points& after = poseAfter(body);
  addWork(body, leapfrog ? 0.5 : 1);
  driveAt(body, after.data() + 3 * body.first);
  if (leapfrog) addWork(body, 0.5);
  body.v() = body.motion.dx / h;
  if (leapfrog) body.v() += (0.5 * h) * body.acceleration;
  findTouching(body, h, leapfrog);
  body.x() += body.motion.dx;
  BodyResponse& response = body.memory->response;
  response.setEnd(body.xData());
  response.projectAtEnd(body.vData());
}

}  // namespace ragdoll
