#include "core/direct/contact_path.h"

#include <algorithm>
#include <cmath>

#include "core/contact/first_touch.h"
#include "core/direct/contact_motion.h"
#include "core/direct/moving_obstacles.h"

namespace ragdoll {
namespace {

/// In the world. v1: as pathOf's.
template <class Owner>
ContactPath pathInWorld(const Owner& owner, const Contact& c, double h, const Points* v1) {
  const StepContext& step = contextOf(owner);
  ContactPath path;
  path.count = c.count;
  path.h = h;
  for (int k = 0; k < c.count; ++k) {
    path.point[k].start = path.point[k].end = step.state.x.col(c.particle[k]);
    path.radius[k] = step.model.radius[c.particle[k]];
  }
  visitMoving(owner, c, [&](int k, const Body& body, int i) {
    Path& p = path.point[k];
    const Vec3 dx = body.motion.dx.col(i);
    p.end += dx;
    p.rate = body.v().col(i);
    p.end_rate = v1 ? Vec3(v1->col(i)) : Vec3(2 / h * dx - p.rate);
  });
  return path;
}

/// Seen from an obstacle; straight where that moves.
void seeFrom(const SweptObstacle& m, ContactPath& path) {
  path.obstacle = m.obstacle;
  for (int k = 0; k < path.count; ++k) {
    Path& p = path.point[k];
    p.start = m.toStart(p.start);
    p.end = m.toEnd(p.end);
    p.rate = m.moves ? Vec3((p.end - p.start) / path.h) : Vec3(m.R0.transpose() * p.rate);
    p.end_rate = m.moves ? p.rate : Vec3(m.R0.transpose() * p.end_rate);
  }
}

}  // namespace

Vec3 Path::at(double share, double h) const {
  const double left = 1 - share;
  return left * left * ((1 + 2 * share) * start + share * h * rate) +
         share * share * ((1 + 2 * left) * end - left * h * end_rate);
}

CapsuleAxis ContactPath::capsuleAt(int first, double share) const {
  return {point[first].at(share, h), point[first + 1].at(share, h), radius[first],
          radius[first + 1]};
}

Axis ContactPath::axisAt(double share) const {
  return {*obstacle, point[0].at(share, h), point[1].at(share, h), radius[0], radius[1]};
}

AxisPoints ContactPath::placesAt(double share) const {
  if (count == 4) return nearestPoints(capsuleAt(0, share), capsuleAt(2, share));
  return {count == 2 ? nearest(axisAt(share)) : 0, 0};
}

double ContactPath::gapAt(double share) const {
  if (count == 1) return signedDistanceValue(*obstacle, point[0].at(share, h)) - radius[0];
  const AxisPoints at = placesAt(share);
  if (count == 2) return axisAt(share).gap(at.s);
  return ragdoll::gapAt(capsuleAt(0, share), capsuleAt(2, share), at);
}

double ContactPath::length(int stick) const {
  return (point[2 * stick + 1].start - point[2 * stick].start).norm();
}

ContactPath pathOf(const Body& body, const Contact& c, double h, const Points* v1) {
  ContactPath path = pathInWorld(body, c, h, v1);
  if (c.obstacle >= 0) seeFrom(obstaclesOver(body, h)[static_cast<std::size_t>(c.obstacle)], path);
  return path;
}

ContactPath pathOf(const Island& island, const Contact& c, double h) {
  return pathInWorld(island, c, h, nullptr);
}

bool isFlat(const std::vector<Contact>& contacts, const Contact& c) {
  return std::count_if(contacts.begin(), contacts.end(), [&c](const Contact& other) {
           return other.obstacle == c.obstacle && other.count == c.count &&
                  other.particle == c.particle;
         }) > 1;
}

void placeAtEnd(const Body& body, const std::vector<Contact>& contacts, double h, Contact& c) {
  if (c.count != 2 || c.isSoft() || isFlat(contacts, c)) return;
  const SweptObstacle& m = obstaclesOver(body, h)[static_cast<std::size_t>(c.obstacle)];
  const Axis axis = pathOf(body, c, h).axisAt(1);
  const double place = nearest(axis);
  if (std::abs(place - c.weight[1]) > kSamePlace || !isBetweenEnds(place)) return;
  const Distance distance = signedDistance(*m.obstacle, axis.at(place));
  const Vec3 normal = m.R1 * distance.normal;
  if (distance.value <= 0 || !(normal.dot(c.normal) > kSameSide)) return;  // its axis is inside
  c.normal = normal;
  c.weight = {1 - place, place, 0, 0};
}

double shareOfGraze(const ContactPath& path, double touching) {
  const auto gap = [&](double share) { return path.gapAt(share); };
  const double start = gap(0), end = gap(1);
  return std::min(start, end) > touching ? lowestIfClosed(gap, 0, start, 1, end) : kNeverTouched;
}

double shareOfTouch(const ContactPath& path, double touching) {
  const auto gap = [&](double share) { return path.gapAt(share); };
  const double least = shareOfGraze(path, touching);
  return least == kNeverTouched ? least : firstTouch(gap, 0, gap(0), least, gap(least));
}

}  // namespace ragdoll
