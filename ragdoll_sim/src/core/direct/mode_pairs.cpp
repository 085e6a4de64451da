#include "core/direct/mode_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/capsule_pairs.h"
#include "core/contact/compliance.h"
#include "core/contact/constants.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"

namespace ragdoll {
namespace {

/// The ends of both axes at a pose, or their velocities.
struct Ends {
  Vec3 a, b, c, d;

  /// From the second axis's place to the first's.
  Vec3 between(const AxisPoints& at) const { return a + at.s * (b - a) - c - at.t * (d - c); }
};

Ends endsOf(const Island& island, const ModeRow& row, const double* x) {
  const std::vector<int>& offset = island.s.mode.offset;
  const auto at = [&](int body, int particle) {
    return Vec3(Eigen::Map<const Vec3>(x + offset[body] + 3 * particle));
  };
  return {at(row.body, row.a), at(row.body, row.b), at(row.other, row.c), at(row.other, row.d)};
}

/// The gap's derivatives along the axes, by the parameters that a row has: those of its sticks.
struct Along {
  std::array<Vec3, 2> axis;       ///< of the way between the places
  std::array<double, 2> grows{};  ///< [m] radii
  std::array<bool, 2> free{};
  Vec3 normal = Vec3::UnitZ();
  double distance = 0;  ///< [m] of the places

  Along(const ModeRow& row, const Ends& x, const AxisPoints& at)
      : axis{Vec3(x.b - x.a), Vec3(x.c - x.d)},
        grows{row.rb - row.ra, row.rd - row.rc},
        free{row.a != row.b, row.c != row.d} {
    if (row.keepsToFeature())
      for (int k = 0; k < 2; ++k) free[k] = free[k] && row.feature[k] == 0;
    const Vec3 u = x.between(at);
    distance = u.norm();
    if (distance > 0) normal = u / distance;
  }
  double slope(int k) const { return normal.dot(axis[k]) - grows[k]; }
  Eigen::Vector2d slope() const { return {free[0] ? slope(0) : 0.0, free[1] ? slope(1) : 0.0}; }
  /// [m] Of what is no parameter: the identity.
  Eigen::Matrix2d curvature() const {
    Eigen::Matrix2d H = Eigen::Matrix2d::Identity();
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l < 2; ++l)
        if (free[k] && free[l])
          H(k, l) = (axis[k].dot(axis[l]) - normal.dot(axis[k]) * normal.dot(axis[l])) / distance;
    return H;
  }
};

/// [m] Below it axes lie along each other: they have no nearest places.
double leastCurvature(const Eigen::Matrix2d& H) {
  const double mean = 0.5 * (H(0, 0) + H(1, 1)), half = 0.5 * (H(0, 0) - H(1, 1));
  const double large = mean + std::hypot(half, H(0, 1));
  return large > 0 ? (H(0, 0) * H(1, 1) - H(0, 1) * H(1, 0)) / large : 0;
}

bool isBetween(double s) { return s > 0 && s < 1; }

CapsuleAxis firstOf(const ModeRow& row, const Ends& x) { return {x.a, x.b, row.ra, row.rb}; }
CapsuleAxis secondOf(const ModeRow& row, const Ends& x) { return {x.c, x.d, row.rc, row.rd}; }

/// Whether the row is that of one end of an overlap of two sticks along each other.
bool isEndOfOverlap(const ModeRow& row) { return row.feature[2] != 0; }

double footOn(const CapsuleAxis& axis, const Vec3& p) {
  const Vec3 d = axis.b - axis.a;
  return (p - axis.a).dot(d) / d.squaredNorm();
}

/// The places at that end, as capsule_pairs.cpp has them (flatEnds). beyond: as the feet lie, on or
/// beyond the sticks.
AxisPoints overlapEnd(const ModeRow& row, const Ends& x, AxisPoints& beyond) {
  const CapsuleAxis first = firstOf(row, x), second = secondOf(row, x);
  const auto onStick = [&](double s, int stick) {
    if (!row.keepsToFeature()) return std::clamp(s, 0.0, 1.0);
    return row.feature[stick] == 0 ? s : row.feature[stick] > 0 ? 1.0 : 0.0;
  };
  AxisPoints at;
  beyond.s = footOn(first, row.feature[2] == 1 ? x.c : x.d);
  at.s = onStick(beyond.s, 0);
  beyond.t = footOn(second, first.at(at.s));
  at.t = onStick(beyond.t, 1);
  return at;
}

/// Nearest places from `at` on, by Newton's method to rounding where they lie within the sticks.
/// beyond: and beyond them, too.
AxisPoints refined(const ModeRow& row, const Ends& x, AxisPoints at, bool beyond) {
  const double least = beyond ? -kBeyondEnd : 0, most = 1 - least;
  for (int k = 0; k < kPlaceRefinements; ++k) {
    const Along along(row, x, at);
    const bool within = (!along.free[0] || isBetween(at.s)) && (!along.free[1] || isBetween(at.t));
    if (!within && !beyond) return at;
    if (!(along.distance > kMinLength)) return at;
    const Eigen::Matrix2d H = along.curvature();
    if (!(leastCurvature(H) > kFlatPair)) return at;
    const Eigen::Vector2d change = H.inverse() * along.slope();
    const AxisPoints next{std::clamp(at.s - change[0], least, most),
                          std::clamp(at.t - change[1], least, most)};
    const bool settled = change.cwiseAbs().maxCoeff() < kPlaceNoise;
    at = next;
    if (settled) return at;
  }
  return at;
}

/// Nearest places; of what presses and gives way as its feature says, beyond the sticks, too.
AxisPoints placesOf(const ModeRow& row, const Ends& x) {
  AxisPoints beyond;
  if (isEndOfOverlap(row)) return overlapEnd(row, x, beyond);
  AxisPoints at = nearestPoints(firstOf(row, x), secondOf(row, x));
  const bool keeps = row.keepsToFeature();
  if (keeps && row.feature[0] != 0) at.s = row.feature[0] > 0 ? 1 : 0;
  if (keeps && row.feature[1] != 0) at.t = row.feature[1] > 0 ? 1 : 0;
  return refined(row, x, at, keeps);
}

double roomAt(const ModeRow& row, const AxisPoints& at) {
  double room = std::numeric_limits<double>::infinity();
  if (row.a != row.b) room = std::min({room, at.s, 1 - at.s});
  if (row.c != row.d) room = std::min({room, at.t, 1 - at.t});
  return room - kEndOfStick;
}

double gapAt(const ModeRow& row, const Ends& x, const AxisPoints& at) {
  return x.between(at).norm() - (row.ra + at.s * (row.rb - row.ra)) -
         (row.rc + at.t * (row.rd - row.rc)) - row.rest;
}

int endAt(double s) { return s <= 0 ? -1 : s >= 1 ? 1 : 0; }

/// Of what gives way.
std::array<int, 3> featureAt(const ModeRow& row, const AxisPoints& at) {
  if (row.keepsToFeature()) return row.feature;
  return {endAt(at.s), endAt(at.t), row.feature[2]};
}

/// How far what gives way is from leaving its feature.
double roomOnFeature(const ModeRow& row, const Ends& x, const AxisPoints& at) {
  const Along along(row, x, at);
  const std::array<int, 3> feature = featureAt(row, at);
  const std::array<double, 2> places{at.s, at.t};
  AxisPoints foot;
  if (isEndOfOverlap(row)) overlapEnd(row, x, foot);
  const std::array<double, 2> feet{foot.s - 1, foot.t - 1};
  double room = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 2; ++k) {
    const double length = along.axis[k].norm();
    if (!(length > 0)) continue;  // a particle
    if (feature[k] == 0)
      room = std::min({room, places[k], 1 - places[k]});
    else if (isEndOfOverlap(row))
      room = std::min(room, feature[k] > 0 ? feet[k] : -1 - feet[k]);
    else
      room = std::min(room, -feature[k] * along.slope(k) / length);
  }
  return room;
}

