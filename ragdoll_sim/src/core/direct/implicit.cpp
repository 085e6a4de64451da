#include "core/direct/implicit.h"

namespace ragdoll {

bool solveImplicitMotion(Body& body, double h) {
  const int sticks = body.rows->s;
  ImplicitSticks& s = body.implicit;
  s.free = h * body.v() + (h * h) * body.acceleration;
  body.motion.lambda.setZero(body.rows->width);
  body.motion.dx = s.free;
  if (sticks == 0) return s.free.allFinite();
  s.lambda = Eigen::Map<const Eigen::VectorXd>(body.multipliers(), sticks) * (h * h);
  if (!s.lambda.allFinite()) s.lambda.setZero();
  if (!moveImplicitly(*body.system, body.lengths.length2, body.x(), s)) return false;
  body.motion.dx = s.dx;
  body.motion.lambda.head(sticks) = s.lambda;
  return true;
}

}  // namespace ragdoll
