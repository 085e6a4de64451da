#include "core/direct/mode_obstacles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/compliance.h"
#include "core/contact/constants.h"
#include "core/contact/detect.h"
#include "core/contact/stick_springs.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_rows.h"
#include "core/direct/moving_obstacles.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using ModeKind = ModeRow::Kind;

Eigen::Map<const Vec3> at(const double* x, int i) { return Eigen::Map<const Vec3>(x + 3 * i); }

/// A point or an axis near an obstacle, in its frame: u leads from the obstacle's core to the
/// nearest place, in the directions beside the core alone.
struct Near {
  Vec3 u = Vec3::Zero(), beside = Vec3::Zero(), normal = Vec3::UnitZ();
  std::array<int, 3> feature{};
  double distance = 0;  ///< from the core; of a plane from its surface
};

Near nearOf(const Obstacle& o, const Vec3& p) {
  Near near;
  if (o.type == ObstacleSpec::Type::kPlane) {
    near.distance = p.z();
    return near;
  }
  for (int k = 0; k < 3; ++k) {
    if (std::abs(p[k]) < o.half[k]) continue;
    const double side = p[k] < 0 ? -1 : 1;
    near.feature[k] = o.half[k] > 0 ? static_cast<int>(side) : 0;
    near.beside[k] = 1;
    near.u[k] = p[k] - side * o.half[k];
  }
  near.distance = near.u.norm();
  if (near.distance > 0) near.normal = near.u / near.distance;
  return near;
}

const SweptObstacle& sweptOf(const Body& body, const ModeRow& row) {
  return body.context->ws.obstacles[row.obstacle];
}

const Obstacle& obstacleOf(const Body& body, const ModeRow& row) {
  return *sweptOf(body, row).obstacle;
}

/// The row's obstacle when the body is at x.
ObstacleMotion obstacleAt(const Body& body, const ModeRow& row, const double* x) {
  return motionAt(sweptOf(body, row), x[clockPlace(body.n)], body.context->h);
}

bool restsOnEnds(const Body& body, const ModeRow& row) {
  return row.kind == ModeKind::kStick &&
         restsOnEnds(body.context->model, obstacleOf(body, row), row.give);
}

StickEnds endsOf(const Body& body, const ModeRow& stick) {
  return endsOf(body.context->model, obstacleOf(body, stick), *body.ragdoll, body.first + stick.a,
                body.first + stick.b, stick.give);
}

/// A stick in the obstacle's frame.
Axis axisOf(const ObstacleMotion& m, const ModeRow& row, const double* x) {
  return {*m.obstacle, m.toFrame(at(x, row.a)), m.toFrame(at(x, row.b)), row.ra, row.rb};
}

/// A stick that gives way.
StickPress pressOf(const Body& body, const ModeRow& row, const double* x) {
  return pressOf(axisOf(obstacleAt(body, row, x), row, x), endsOf(body, row));
}

Vec3 pointOf(const ModeRow& row, const double* x, double t) {
  if (row.kind == ModeKind::kParticle) return at(x, row.a);
  return (1 - t) * at(x, row.a) + t * at(x, row.b);
}

/// Where the row is nearest to its obstacle: on a stick the share t, and what is there.
struct Nearest {
  double t = 0;
  Near near;
};

/// From the stick's ends, where the particles press; beyond them they have another speed.
double roomOnStick(double t) { return std::min(t, 1 - t) - kPlaceNoise; }

/// visit(k, side, t): where a stick goes, between its ends, past the border of a box on one side
/// (-1, 1) of its axis k.
template <class Visit>
void visitBorders(const Axis& axis, const Visit& visit) {
  if (axis.obstacle.type != ObstacleSpec::Type::kBox) return;
  for (int k = 0; k < 3; ++k)
    for (const int side : {-1, 1}) {
      const double t = (side * axis.obstacle.half[k] - axis.a[k]) / (axis.b[k] - axis.a[k]);
      if (roomOnStick(t) > 0) visit(k, side, t);
    }
}

/// A stick that lies flat on a box's face, beyond an edge of it, is as near all over the face. It
/// touches at that edge, on which it would tip; its particles are rows of their own. place: over
/// the face.
void takeEdgeOfFace(const Axis& axis, Nearest& place) {
  const auto isFace = [&place] { return place.near.beside.sum() == 1; };
  if (!isFace()) return;
  const double limit = axis.gap(place.t) + kClosedGap;
  visitBorders(axis, [&](int k, int side, double t) {
    if (!isFace() || place.near.beside[k] != 0 || axis.gap(t) > limit) return;
    place.t = t;
    place.near = nearOf(axis.obstacle, axis.at(t));
    place.near.beside[k] = 1;
    place.near.feature[k] = side;
  });
}