/// [1/s] How the places at an end of an overlap move: by differences, as they are nowhere least.
Eigen::Vector2d shiftOfOverlap(const ModeRow& row, const Ends& x, const Ends& v) {
  const double speed = std::max({v.a.norm(), v.b.norm(), v.c.norm(), v.d.norm()});
  if (!(speed > 0)) return Eigen::Vector2d::Zero();
  const double e = kDifference / speed;
  const auto after = [&](double t) {
    const AxisPoints at =
        placesOf(row, {x.a + t * v.a, x.b + t * v.b, x.c + t * v.c, x.d + t * v.d});
    return Eigen::Vector2d(at.s, at.t);
  };
  return (after(e) - after(-e)) / (2 * e);
}

/// The second derivative of the least gap, and how its places move: f_vv - f_pv H^-1 f_pv.
void curve(const ModeRow& row, const Ends& x, const Ends& v, const AxisPoints& at,
           RowPlace& place) {
  const Along along(row, x, at), turning(row, v, at);
  const Vec3 rate = v.between(at), n = along.normal;
  Eigen::Vector2d mixed = Eigen::Vector2d::Zero();
  for (int k = 0; k < 2; ++k)
    if (along.free[k])
      mixed[k] = (along.axis[k].dot(rate) - n.dot(along.axis[k]) * n.dot(rate)) / along.distance +
                 n.dot(turning.axis[k]);
  const Eigen::Vector2d shift = isEndOfOverlap(row)
                                    ? shiftOfOverlap(row, x, v)
                                    : Eigen::Vector2d(-(along.curvature().inverse() * mixed));
  place.curvature =
      (rate.squaredNorm() - std::pow(n.dot(rate), 2)) / along.distance + mixed.dot(shift);
  place.turn = shift[0] * turning.axis[0] + shift[1] * turning.axis[1];
  place.moves = rate + shift[0] * along.axis[0] + shift[1] * along.axis[1];
  if (!row.isSoft()) return;
  // What the turn of the normal takes, as the gap changes.
  place.turn -= n.dot(rate) / along.distance * tangentialPart(place.moves, n);
}

