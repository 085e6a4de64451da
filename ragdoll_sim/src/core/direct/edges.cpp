#include "core/direct/edges.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/impact.h"
#include "core/direct/moving_obstacles.h"

namespace ragdoll {
namespace {

/// [m] In the obstacle's frame: at the motion's start, and end; [m/s] at its start.
struct Path {
  Vec3 start, end, rate;
};

/// [s] When it first crosses the border of the core (a box, a line or a point) along one of its
/// axes. More than h: never.
double timeOfBorder(const Vec3& half, const Path& path, double h) {
  double first = 2 * h;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const double out = side * path.start[k] - half[k], end = side * path.end[k] - half[k];
      const double way = std::copysign(1.0, out);  // positive until it is crossed
      if (std::abs(out) < kAtEdge || way * end > -kAtEdge) continue;
      first = std::min(first, timeOfZero(way * out, way * side * path.rate[k], way * end, h));
    }
  }
  return first;
}

Path pathOf(const Body& body, const SweptObstacle& m, int particle, double h) {
  const Vec3 x0 = body.context->state.x.col(particle);
  const Vec3 x1 = x0 + body.motion.dx.col(particle - body.first);
  Path path{m.toStart(x0), m.toEnd(x1), {}};
  path.rate = m.moves ? Vec3((path.end - path.start) / h)
                      : Vec3(m.R0.transpose() * body.context->state.v.col(particle));
  return path;
}

double timeOfEdge(const Body& body, double h) {
  double first = 2 * h;
  const std::vector<SweptObstacle>& obstacles = obstaclesOver(body, h);
  for (const Contact& c : body.constraints.contacts) {
    if (c.obstacle < 0 || c.count != 1 || !c.touches_at_start) continue;
    const SweptObstacle& m = obstacles[static_cast<std::size_t>(c.obstacle)];
    if (m.obstacle->type == ObstacleSpec::Type::kPlane) continue;
    first = std::min(first, timeOfBorder(m.obstacle->half, pathOf(body, m, c.particle[0], h), h));
  }
  return first;
}

}  // namespace

double timeOfEdge(const Island& island, double h) {
  double first = 2 * h;
  for (const Body* body : island.bodies)
    if (body->located < kMaxLocated) first = std::min(first, timeOfEdge(*body, h));
  return first;
}

}  // namespace ragdoll
