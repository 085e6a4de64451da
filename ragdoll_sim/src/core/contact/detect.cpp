#include "core/contact/detect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/contact/axis.h"
#include "core/contact/compliance.h"
#include "core/contact/constants.h"
#include "core/contact/distance.h"
#include "core/contact/first_touch.h"
#include "core/contact/stick_ends.h"
#include "core/contact/stick_places.h"
#include "core/contact/stick_springs.h"

namespace ragdoll {
namespace {

Vec3 halfExtent(const Obstacle& o, const Eigen::Matrix3d& R) {
  return (R.cwiseAbs() * o.half).array() + o.radius;
}

/// [m] The step's length times the obstacle's velocity at `arm` (world) from its centre; chord: [m]
/// how that place moves, the same unless it turns.
Vec3 surfaceAt(const SweptObstacle& m, const Vec3& arm, const Vec3& chord) {
  return m.turn.isZero(0) ? chord : Vec3(m.p1 - m.p0 + m.turn.cross(arm));
}

/// Its contact touched at the start, with its axis at p0 (the obstacle's frame).
void setStart(const SweptObstacle& m, const Vec3& p0, Contact& c) {
  const Distance d = signedDistance(*m.obstacle, p0);
  c.start_normal = m.R0 * d.normal;
  c.surface_start = surfaceAt(m, m.R0 * (p0 - d.value * d.normal), c.surface_motion);
  c.touches_at_start = c.start_normal.dot(c.normal) > kSameSide;
}

/// Contact with the plane at the distance d from `p` (a point of the body's axis, in the obstacle's
/// frame).
Contact planeAt(const SweptObstacle& m, const Vec3& p, const Distance& d, double radius) {
  const Vec3 surface = p - d.value * d.normal;
  Contact c;
  c.normal = m.R1 * d.normal;
  const Vec3 surface_W = m.R1 * surface + m.p1;
  c.offset = c.normal.dot(surface_W) + radius;
  c.surface_motion = surface_W - (m.R0 * surface + m.p0);
  c.surface_start = surfaceAt(m, m.R0 * surface, c.surface_motion);
  c.surface_end = surfaceAt(m, m.R1 * surface, c.surface_motion);
  c.friction = m.obstacle->friction;
  c.restitution = m.obstacle->restitution;
  c.follows = !m.obstacle->frame.empty();
  c.obstacle = m.index;
  return c;
}

/// With the tangent plane at the nearest point of the surface.
Contact tangentAt(const SweptObstacle& m, const Vec3& p, double radius) {
  return planeAt(m, p, signedDistance(*m.obstacle, p), radius);
}

/// Whether what rests on a solid at p0 does so at p1, where its gap is `end`: on the same side, not
/// so deep that it may have gone through. It has gone along, however far.
bool goesAlong(const Obstacle& o, const Vec3& p0, const Vec3& p1, double end, double radius) {
  return end > -0.5 * radius &&
         signedDistance(o, p0).normal.dot(signedDistance(o, p1).normal) > kSameSide;
}

/// Where the sphere is first in touch on its way, or would be in the end; false: it stays clear.
bool particleTouch(const Obstacle& o, const Vec3& p0, const Vec3& p1, double radius, double margin,
                   double start, Vec3& at) {
  const auto gap = [&](double s) { return signedDistanceValue(o, p0 + s * (p1 - p0)) - radius; };
  const double travel = (p1 - p0).norm(), end = gap(1);
  const bool closes = start > kResting && end <= 0;
  at = p1;
  if (o.type == ObstacleSpec::Type::kPlane) return end <= margin || start <= margin;
  const bool rests = isResting(start);
  if (start > -radius && travel > 0.5 * radius && !(rests && goesAlong(o, p0, p1, end, radius))) {
    // Far enough to pass through something. Touching already: p0.
    double s = 0, d = start;
    advance(gap, travel, s, d);
    if (d > std::max(kGapResolution, margin)) return false;
    if (start > kResting && d > 0) s = touchAfter(gap, travel, radius, s, d, end);
    at = p0 + s * (p1 - p0);
    return true;
  }
  if (closes) at = p0 + firstTouch(gap, 0, start, 1, end) * (p1 - p0);
  return end <= margin || start <= margin;
}

void particleContact(const SweptObstacle& m, const Vec3& x0, const Vec3& x1, double radius,
                     const Compliance& give, double margin, Contact& c, bool& found) {
  const Vec3 p0 = m.toStart(x0), p1 = m.toEnd(x1);
  const double start = signedDistanceValue(*m.obstacle, p0) - radius;
  found = start <= (p1 - p0).norm() + margin;
  Vec3 at;
  found = found && particleTouch(*m.obstacle, p0, p1, radius, margin, start, at);
  if (!found) return;
  c = tangentAt(m, at, radius);
  c.give = give;
  c.gap_start = start;
  c.touches_at_start = touchesAtStart(give, start);
  if (!c.touches_at_start) return;
  c.start_weight = {1, 0, 0, 0};
  setStart(m, p0, c);
}

/// Whether a line is farther than `reach` [m] from the core of a solid along one of its frame's
/// axes, by more than rounding.
bool isBeside(const Obstacle& o, const Vec3& a, const Vec3& b, double reach) {
  if (o.type == ObstacleSpec::Type::kPlane) return false;
  const Vec3 gap = a.cwiseMin(b).cwiseMax(-a.cwiseMax(b)) - o.half;
  return gap.maxCoeff() > reach + o.radius + kGapResolution;
}

/// The capsule at the instant of its first touch, or in the end; nothing if it stays clear.
/// start: its gap at the step's start.
std::optional<Axis> touching(const Axis& at_start, const Axis& at_end, double margin,
                             double& start) {
  const Obstacle& o = at_start.obstacle;
  const Vec3 &a0 = at_start.a, &b0 = at_start.b;
  const double ra = at_start.ra, rb = at_start.rb;
  const Vec3 da = at_end.a - a0, db = at_end.b - b0;
  const double travel = travelOf(at_start, at_end);
  const auto axisAt = [&](double s) { return Axis{o, a0 + s * da, b0 + s * db, ra, rb}; };
  const auto gapAt = [&](double s) {
    const Axis axis = axisAt(s);
    return axis.gap(nearest(axis));
  };
  if (isBeside(o, a0, b0, std::max(ra, rb) + travel + margin)) return std::nullopt;
  start = gapAt(0);
  if (start > travel + margin) return std::nullopt;
  const double thin = std::min(ra, rb), end = gapAt(1);
  const bool closes = start > kResting && end <= 0;
  const auto nearestAt = [&](double s) { return axisAt(s).at(nearest(axisAt(s))); };
  const bool rests = isResting(start);
  if (start > -thin && travel > 0.5 * thin &&
      !(rests && goesAlong(o, nearestAt(0), nearestAt(1), end, thin))) {
    double s = 0, d = start;
    advance(gapAt, travel, s, d);
    if (d > std::max(kGapResolution, margin)) return std::nullopt;
    return axisAt(start > kResting && d > 0 ? touchAfter(gapAt, travel, thin, s, d, end) : s);
  }
  if (std::min(start, end) > margin) return std::nullopt;
  return axisAt(closes ? firstTouch(gapAt, 0, start, 1, end) : 1);
}

/// The same of a capsule at a place t of its axis. Where its axis runs through the middle of the
/// obstacle, the nearest face may lie along it; then it goes out across itself.
Contact tangentAt(const SweptObstacle& m, const Axis& axis, double t) {
  const Vec3 p = axis.at(t), along = (axis.b - axis.a).normalized();
  Distance d = signedDistance(*m.obstacle, p);
  const bool between = t > kStickEnd && t < 1 - kStickEnd;
  if (between && d.value < 0 && std::abs(d.normal.dot(along)) > kAlong)
    d = lineDistance(*m.obstacle, p, along);
  return planeAt(m, p, d, axis.radius(t));
}

/// Its contact touched at the start, at a place t of `axis`.
void setStart(const SweptObstacle& m, const Axis& axis, double t, Contact& c) {
  c.start_weight = {1 - t, t, 0, 0};
  setStart(m, axis.at(t), c);
  if (!c.touches_at_start || !isBetweenEnds(t)) return;
  for (int end = 0; end < 2; ++end) c.has_end[end] = isRoundTo(axis, t, end);
}

/// A capsule between whose ends contacts are looked for.
struct StickSearch {
  Axis axis, at_start;  ///< at the instant of its touch, and at the step's start
  double start = 0;     ///< [m] its gap there
  int a = 0, b = 0;     ///< particles
  int ragdoll = 0;
  Compliance give;
  double reach = 0;  ///< [m] what is nearer may touch