/// Whether two sticks along each other cross in between, so that one of their two springs is at
/// neither end of their overlap.
bool crossBetween(ModeRow row, const Ends& x) {
  const CapsuleAxis first = firstOf(row, x), second = secondOf(row, x);
  row.presses = false;
  double least = std::numeric_limits<double>::infinity();
  for (row.feature[2] = 1; row.feature[2] <= 2; ++row.feature[2])
    least = std::min(least, gapAt(first, second, placesOf(row, x)));
  return gapAt(first, second, nearestPoints(first, second)) < least - kGapResolution;
}

}  // namespace

RowPlace placeOfPair(const Island& island, const ModeRow& row, const double* x, const double* v,
                     bool curvature) {
  const Ends ends = endsOf(island, row, x);
  const AxisPoints at = placesOf(row, ends);
  const Along along(row, ends, at);
  RowPlace place;
  place.gap = gapAt(row, ends, at);
  place.regular = along.distance > kMinLength &&
                  (isEndOfOverlap(row) || leastCurvature(along.curvature()) > kFlatPair);
  if (row.isSoft()) {
    place.inside = lieAlong(firstOf(row, ends), secondOf(row, ends)) == isEndOfOverlap(row);
    place.regular =
        place.regular && place.inside && !(isEndOfOverlap(row) && crossBetween(row, ends));
    place.feature = featureAt(row, at);
  } else {
    place.inside = roomAt(row, at) > 0;
  }
  Contact& c = place.contact;
  const Body &body = *island.bodies[row.body], &other = *island.bodies[row.other];
  c.particle = {body.first + row.a, body.first + row.b, other.first + row.c, other.first + row.d};
  c.weight = {1 - at.s, at.s, at.t - 1, -at.t};
  c.count = 4;
  c.normal = along.normal;
  c.friction = row.friction;
  c.give = row.give;
  c.ragdoll = body.index;
  c.other = row.isShared() ? other.index : -1;
  c.offset = c.found = along.distance - place.gap;
  if (curvature && place.regular) curve(row, ends, endsOf(island, row, v), at, place);
  return place;
}

double gapOfPair(const Island& island, const ModeRow& row, const double* x) {
  const Ends ends = endsOf(island, row, x);
  return gapAt(row, ends, placesOf(row, ends));
}

double roomOfPair(const Island& island, const ModeRow& row, const double* x) {
  const Ends ends = endsOf(island, row, x);
  const AxisPoints at = placesOf(row, ends);
  if (row.isSoft()) return roomOnFeature(row, ends, at);
  const double room = roomAt(row, at);
  // At an end: how far the place is beyond it.
  return room > 0 ? room : std::min(room, roomAt(row, refined(row, ends, at, true)));
}

bool pairHasPressed(const Island& island, const ModeRow& row) {
  const Body &body = *island.bodies[row.body], &other = *island.bodies[row.other];
  const auto isEnd = [](int first, int particle, int a, int b) {
    return first + particle == a || first + particle == b;
  };
  const ImpulseCache& cache = row.isShared() ? island.pairs.cache : body.cache;
  return std::any_of(cache.impulses().begin(), cache.impulses().end(),
                     [&](const CachedImpulse& last) {
                       return isEnd(body.first, row.a, last.a, last.b) &&
                              isEnd(body.first, row.b, last.a, last.b) &&
                              isEnd(other.first, row.c, last.other[0], last.other[1]) &&
                              isEnd(other.first, row.d, last.other[0], last.other[1]);
                     });
}

namespace {

/// Whether the row is among those that begin at `first`.
bool isListed(const std::vector<ModeRow>& rows, std::size_t first, const ModeRow& row) {
  return std::any_of(
      rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), [&](const ModeRow& r) {
        return !r.isSoft() && r.a == row.a && r.b == row.b && r.c == row.c && r.d == row.d;
      });
}

