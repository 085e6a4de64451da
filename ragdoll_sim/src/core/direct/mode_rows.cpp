#include "core/direct/mode_rows.h"

#include <algorithm>
#include <limits>

#include "core/direct/contact_motion.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_limits.h"
#include "core/direct/mode_obstacles.h"
#include "core/direct/mode_pairs.h"
#include "core/limits/limit_value.h"

namespace ragdoll {
namespace {

constexpr double kElsewhere = 1;  ///< [m] the opening of what touches at other rows' places

}  // namespace

RowPlace placeOf(Island& island, const ModeRow& row, const double* x, const double* v,
                 bool curvature) {
  if (row.kind == ModeRow::Kind::kPair) return placeOfPair(island, row, x, v, curvature);
  Body& body = *island.bodies[row.body];
  const int offset = island.s.mode.offset[row.body];
  if (row.isContact()) return placeOnObstacle(body, row, x + offset, v + offset, curvature);
  RowPlace place;
  placeLimit(body, row, x + offset, v + offset, curvature, place);
  return place;
}

double gapOfOwn(const Body& body, const ModeRow& row, const double* x) {
  if (row.kind == ModeRow::Kind::kLimit)
    return limitAtBorder(body.skeleton->limits[row.limit], x, borderOf(row));
  return gapToObstacle(body, row, x);
}

double gapOf(Island& island, const ModeRow& row, const double* x) {
  if (row.kind == ModeRow::Kind::kPair) return gapOfPair(island, row, x);
  return gapOfOwn(*island.bodies[row.body], row, x + island.s.mode.offset[row.body]);
}

double openingRateOf(const Island& island, const ModeRow& row, const RowPlace& place,
                     const double* v) {
  if (row.isContact()) return place.contact.normal.dot(motionOf(island, place.contact, v));
  const Body& body = *island.bodies[row.body];
  return rateOfLimit(body, place.limit, v + island.s.mode.offset[row.body]);
}

double rateOf(const Island& island, const ModeRow& row, const RowPlace& place, const double* v) {
  const double rate = openingRateOf(island, row, place, v);
  return row.isContact() ? rate - place.contact.normal.dot(place.surface) : rate;
}

Vec3 motionOf(const Island& island, const Contact& c, const double* x) {
  Vec3 sum = Vec3::Zero();
  visitMoving(island, c, [&](int k, const Body& body, int i) {
    const double* own = x + island.s.mode.offset[island.placeOf(body.index)];
    sum += c.weight[k] * Eigen::Map<const Vec3>(own + 3 * i);
  });
  return sum;
}

double dampedRate(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
                  const double* v) {
  const double rate = rateOf(island, row, place, v);
  if (row.kind != ModeRow::Kind::kStick) return rate;
  const int offset = island.s.mode.offset[row.body];
  return rate - shiftedRate(*island.bodies[row.body], row, place, x + offset, v + offset);
}

double openingOf(Island& island, const ModeRow& row, const double* x, const double* v) {
  if (!row.isSoft()) return gapOf(island, row, x);
  const Body& body = *island.bodies[row.body];
  const double* own = x + island.s.mode.offset[row.body];
  const RowPlace place = placeOf(island, row, x, v, false);
  const double rate = dampedRate(island, row, place, x, v);
  const Compliance& give = row.isContact() ? place.contact.give : row.give;
  double opening = place.gap + give.compliance * give.damping * std::max(0.0, rate);
  if (row.obstacle >= 0) opening = std::max(opening, openingElsewhere(body, row, place, own));
  if (row.kind == ModeRow::Kind::kPair && !place.inside) opening = std::max(opening, kElsewhere);
  return opening;
}

double roomOf(Island& island, const ModeRow& row, const double* x,
              const std::array<int, 3>& feature) {
  if (row.kind == ModeRow::Kind::kPair) return roomOfPair(island, row, x);
  const Body& body = *island.bodies[row.body];
  const double* own = x + island.s.mode.offset[row.body];
  if (row.isContact()) return roomOnObstacle(body, row, own, feature);
  return feature[0] == 0 ? std::numeric_limits<double>::infinity()
                         : roomAtBorder(body.skeleton->limits[row.limit], own, feature[0]);
}

bool hasPressed(Island& island, const ModeRow& row, const RowPlace& place) {
  if (row.kind == ModeRow::Kind::kPair) return pairHasPressed(island, row);
  const ImpulseCache& cache = island.bodies[row.body]->cache;
  return (row.isContact() ? cache.find(place.contact) : cache.find(place.limit)) != nullptr;
}

}  // namespace ragdoll