  Contact contactWith(Contact c) const {
    c.gap_start = start;
    c.particle = {a, b, 0, 0};
    c.count = 2;
    c.ragdoll = ragdoll;
    c.give = give;
    return c;
  }
};

/// [m] Gap at the start of what is at `share` of the stick now: there where the stick was over the
/// same place of the obstacle, as it may have slid along itself.
double gapAtStart(const StickSearch& k, double share) {
  const Vec3 along = k.at_start.b - k.at_start.a;
  const double over = along.dot(k.axis.at(share) - k.at_start.a) / along.squaredNorm();
  return k.at_start.gap(std::clamp(over, 0.0, 1.0));
}

/// Contacts of a capsule between its ends, each with the plane that is tangent there. Where it
/// rolls over an edge the place goes along, and with it its gap; and where that comes to an end of
/// the capsule it still presses, or the end would strike.
void placeContacts(const SweptObstacle& m, const StickSearch& k, std::vector<Contact>& contacts) {
  const StickPlaces places = placesOf(k.axis, k.give, k.reach);
  std::optional<StickPlaces> before;  // of most sticks an end is nearest, and nobody asks
  for (int i = 0; i < (places.flat ? 2 : 1); ++i) {
    const double share = places.at[i];
    const bool touches = isResting(k.start);
    if (!touches && !isBetweenEnds(share)) continue;
    if (!before) before = placesOf(k.at_start, k.give, k.reach);
    if (!isBetweenEnds(share) && !isBetweenEnds(before->at[before->flat ? i : 0])) continue;
    Contact c = k.contactWith(tangentAt(m, k.axis, share));
    c.weight = {1 - share, share, 0, 0};
    const std::optional<double> from = placeBefore(*before, places, i);
    if (k.start >= -kGapResolution)
      c.gap_start = from ? k.at_start.gap(*from) : gapAtStart(k, share);
    if (from && touchesAtStart(k.give, c.gap_start)) setStart(m, k.at_start, *from, c);
    // Taken as it starts, its place is not followed: its ends are hit by themselves. So are those
    // of what gives way, as far as dropDeeperEnds leaves them.
    if (c.isSoft() || (k.axis.a == k.at_start.a && k.axis.b == k.at_start.b)) c.has_end = {};
    c.runs = touches && !from && !c.isSoft();
    contacts.push_back(c);
  }
}

/// The contact of a stick that presses so: the tangent plane, by the springs of both ends together.
Contact springAt(const SweptObstacle& m, const StickSearch& k, const StickEnds& ends,
                 const StickPress& press) {
  const double t = press.at, scale = 1 / press.share;
  const Vec3 p = k.axis.at(t);
  const double radius = k.axis.radius(t);
  Contact c = k.contactWith(planeAt(m, p, {radius - scale * press.depth, press.normal}, radius));
  c.weight = {1 - t, t, 0, 0};
  c.give = {scale * scale * ends.complianceAt(t), ends.dampingAt(t) / (scale * scale)};
  return c;
}

/// What its springs held at the start, where it pressed so.
void setSpringStart(const SweptObstacle& m, const StickSearch& k, const StickEnds& ends,
                    const StickPress& before, Contact& c) {
  if (before.depth > 0) c.gap_start = -c.give.compliance * before.share * before.force(ends);
  if (!touchesAtStart(k.give, k.start)) return;
  c.start_normal = m.R0 * before.normal;
  c.start_weight = {1 - before.at, before.at, 0, 0};
  const Vec3 arm = k.at_start.at(before.at) - k.at_start.radius(before.at) * before.normal;
  c.surface_start = surfaceAt(m, m.R0 * arm, c.surface_motion);
  c.touches_at_start = c.start_normal.dot(c.normal) > kSameSide;
}

/// Where it lies flat both springs have the plane each, so that it does not rock freely.
void flatSprings(const SweptObstacle& m, const StickSearch& k, const StickEnds& ends,
                 const StickPress& press, const StickPress& before,
                 std::vector<Contact>& contacts) {
  Contact c = springAt(m, k, ends, press);
  setSpringStart(m, k, ends, before, c);
  const double offset = c.offset - k.axis.radius(press.at), force = before.force(ends);
  for (int i = 0; i < 2; ++i) {
    c.weight = c.start_weight = {1.0 - i, 1.0 * i, 0, 0};
    c.give = i == 0 ? ends.a : ends.b;
    c.offset = offset + (i == 0 ? k.axis.ra : k.axis.rb);
    if (before.depth > 0)
      c.gap_start = -(i == 0 ? 1 - before.at : before.at) * force * c.give.compliance;
    contacts.push_back(c);
  }
}

/// Contacts of a capsule that gives way on a box, where it presses between its ends.
void springContacts(const SweptObstacle& m, const StickSearch& k, const StickEnds& ends,
                    std::vector<Contact>& contacts) {
  const StickPress before = pressOf(k.at_start, ends);
  StickPress press = pressOf(k.axis, ends);
  if (press.depth <= 0 && before.depth > 0) press = pressedAt(k.axis, before);  // it leaves
  if (!press.between) return;
  if (press.flat) {
    flatSprings(m, k, ends, press, before, contacts);
    return;
  }
  Contact c = springAt(m, k, ends, press);
  setSpringStart(m, k, ends, before, c);
  contacts.push_back(c);
}

void stickContacts(const Model& model, const SweptObstacle& m, const StickSearch& k,
                   std::vector<Contact>& contacts) {
  if (restsOnEnds(model, *m.obstacle, k.give))
    springContacts(m, k, endsOf(model, *m.obstacle, model.ragdolls[k.ragdoll], k.a, k.b, k.give),
                   contacts);
  else
    placeContacts(m, k, contacts);
}

Bounds sweptBounds(const Points& x0, const Points& x1, int first, int n, double radius) {
  const auto a = x0.middleCols(first, n), b = x1.middleCols(first, n);
  return {a.rowwise().minCoeff().cwiseMin(b.rowwise().minCoeff()).array() - radius,
          a.rowwise().maxCoeff().cwiseMax(b.rowwise().maxCoeff()).array() + radius};
}

/// Whether a particle is too far from a solid that stands still to be in touch on its straight way.
bool passesBy(const SweptObstacle& m, const Vec3& x0, const Vec3& x1, double radius,
              double margin) {
  if (m.obstacle->type == ObstacleSpec::Type::kPlane || m.moves) return false;
  const double pad = radius + kGapResolution;  // more than rounding
  return !overlap({x0.cwiseMin(x1).array() - pad, x0.cwiseMax(x1).array() + pad}, m.bounds, margin);
}

void particleAgainst(const Model& model, const Points& x0, const Points& x1, int index, int i,
                     const SweptObstacle& m, double margin, std::vector<Contact>& contacts) {
  const Ragdoll& r = model.ragdolls[index];
  const Skeleton& s = model.skeletonOf(r);
  const int at = r.first + i;
  const Compliance give = giveOf(model, *m.obstacle, r, s.particle_contact, i);
  Contact c;
  bool found;
  particleContact(m, x0.col(at), x1.col(at), model.radius[at], give, margin, c, found);
  // Nothing pushes what a pin holds.
  if (!found || model.systemOf(r).direct.W(i, i) == 0) return;
  c.particle[0] = at;
  c.weight[0] = 1;
  c.count = 1;
  c.ragdoll = index;
  contacts.push_back(c);
}

/// Whether its contacts may give way.
bool stickAgainst(const Model& model, const Points& x0, const Points& x1, int index, int j,
                  const SweptObstacle& m, double margin, std::vector<Contact>& contacts) {
  const Ragdoll& r = model.ragdolls[index];
  const Skeleton& s = model.skeletonOf(r);
  const int a = r.first + s.sticks[j].a, b = r.first + s.sticks[j].b;
  const double ra = model.radius[a], rb = model.radius[b];
  const Axis at_start{*m.obstacle, m.toStart(x0.col(a)), m.toStart(x0.col(b)), ra, rb};
  const Axis at_end{*m.obstacle, m.toEnd(x1.col(a)), m.toEnd(x1.col(b)), ra, rb};
  double start = 0;
  const std::optional<Axis> axis = touching(at_start, at_end, margin, start);
  if (!axis) return false;
  const Compliance give = giveOf(model, *m.obstacle, r, s.stick_contact, j);
  // What is in touch all along gives way as it ends, however far that is.
  const bool stays =
      restsOnEnds(model, *m.obstacle, give) && start <= kResting && at_end.gap(nearest(at_end)) < 0;
  const double reach = travelOf(at_start, at_end) + margin;
  stickContacts(model, m, {stays ? at_end : *axis, at_start, start, a, b, index, give, reach},
                contacts);
  return m.obstacle->type == ObstacleSpec::Type::kBox ? restsOnEnds(model, *m.obstacle, give)
                                                      : give.compliance > 0;
}

void ragdollAgainst(const Model& model, const Points& x0, const Points& x1, int index,
                    const SweptObstacle& m, double margin, std::vector<Contact>& contacts) {
  const Ragdoll& r = model.ragdolls[index];
  const Skeleton& s = model.skeletonOf(r);
  const std::size_t begin = contacts.size();
  bool any_soft = false;
  for (int i = 0; i < s.named; ++i)
    if (!passesBy(m, x0.col(r.first + i), x1.col(r.first + i), model.radius[r.first + i], margin))
      particleAgainst(model, x0, x1, index, i, m, margin, contacts);
  if (m.obstacle->type == ObstacleSpec::Type::kPlane) return;  // a capsule's lowest point is an end
  for (std::size_t j = 0; j < s.sticks.size(); ++j) {
    const Stick& k = s.sticks[j];
    if (k.a >= s.named || k.b >= s.named) continue;
    const int a = r.first + k.a, b = r.first + k.b;
    const auto a0 = x0.col(a), b0 = x0.col(b), a1 = x1.col(a), b1 = x1.col(b);
    const double pad = std::max(model.radius[a], model.radius[b]);
    const Bounds bounds{a0.cwiseMin(b0).cwiseMin(a1).cwiseMin(b1).array() - pad,
                        a0.cwiseMax(b0).cwiseMax(a1).cwiseMax(b1).array() + pad};
    if (!overlap(bounds, m.bounds, margin)) continue;
    any_soft =
        stickAgainst(model, x0, x1, index, static_cast<int>(j), m, margin, contacts) || any_soft;
  }
  dropEndsOfSticks(begin, contacts);
  if (!any_soft) return;
  if (m.obstacle->type == ObstacleSpec::Type::kBox)
    shareSprings(model, *m.obstacle, r, begin, contacts);
  else
    dropDeeperEnds(begin, contacts);
}

}  // namespace

SweptObstacle sweepObstacle(const Obstacle& o, const Pose& start, const Pose& end) {
  const bool turns = start.orientation.coeffs() != end.orientation.coeffs();
  SweptObstacle m{&o,
                  -1,
                  start.orientation.toRotationMatrix(),
                  end.orientation.toRotationMatrix(),
                  start.position,
                  end.position,
                  {},
                  turns || start.position != end.position};
  if (turns) {  // the short way, as slerp
    const Eigen::AngleAxisd turn(end.orientation * start.orientation.conjugate());
    m.turn = turn.angle() * turn.axis();
  }
  if (o.type == ObstacleSpec::Type::kPlane) {
    m.bounds = {Vec3::Constant(-std::numeric_limits<double>::infinity()),
                Vec3::Constant(std::numeric_limits<double>::infinity())};
  } else {
    const Vec3 e0 = halfExtent(o, m.R0), e1 = halfExtent(o, m.R1);
    m.bounds = {(m.p0 - e0).cwiseMin(m.p1 - e1), (m.p0 + e0).cwiseMax(m.p1 + e1)};
  }
  return m;
}

void sweepObstacles(const Model& model, const State& state, const std::vector<Pose>& end,
                    std::vector<SweptObstacle>& obstacles) {
  obstacles.clear();
  for (std::size_t k = 0; k < model.obstacles.size(); ++k) {
    obstacles.push_back(sweepObstacle(model.obstacles[k], state.obstacles[k],
                                      end.empty() ? state.obstacles[k] : end[k]));
    obstacles.back().index = static_cast<int>(k);
  }
}

void appendContacts(const Model& model, const std::vector<SweptObstacle>& obstacles,
                    const Points& x0, const Points& x1, int ragdoll, double margin,
                    std::vector<Contact>& contacts) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const int n = model.skeletonOf(r).size();
  const double radius = model.radius.segment(r.first, n).maxCoeff();
  const Bounds bounds = sweptBounds(x0, x1, r.first, n, radius);
  for (const SweptObstacle& m : obstacles)
    if (m.obstacle->type == ObstacleSpec::Type::kPlane || overlap(bounds, m.bounds, margin))
      ragdollAgainst(model, x0, x1, ragdoll, m, margin, contacts);
}