struct PairList {
  Island& island;
  const double reach;       ///< [m]
  const std::size_t first;  ///< among the mode's rows
  bool sound = true;

  /// At the bodies' positions.
  Ends endsAt(const ModeRow& row) const {
    const Body &body = *island.bodies[row.body], &other = *island.bodies[row.other];
    const auto at = [](const Body& of, int particle) { return Vec3(of.x().col(particle)); };
    return {at(body, row.a), at(body, row.b), at(other, row.c), at(other, row.d)};
  }
  /// Adds a row if a motion may reach it. What steps of shake leave of an overlap stays.
  void consider(ModeRow row, int a, int b, int c, int d) {
    const Body &body = *island.bodies[row.body], &other = *island.bodies[row.other];
    const auto radius = [&](const Body& of, int particle) {
      return island.context.model.radius[of.first + particle];
    };
    row.a = a, row.b = b, row.c = c, row.d = d;
    row.ra = radius(body, a), row.rb = radius(body, b);
    row.rc = radius(other, c), row.rd = radius(other, d);
    const Ends x = endsAt(row);
    const double gap = gapAt(row, x, placesOf(row, x));
    if (gap > reach || (!row.isSoft() && isListed(island.s.mode.rows, first, row))) return;
    row.rest = gap < -kTouching && !row.isSoft() ? gap : 0;
    row.gap_start = gap - row.rest;
    sound = sound && (row.isSoft() || gap >= -kSlop);
    island.s.mode.rows.push_back(row);
  }
  /// One where they are nearest, or two where they lie along each other.
  void addSprings(ModeRow row, const Capsule& p, const Capsule& q) {
    const int places = p.a != p.b && q.a != q.b ? 3 : 1;
    for (row.feature[2] = 0; row.feature[2] < places; ++row.feature[2])
      consider(row, p.a, p.b, q.a, q.b);
  }
  /// The rows of two capsules that a motion may bring together: themselves and, of what is rigid,
  /// their ends.
  void add(const ModeRow& row, const Capsule& p, const Capsule& q) {
    const Body &body = *island.bodies[row.body], &other = *island.bodies[row.other];
    const auto at = [](const Body& of, int particle) { return Vec3(of.x().col(particle)); };
    const CapsuleAxis one{at(body, p.a), at(body, p.b), 0, 0},
        two{at(other, q.a), at(other, q.b), 0, 0};
    const double lengths = (one.b - one.a).norm() + (two.b - two.a).norm();
    const double apart = (one.at(0.5) - two.at(0.5)).norm() - 0.5 * lengths;
    const auto widest = [&](const Body& of, const Capsule& c) {
      const Eigen::VectorXd& r = island.context.model.radius;
      return std::max(r[of.first + c.a], r[of.first + c.b]);
    };
    if (apart - widest(body, p) - widest(other, q) > reach) return;
    if (row.isSoft()) return addSprings(row, p, q);
    for (const int i : {p.a, p.b})
      for (const int j : {q.a, q.b}) consider(row, i, i, j, j);
    if (p.a != p.b)
      for (const int j : {q.a, q.b}) consider(row, p.a, p.b, j, j);
    if (q.a != q.b)
      for (const int i : {p.a, p.b}) consider(row, i, i, q.a, q.b);
    if (p.a != p.b && q.a != q.b) consider(row, p.a, p.b, q.a, q.b);
  }
};

Compliance giveBetween(const Body& body, const Body& other, int i, int j) {
  return inSeries(giveOf(*body.ragdoll, body.skeleton->capsule_contact, i),
                  giveOf(*other.ragdoll, other.skeleton->capsule_contact, j));
}

}  // namespace

bool listPairs(Island& island, int body, int other, double reach) {
  const Model& model = island.context.model;
  if (body == other ? !model.self_collision : !model.ragdoll_collision) return true;
  const Body &p = *island.bodies[body], &q = *island.bodies[other];
  PairList list{island, reach, island.s.mode.rows.size()};
  ModeRow row;
  row.kind = ModeRow::Kind::kPair;
  row.body = body;
  row.other = other;
  row.friction = kBodyFriction;
  const auto add = [&](int i, int j) {
    row.give = giveBetween(p, q, i, j);
    list.add(row, p.skeleton->capsules[i], q.skeleton->capsules[j]);
  };
  if (body == other) {
    for (const CapsulePair& pair : p.skeleton->self_pairs) add(pair.first, pair.second);
    return list.sound;
  }
  for (std::size_t i = 0; i < p.skeleton->capsules.size(); ++i)
    for (std::size_t j = 0; j < q.skeleton->capsules.size(); ++j)
      add(static_cast<int>(i), static_cast<int>(j));
  return list.sound;
}

}  // namespace ragdoll