Nearest nearestOf(const Body& body, const ModeRow& row, const double* x) {
  const ObstacleMotion m = obstacleAt(body, row, x);
  Nearest place;
  const bool on_ends = restsOnEnds(body, row);
  if (on_ends)
    place.t = pressOf(body, row, x).at;
  else if (row.kind == ModeKind::kStick)
    place.t = nearest(axisOf(m, row, x));
  place.near = nearOf(*m.obstacle, m.toFrame(pointOf(row, x, place.t)));
  if (row.kind == ModeKind::kStick && !on_ends) takeEdgeOfFace(axisOf(m, row, x), place);
  return place;
}

/// visit(stick): of each stick that ends at a row's particle, its row with the same obstacle.
template <class Visit>
void visitSticksAt(const Body& body, const ModeRow& particle, const Visit& visit) {
  const Model& model = body.context->model;
  const Skeleton& s = *body.skeleton;
  for (std::size_t i = 0; i < s.sticks.size(); ++i) {
    const Stick& k = s.sticks[i];
    if ((k.a != particle.a && k.b != particle.a) || k.a >= s.named || k.b >= s.named) continue;
    ModeRow stick = particle;
    stick.kind = ModeKind::kStick;
    stick.give = giveOf(model, obstacleOf(body, particle), *body.ragdoll, s.stick_contact, i);
    stick.a = k.a;
    stick.b = k.b;
    stick.ra = model.radius[body.first + k.a];
    stick.rb = model.radius[body.first + k.b];
    visit(stick);
  }
}

/// Of a particle's spring, whether a stick's takes its place (dropDeeperEnds in detect.cpp): by how
/// much that is deepest between its ends, and this end deeper than the other; negative: it does
/// not.
double roundCover(const Body& body, const ModeRow& row, const double* x) {
  double cover = -1;
  const ObstacleSpec::Type type = obstacleOf(body, row).type;
  if (type == ObstacleSpec::Type::kPlane || type == ObstacleSpec::Type::kBox) return cover;
  visitSticksAt(body, row, [&](const ModeRow& stick) {
    if (!stick.isSoft()) return;
    ModeRow other = row;
    other.a = other.b = stick.a == row.a ? stick.b : stick.a;
    other.ra = other.rb = stick.a == row.a ? stick.rb : stick.ra;
    const double deeper = gapToObstacle(body, other, x) - gapToObstacle(body, row, x);
    cover = std::max(cover, std::min(roomOnStick(nearestOf(body, stick, x).t), deeper));
  });
  return cover;
}

/// How far a stick's own contact is from being that of its ends.
double roomOnStick(const StickPress& press) {
  return press.depth > 0 ? std::min(roomOnStick(press.at), press.excess - kEndOfStick)
                         : roomOnStick(press.at);
}

/// What sticks that press between their ends take of a particle's spring.
struct Cover {
  double room = std::numeric_limits<double>::infinity();  ///< until one of them does not
  int all = 0, taken = 0;
};

Cover coverOf(const Body& body, const ModeRow& row, const double* x) {
  Cover cover;
  if (row.kind != ModeKind::kParticle || obstacleOf(body, row).type != ObstacleSpec::Type::kBox)
    return cover;
  visitSticksAt(body, row, [&](const ModeRow& stick) {
    if (!restsOnEnds(body, stick)) return;
    const StickPress press = pressOf(body, stick, x);
    ++cover.all;
    if (press.depth > 0 && press.between) ++cover.taken;
    cover.room = std::min(cover.room, press.depth > 0 ? roomOnStick(press) : -1.0);
  });
  return cover;
}

/// Of a particle's spring, whether sticks take all of it: by how much; negative: they do not.
double roomUnder(const Body& body, const ModeRow& row, const double* x) {
  if (obstacleOf(body, row).type != ObstacleSpec::Type::kBox) return roundCover(body, row, x);
  const Cover cover = coverOf(body, row, x);
  return cover.all > 0 ? cover.room : -1.0;
}