void appendParticleContact(const Model& model, const SweptObstacle& obstacle, const Points& x0,
                           const Points& x1, int ragdoll, int particle, double margin,
                           std::vector<Contact>& contacts) {
  particleAgainst(model, x0, x1, ragdoll, particle, obstacle, margin, contacts);
}

void appendStickContacts(const Model& model, const SweptObstacle& obstacle, const Points& x0,
                         const Points& x1, int ragdoll, int stick, double margin,
                         std::vector<Contact>& contacts) {
  stickAgainst(model, x0, x1, ragdoll, stick, obstacle, margin, contacts);
}

void appendStickOverlaps(const Model& model, const std::vector<SweptObstacle>& obstacles,
                         const Points& x0, const Points& x1, int ragdoll, double depth,
                         std::vector<Contact>& contacts) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  const double radius = model.radius.segment(r.first, s.named).maxCoeff();
  const Bounds bounds = sweptBounds(x1, x1, r.first, s.named, radius);
  for (const SweptObstacle& m : obstacles) {
    if (m.obstacle->type == ObstacleSpec::Type::kPlane || !overlap(bounds, m.bounds)) continue;
    for (std::size_t j = 0; j < s.sticks.size(); ++j) {
      const Stick& k = s.sticks[j];
      if (k.a >= s.named || k.b >= s.named) continue;
      const int a = r.first + k.a, b = r.first + k.b;
      const double ra = model.radius[a], rb = model.radius[b], pad = std::max(ra, rb);
      const Vec3 p = x1.col(a), q = x1.col(b);
      if (!overlap({p.cwiseMin(q).array() - pad, p.cwiseMax(q).array() + pad}, m.bounds)) continue;
      const Axis axis{*m.obstacle, m.toEnd(p), m.toEnd(q), ra, rb};
      const double t = nearest(axis), gap = axis.gap(t);
      if (gap >= -depth || gap <= -axis.radius(t)) continue;
      const Compliance give = giveOf(model, *m.obstacle, r, s.stick_contact, j);
      if (restsOnEnds(model, *m.obstacle, give)) continue;  // its springs are known
      const Axis at_start{*m.obstacle, m.toStart(x0.col(a)), m.toStart(x0.col(b)), ra, rb};
      const double start = at_start.gap(nearest(at_start));
      stickContacts(model, m,
                    {axis, at_start, start, a, b, ragdoll, give, travelOf(at_start, axis)},
                    contacts);
    }
  }
}

double stickGap(const Obstacle& obstacle, const Vec3& a, const Vec3& b, double ra, double rb) {
  const Axis axis{obstacle, a, b, ra, rb};
  return axis.gap(nearest(axis));
}

void findContacts(const Model& model, const State& state, const Points& predicted,
                  const std::vector<Pose>& obstacle_end, double margin,
                  std::vector<SweptObstacle>& obstacles, std::vector<Contact>& contacts) {
  contacts.clear();
  sweepObstacles(model, state, obstacle_end, obstacles);
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    if (!state.asleep[i])
      appendContacts(model, obstacles, state.x, predicted, static_cast<int>(i), margin, contacts);
}

}  // namespace ragdoll
