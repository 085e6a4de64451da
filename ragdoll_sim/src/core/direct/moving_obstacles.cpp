#include "core/direct/moving_obstacles.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

/// Where trials that take part of a step begin and end in it [1].
struct StepPart {
  double start = 0, end = 1;
  bool isWhole() const { return start == 0 && end == 1; }
};

StepPart partOf(const Body& body, double h) {
  const double step = body.context->h;
  StepPart part{body.time / step, (body.time + h) / step};
  if (part.start < kPartEnd) part.start = 0;
  if (part.end > 1 - kPartEnd) part.end = 1;
  return part;
}

}  // namespace

Pose between(const Pose& a, const Pose& b, double share) {
  if (share == 0) return a;
  if (share == 1) return b;
  return {a.position + share * (b.position - a.position),
          a.orientation.slerp(share, b.orientation)};
}

const std::vector<SweptObstacle>& obstaclesOver(const Body& body, double h) {
  const StepContext& step = *body.context;
  const std::vector<Pose>& end = step.inputs.obstacles;
  if (!body.driven || end.empty()) return step.ws.obstacles;
  const StepPart part = partOf(body, h);
  if (part.isWhole()) return step.ws.obstacles;
  std::vector<SweptObstacle>& swept = scratchOf(step).obstacles;
  swept = step.ws.obstacles;
  for (std::size_t k = 0; k < swept.size(); ++k) {
    SweptObstacle& m = swept[k];
    if (m.p0 == m.p1 && m.R0 == m.R1) continue;
    const Pose& from = step.state.obstacles[k];
    const int index = m.index;
    m = sweepObstacle(*m.obstacle, between(from, end[k], part.start),
                      between(from, end[k], part.end));
    m.index = index;
  }
  return swept;
}

ObstacleMotion motionAt(const SweptObstacle& swept, double time, double h) {
  ObstacleMotion m{swept.obstacle, swept.moves, swept.R0, swept.p0};
  if (!swept.moves) return m;
  const double share = time / h, angle = swept.turn.norm();
  m.speed = (swept.p1 - swept.p0) / h;
  m.spin = swept.turn / h;
  m.p += share * (swept.p1 - swept.p0);
  if (angle > 0) m.R = Eigen::AngleAxisd(share * angle, swept.turn / angle) * swept.R0;
  return m;
}

double fastestObstacle(const Body& body) {
  const StepContext& step = *body.context;
  double square = 0;
  for (const SweptObstacle& swept : step.ws.obstacles) {
    if (!swept.moves) continue;
    const ObstacleMotion m = motionAt(swept, 0, step.h);
    for (int i = 0; i < body.n; ++i)
      square = std::max(square, m.velocityAt(body.x().col(i)).squaredNorm());
  }
  return std::sqrt(square);
}

void scaleMotion(const StepContext& step, double h, Contact& contact) {
  if (!(h < step.h) || contact.obstacle < 0) return;
  for (Vec3* motion : {&contact.surface_motion, &contact.surface_start, &contact.surface_end})
    *motion *= step.h / h;
}

}  // namespace ragdoll