/// How a row's particles move seen from its obstacle, which may turn, at x, v: velocities beside
/// the surface's, and what they change by if nothing accelerates the particles: `turning` while the
/// frame's directions are kept, `curving` in the frame itself.
struct SeenMotion {
  Vec3 a, b;                  ///< [m/s]
  Vec3 turning_a, turning_b;  ///< [m/s^2]
  Vec3 curving_a, curving_b;  ///< [m/s^2]

  SeenMotion(const ObstacleMotion& m, const ModeRow& row, const double* x, const double* v)
      : a(at(v, row.a)),
        b(at(v, row.b)),
        turning_a(Vec3::Zero()),
        turning_b(Vec3::Zero()),
        curving_a(Vec3::Zero()),
        curving_b(Vec3::Zero()) {
    if (!m.moves) return;
    turning_a = -m.spin.cross(a - m.speed);
    turning_b = -m.spin.cross(b - m.speed);
    a -= m.velocityAt(at(x, row.a));
    b -= m.velocityAt(at(x, row.b));
    curving_a = turning_a - m.spin.cross(a);
    curving_b = turning_b - m.spin.cross(b);
  }
  Vec3 along(double t) const { return (1 - t) * a + t * b; }
  Vec3 turningAt(double t) const { return (1 - t) * turning_a + t * turning_b; }
  Vec3 curvingAt(double t) const { return (1 - t) * curving_a + t * curving_b; }
};

/// [m/s^2] What the turn of the normal takes from the acceleration along the surface, where the gap
/// changes, and what the surface's own motion does, where it turns. moves: [m/s] the place on the
/// axis in the obstacle's frame.
Vec3 normalTurn(const ModeRow& row, const ObstacleMotion& m, const Near& near, const Vec3& moves) {
  const Vec3 beside = near.beside.cwiseProduct(moves);
  const double opens = near.normal.dot(moves);
  if (!m.moves && !row.isSoft()) return Vec3::Zero();
  if (!m.moves) return m.R * (-opens / near.distance * tangentialPart(beside, near.normal));
  const Vec3 n = m.R * near.normal;
  Vec3 turns = m.spin.cross(n);
  if (near.distance > 0) turns += m.R * (tangentialPart(beside, near.normal) / near.distance);
  const double arm = near.distance - m.obstacle->radius;
  return m.spin.cross(arm * turns + opens * n) - opens * turns;
}

/// How the place of a stick that gives way moves along it.
double shiftOf(const Body& body, const ModeRow& row, const double* x, const double* v) {
  const ObstacleMotion m = obstacleAt(body, row, x);
  const SeenMotion seen(m, row, x, v);
  const double speed = std::max(seen.a.norm(), seen.b.norm());
  if (!(speed > 0)) return 0;
  const double e = kDifference / speed;
  const StickEnds ends = endsOf(body, row);
  const auto placeAfter = [&](double t) {
    return pressOf({*m.obstacle, m.toFrame(at(x, row.a) + t * seen.a),
                    m.toFrame(at(x, row.b) + t * seen.b), row.ra, row.rb},
                   ends)
        .at;
  };
  return (placeAfter(e) - placeAfter(-e)) / (2 * e);
}

/// The gap of a capsule is the least of |u(t)| - r(t) along it: its second derivative has a part
/// from how the nearest place moves.
void curveStick(const ModeRow& row, const ObstacleMotion& m, const Near& near, const double* x,
                const SeenMotion& seen, double t, RowPlace& place) {
  const Eigen::Matrix3d toFrame = m.R.transpose();
  const Vec3 n = near.normal;
  const Vec3 axis = near.beside.cwiseProduct(toFrame * (at(x, row.b) - at(x, row.a)));
  const Vec3 turning = near.beside.cwiseProduct(toFrame * (seen.b - seen.a));
  const Vec3 rate = near.beside.cwiseProduct(toFrame * seen.along(t));
  const double L = near.distance;
  const double tt = (axis.squaredNorm() - std::pow(n.dot(axis), 2)) / L;
  const double st = (axis.dot(rate) - n.dot(axis) * n.dot(rate)) / L + n.dot(turning);
  place.regular = tt > kFlatCurvature;
  if (!place.regular) return;
  const double shift = -st / tt;
  place.curvature = (rate.squaredNorm() - std::pow(n.dot(rate), 2)) / L - st * st / tt;
  place.turn = shift * (seen.b - seen.a) + normalTurn(row, m, near, rate + shift * axis);
}

