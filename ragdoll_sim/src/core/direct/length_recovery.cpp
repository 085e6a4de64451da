#include "core/direct/length_recovery.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/direct/constants.h"
#include "core/direct/motion.h"
#include "core/linear/constants.h"

namespace ragdoll {
namespace {

/// Relative error of the worst squared length.
double lengthError(Body& body) {
  BodyResponse& response = body.memory->response;
  response.setStart(body.xData());
  return response.startError({body.rows->length2.data(), body.rows->inverse_length2.data(), 0});
}

/// Gives collapsed sticks a direction, that of the rest pose.
void spreadCollapsed(Body& body) {
  const BodyResponse& response = body.memory->response;
  bool collapsed = false;
  for (int s = 0; s < body.rows->s; ++s)
    collapsed =
        collapsed || response.startLength2(s) < kNoLength * kNoLength * body.rows->length2[s];
  if (!collapsed) return;
  const Points& rest = body.skeleton->rest;
  const Vec3 middle = rest.rowwise().mean();
  for (int i = 0; i < body.n; ++i)
    if (body.system->W(i, i) > 0) body.x().col(i) += kNoLength * (rest.col(i) - middle);
}

}  // namespace

bool restoreLengths(Body& body, double h) {
  const StickRows& rows = *body.rows;
  if (rows.s == 0) return false;
  BodyResponse& response = body.memory->response;
  body.lengths.tolerance = std::max(
      kLengthTolerance,
      kPositionRounding *
          Eigen::Map<const Eigen::VectorXd>(body.xData(), 3 * body.n).cwiseAbs().maxCoeff() /
          rows.shortest);
  if (lengthError(body) < std::max(kWhole, kWholeTolerances * body.lengths.tolerance)) return false;
  spreadCollapsed(body);
  response.setStart(body.xData());
  const double keep = std::exp(-h / kRecoveryTime);
  body.lengths2 = rows.length2;
  for (int s = 0; s < rows.s; ++s) {
    const double length = std::sqrt(rows.length2[s]), now = std::sqrt(response.startLength2(s));
    body.lengths2[s] = std::pow(length + keep * (now - length), 2);
  }
  body.lengths.length2 = body.lengths2.data();
  body.motion.dx.setZero(3, body.n);
  body.motion.lambda.setZero(rows.width);
  body.kept = body.x();
  if (satisfySticksAlongNew(body)) {
    body.x() += body.motion.dx;
  } else {
    body.moved = body.x();
    response.relaxInTurn(body.lengths, kRecoverySweeps, body.moved);
    body.x() = body.moved;
    if (!body.x().allFinite()) body.x() = body.kept;
  }
  response.setStart(body.xData());
  for (int s = 0; s < rows.s; ++s) body.lengths2[s] = response.startLength2(s);
  body.inverse_lengths2 = rows.inverse_length2;
  body.inverse_lengths2.head(rows.s) = body.lengths2.head(rows.s).cwiseInverse();
  body.lengths.inverse_length2 = body.inverse_lengths2.data();
  response.projectAtStart(body.vData());
  return true;
}

}  // namespace ragdoll
