#include "core/direct/edges.h"

#include <algorithm>
#include <cmath>

#include "core/contact/constants.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/contact_path.h"
#include "core/direct/impact.h"
#include "core/limits/limit_value.h"

namespace ragdoll {
namespace {

/// [s] When a point first crosses the border of the core (a box, a line or a point) along one of
/// its axes. More than h: never.
double timeOfBorder(const Vec3& half, const Path& path, double h) {
  double first = 2 * h;
  for (int k = 0; k < 3; ++k) {
    if (half[k] == 0) continue;
    for (const double side : {-1.0, 1.0}) {
      const double out = side * path.start[k] - half[k], end = side * path.end[k] - half[k];
      const double way = std::copysign(1.0, out);  // positive until it is crossed
      if (std::abs(out) < kAtEdge || way * end > -kAtEdge) continue;
      first = std::min(first, timeOfZero(way * out, way * side * path.rate[k], way * end, h));
    }
  }
  return first;
}

/// Of a place that runs along a stick from `start` to `end`, straight.
Path pathOfPlace(const ContactPath& stick, double start, double end) {
  const Path &a = stick.point[0], &b = stick.point[1];
  Path place;
  place.start = a.start + start * (b.start - a.start);
  place.end = a.end + end * (b.end - a.end);
  place.rate = (place.end - place.start) / stick.h;
  return place;
}

/// [s] When the place where a stick of that length [m] touches comes to one of its ends, or from
/// there. More than h: never. start, end: that place; placeAt(share): after a share of the motion.
template <class PlaceAt>
double timeOfEnd(double start, double end, double length, double h, const PlaceAt& placeAt) {
  const bool ends = !isBetweenEnds(end);
  if (ends != isBetweenEnds(start)) return 2 * h;
  if (ends && length * std::min(start, 1 - start) < kAtEdge) return 2 * h;
  double lo = 0, hi = 1;
  while (hi - lo > kSnap) {
    const double share = 0.5 * (lo + hi);
    (isBetweenEnds(placeAt(share)) == ends ? lo : hi) = share;
  }
  return hi * h;
}

/// [s] When the nearest place has run along one of the sticks so far that a longer motion would
/// take it for another contact, which is hit. More than h: never, or it jumps, as over a face.
double timeOfRun(const ContactPath& path, double h) {
  const AxisPoints start = path.placesAt(0);
  const auto run = [&](double share) {
    const AxisPoints now = path.placesAt(share);
    return std::max(std::abs(now.s - start.s), std::abs(now.t - start.t));
  };
  if (run(1) < kMostRun) return 2 * h;
  double lo = 0, hi = 1;
  while (hi - lo > kSnap) {
    const double share = 0.5 * (lo + hi);
    (run(share) < kMostRun ? lo : hi) = share;
  }
  return run(hi) < kSamePlace ? hi * h : 2 * h;
}

/// Whether it is of something that has no edges, or whose places are its springs'.
bool isSmooth(const Model& model, const Contact& c) {
  if (c.obstacle < 0) return false;
  return model.obstacles[static_cast<std::size_t>(c.obstacle)].type == ObstacleSpec::Type::kPlane ||
         (c.count == 2 && c.isSoft());
}

/// [s] When the contact goes over an edge, or an end of its sticks.
double timeOfEdge(const Contact& c, const ContactPath& path, double h) {
  if (c.count == 1) return timeOfBorder(path.obstacle->half, path.point[0], h);
  const double start = c.start_weight[1], end = c.weight[1];
  const double first = timeOfEnd(start, end, path.length(0), h,
                                 [&](double share) { return path.placesAt(share).s; });
  if (path.obstacle)
    return std::min(first, timeOfBorder(path.obstacle->half, pathOfPlace(path, start, end), h));
  return std::min(first, timeOfEnd(-c.start_weight[3], -c.weight[3], path.length(1), h,
                                   [&](double share) { return path.placesAt(share).t; }));
}

/// Of the contacts of a body, or between bodies.
template <class Owner>
double timeOfEdge(const Owner& owner, const std::vector<Contact>& contacts, double h) {
  double first = 2 * h;
  for (const Contact& c : contacts) {
    if (c.runs)
      first = std::min(first, timeOfRun(pathOf(owner, c, h), h));
    else if (c.touches_at_start && !isSmooth(contextOf(owner).model, c) &&
             !(c.count > 1 && isFlat(contacts, c)))
      first = std::min(first, timeOfEdge(c, pathOf(owner, c, h), h));
  }
  return first;
}

/// [s] When a limit that presses leaves the border of a wedge, over its tip or, if it gives way,
/// past its middle. More than h: it does not.
double timeOfTip(const Body& body, const LimitRow& row, const double* end, double h) {
  const Limit& limit = body.skeleton->limits[row.limit];
  if (limit.kind != Limit::Kind::kWedge ||
      row.before >= (row.isSoft() ? 0 : body.context->tolerances.touching_angle))
    return 2 * h;
  const int border = nearerBorder(limit, body.xData());
  if (border == 0) return 2 * h;
  constexpr double kAtTip = 1e-8;          // [rad] nearer to it is on it
  constexpr double kShort = 0.5 * kAtTip;  // before it: beyond, nothing would press on the way
  const double before = roomAtBorder(limit, body.xData(), border);
  const double after = roomAtBorder(limit, end, border);
  if (before < kAtTip || after > 0) return 2 * h;
  return timeOfZero(before - kShort, (after - before) / h, after - kShort, h);
}

}  // namespace

double timeOfTip(const Body& body, double h) {
  double first = 2 * h;
  const std::vector<LimitRow>& limits = body.constraints.limits;
  if (limits.empty()) return first;
  const double* end = poseAfter(body).data() + 3 * body.first;
  for (const LimitRow& row : limits) first = std::min(first, timeOfTip(body, row, end, h));
  return first;
}

double timeOfTip(const Island& island, double h) {
  double first = 2 * h;
  for (const Body* body : island.bodies) first = std::min(first, timeOfTip(*body, h));
  return first;
}

double timeOfEdge(const Island& island, double h) {
  double first = 2 * h;
  bool all = true;
  for (const Body* body : island.bodies) {
    const bool may = body->located < kMaxLocated;
    if (may)
      first =
          std::min({first, timeOfEdge(*body, body->constraints.contacts, h), timeOfTip(*body, h)});
    all = all && may;
  }
  return all ? std::min(first, timeOfEdge(island, island.pairs.contacts, h)) : first;
}

}  // namespace ragdoll