/// How the row gives way at place.at; and whether it is between a stick's ends.
void giveWay(const Body& body, const ModeRow& row, const double* x, RowPlace& place) {
  Compliance& give = place.contact.give = row.give;
  place.inside = row.kind != ModeKind::kStick || roomOnStick(place.at) > 0;
  if (restsOnEnds(body, row)) {
    const StickPress press = pressOf(body, row, x);
    const StickEnds ends = endsOf(body, row);
    place.inside = roomOnStick(press) > 0;
    give = {ends.complianceAt(place.at), ends.dampingAt(place.at)};
    // By two springs, which rub and damp apart from each other.
    const bool rests = place.inside && press.flat && (row.friction > 0 || give.damping > 0);
    place.regular = place.regular && !rests;
  } else if (row.isSoft() && row.kind == ModeKind::kParticle) {
    const Cover cover = coverOf(body, row, x);
    const int left = std::max(1, cover.all - cover.taken);
    if (cover.taken > 0)
      give = {give.compliance * cover.all / left, give.damping * left / cover.all};
  }
}

/// What its turn takes along the surface, of a stick on the springs of its ends.
Vec3 springTurn(const Body& body, const ModeRow& row, const ObstacleMotion& m, const Near& near,
                const double* x, const double* v, double t) {
  const SeenMotion seen(m, row, x, v);
  const double shift = shiftOf(body, row, x, v);
  const Vec3 rate = m.R.transpose() * (seen.along(t) + shift * (at(x, row.b) - at(x, row.a)));
  return shift * (seen.b - seen.a) + normalTurn(row, m, near, rate);
}

/// place.curvature and place.turn.
void curve(const Body& body, const ModeRow& row, const ObstacleMotion& m, const Near& near,
           const double* x, const double* v, RowPlace& place) {
  const bool plane = m.obstacle->type == ObstacleSpec::Type::kPlane;
  if ((plane && !m.moves) || !place.regular) return;
  const SeenMotion seen(m, row, x, v);
  if (!plane && restsOnEnds(body, row)) {
    place.turn = springTurn(body, row, m, near, x, v, place.at);
  } else if (!plane && row.kind == ModeKind::kStick) {
    curveStick(row, m, near, x, seen, place.at, place);
  } else {
    const Vec3 rate = near.beside.cwiseProduct(m.R.transpose() * seen.a);
    if (!plane)
      place.curvature = (rate.squaredNorm() - std::pow(near.normal.dot(rate), 2)) / near.distance;
    place.turn = normalTurn(row, m, near, plane ? Vec3(m.R.transpose() * seen.a) : rate);
  }
  if (!m.moves) return;
  place.curvature += place.contact.normal.dot(seen.curvingAt(place.at));
  place.turn += seen.turningAt(place.at);
}

}  // namespace

RowPlace placeOnObstacle(const Body& body, const ModeRow& row, const double* x, const double* v,
                         bool curvature) {
  RowPlace place;
  const ObstacleMotion m = obstacleAt(body, row, x);
  const auto [t, near] = nearestOf(body, row, x);
  const Vec3 point = pointOf(row, x, t);
  const double radius = (1 - t) * row.ra + t * row.rb;
  place.gap = near.distance - m.obstacle->radius - radius;
  place.feature = near.feature;
  place.at = t;
  place.regular = m.obstacle->type == ObstacleSpec::Type::kPlane || near.distance > kMinLength;
  Contact& c = place.contact;
  c.normal = m.R * near.normal;
  c.particle = {body.first + row.a, body.first + row.b, 0, 0};
  c.weight = {1 - t, t, 0, 0};
  c.count = row.kind == ModeKind::kStick ? 2 : 1;
  c.friction = row.friction;
  c.restitution = row.restitution;
  giveWay(body, row, x, place);
  c.ragdoll = body.index;
  c.obstacle = sweptOf(body, row).index;
  c.offset = c.found = c.normal.dot(point) - place.gap;
  if (m.moves) {
    place.surface = m.velocityAt(point - (near.distance - m.obstacle->radius) * c.normal);
    c.surface_motion = c.surface_start = c.surface_end = body.context->h * place.surface;
  }
  if (curvature) curve(body, row, m, near, x, v, place);
  return place;
}

double gapToObstacle(const Body& body, const ModeRow& row, const double* x) {
  const auto [t, near] = nearestOf(body, row, x);
  return near.distance - obstacleOf(body, row).radius - ((1 - t) * row.ra + t * row.rb);
}

double roomOnObstacle(const Body& body, const ModeRow& row, const double* x,
                      const std::array<int, 3>& feature) {
  double room = std::numeric_limits<double>::infinity();
  const ObstacleMotion m = obstacleAt(body, row, x);
  const bool is_plane = m.obstacle->type == ObstacleSpec::Type::kPlane;
  const double t = nearestOf(body, row, x).t;
  if (restsOnEnds(body, row)) {
    room = roomOnStick(pressOf(body, row, x));
  } else if (row.kind == ModeKind::kStick) {
    room = roomOnStick(t);
    if (!(room > 0) && !is_plane)  // how far its place is beyond the end
      room = std::min(room, roomOnStick(nearestTo(axisOf(m, row, x), feature, kBeyondEnd)));
  } else if (row.isSoft()) {
    room = -roomUnder(body, row, x);
  }
  if (is_plane) return room;
  const Vec3 p = m.toFrame(pointOf(row, x, t));
  for (int k = 0; k < 3; ++k) {
    if (m.obstacle->half[k] == 0) continue;
    const double beyond = feature[k] == 0 ? m.obstacle->half[k] - std::abs(p[k])
                                          : feature[k] * p[k] - m.obstacle->half[k];
    room = std::min(room, beyond);
  }
  return room;
}

double shiftedRate(const Body& body, const ModeRow& row, const RowPlace& place, const double* x,
                   const double* v) {
  if (!restsOnEnds(body, row) || !(place.contact.give.damping > 0)) return 0;
  const StickEnds ends = endsOf(body, row);
  const double t = place.at, c = ends.complianceAt(t);
  const double slope = (t * ends.b.compliance - (1 - t) * ends.a.compliance) / c;
  return place.gap * slope * shiftOf(body, row, x, v);
}

double openingElsewhere(const Body& body, const ModeRow& row, const RowPlace& place,
                        const double* x) {
  if (row.kind == ModeKind::kParticle) return roomUnder(body, row, x);
  return -(restsOnEnds(body, row) ? roomOnStick(pressOf(body, row, x)) : roomOnStick(place.at));
}

bool liesAcross(const Body& body, const ModeRow& row, const double* x) {
  std::array<int, 3> edges{};
  const Axis axis = axisOf(obstacleAt(body, row, x), row, x);
  visitBorders(axis, [&](int k, int, double t) { edges[k] += std::abs(axis.gap(t)) < kTouching; });
  return *std::max_element(edges.begin(), edges.end()) > 1;
}

namespace {

/// Whether a stick touches beside one edge or corner, or what is round, up to an end of it.
bool touchesUpTo(const Axis& axis, double end) {
  const double t = nearest(axis);
  return roomOnStick(t) > 0 && axis.gap(t) < kClosedGap && isRoundTo(axis, t, end);
}

/// Whether a stick's place is at that end of it.
bool isAt(const Axis& axis, double end) { return std::abs(nearest(axis) - end) <= kPlaceNoise; }

/// Whether some(stick's axis at x, and at x2, the end) of a stick at a hard particle beside what is
/// not flat all over.
template <class Some>
bool anyStickAt(const Island& island, const ModeRow& row, const double* x, const double* x2,
                const Some& some) {
  const Body& body = *island.bodies[row.body];
  if (row.kind != ModeKind::kParticle || row.isSoft() ||
      obstacleOf(body, row).type == ObstacleSpec::Type::kPlane)
    return false;
  const int offset = island.s.mode.offset[row.body];
  const ObstacleMotion now = obstacleAt(body, row, x + offset);
  const ObstacleMotion then = obstacleAt(body, row, x2 + offset);
  bool any = false;
  visitSticksAt(body, row, [&](const ModeRow& stick) {
    any = any || some(axisOf(now, stick, x + offset), axisOf(then, stick, x2 + offset),
                      stick.b == row.a ? 1.0 : 0.0);
  });
  return any;
}

}  // namespace

bool isEndOfTouchingStick(const Island& island, const ModeRow& row, const double* x) {
  return anyStickAt(island, row, x, x, [](const Axis& axis, const Axis&, double end) {
    return touchesUpTo(axis, end);
  });
}

bool passesToStick(const Island& island, const ModeRow& row, const double* x, const double* later) {
  return anyStickAt(island, row, x, later, [](const Axis& now, const Axis& then, double end) {
    return touchesUpTo(then, end) && (isAt(now, end) || touchesUpTo(now, end));
  });
}

}  // namespace ragdoll
