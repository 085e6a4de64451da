#include "core/direct/mode_list.h"

#include <algorithm>
#include <cmath>

#include "core/contact/compliance.h"
#include "core/contact/constants.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_obstacles.h"
#include "core/direct/mode_pairs.h"
#include "core/direct/mode_rows.h"
#include "core/direct/moving_obstacles.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using ModeKind = ModeRow::Kind;

/// A point in touch with an edge has none.
bool hasNormal(const Obstacle& o, const ModeRow& row) {
  return o.type == ObstacleSpec::Type::kPlane || o.radius + std::min(row.ra, row.rb) > kMinLength;
}

/// Adds the row if a motion may reach it. False: it is deep in, or has no normal.
bool consider(const Body& body, ModeRow& row, double reach, Mode& mode) {
  const double gap = gapOfOwn(body, row, mode.start.x.data() + mode.offset[row.body]);
  if (gap > reach) return true;
  if (row.isContact() && !hasNormal(*body.context->ws.obstacles[row.obstacle].obstacle, row))
    return false;
  row.gap_start = gap;
  mode.rows.push_back(row);
  return row.isSoft() || gap >= -kTouching * (row.kind == ModeKind::kLimit ? 1 / kLever : 1);
}

bool listObstacle(Body& body, int place, int index, double reach, Mode& mode) {
  const StepContext& step = *body.context;
  const SweptObstacle& m = step.ws.obstacles[index];
  ModeRow row;
  const double* x = mode.start.x.data() + mode.offset[place];
  row.body = place;
  row.obstacle = index;
  row.friction = m.obstacle->friction;
  row.restitution = m.obstacle->restitution;
  bool sound = true;
  for (int i = 0; i < body.skeleton->named && sound; ++i) {
    if (body.system->W(i, i) == 0) continue;  // nothing pushes what a pin holds
    row.a = row.b = i;
    row.ra = row.rb = step.model.radius[body.first + i];
    row.give = giveOf(step.model, *m.obstacle, *body.ragdoll, body.skeleton->particle_contact, i);
    sound = consider(body, row, reach, mode);
  }
  if (m.obstacle->type == ObstacleSpec::Type::kPlane) return sound;
  row.kind = ModeKind::kStick;
  for (std::size_t i = 0; i < body.skeleton->sticks.size(); ++i) {
    const Stick& k = body.skeleton->sticks[i];
    if (k.a >= body.skeleton->named || k.b >= body.skeleton->named || !sound) continue;
    row.a = k.a;
    row.b = k.b;
    row.ra = step.model.radius[body.first + k.a];
    row.rb = step.model.radius[body.first + k.b];
    row.give = giveOf(step.model, *m.obstacle, *body.ragdoll, body.skeleton->stick_contact, i);
    sound = consider(body, row, reach, mode) && (row.isSoft() || !liesAcross(body, row, x));
  }
  return sound;
}

bool listOwn(Body& body, int place, double reach, Mode& mode) {
  const StepContext& step = *body.context;
  for (std::size_t k = 0; k < step.ws.obstacles.size(); ++k)
    if (!listObstacle(body, place, static_cast<int>(k), reach, mode)) return false;
  const std::vector<Limit>& limits = body.skeleton->limits;
  ModeRow row;
  row.kind = ModeKind::kLimit;
  row.body = place;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    row.limit = static_cast<int>(k);
    row.give = {limits[k].compliance, limits[k].damping};
    if (!consider(body, row, reach / kLever, mode)) return false;
  }
  return true;
}

void layOut(Island& island) {
  Mode& mode = island.s.mode;
  mode.offset.clear();
  mode.size = 0;
  for (const Body* body : island.bodies) {
    mode.offset.push_back(mode.size);
    mode.size += clockPlace(body->n) + paddedWidth(1);
  }
}

/// mode.start <- the bodies as they are.
void startCoordinates(Island& island) {
  Mode& mode = island.s.mode;
  for (ModePoint* point : {&mode.start, &mode.end, &mode.sample, &mode.stage})
    for (RowValues* values : {&point->x, &point->v, &point->a}) values->setZero(mode.size);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    double *x = mode.start.x.data() + mode.offset[k], *v = mode.start.v.data() + mode.offset[k];
    std::copy_n(body.xData(), 3 * body.n, x);
    std::copy_n(body.vData(), 3 * body.n, v);
    x[clockPlace(body.n)] = body.time;
    v[clockPlace(body.n)] = 1;
    if (island.context.inputs.pins.empty()) continue;  // else one may be faster or slower now
    body.memory->response.setEnd(x);
    body.memory->response.projectAtEnd(v);
  }
}

}  // namespace

double reachOf(const Island& island, double h) {
  double reach = 0;
  for (const Body* body : island.bodies) {
    const double speed =
        std::sqrt(body->v().colwise().squaredNorm().maxCoeff()) + fastestObstacle(*body);
    const double pull = body->acceleration.colwise().norm().maxCoeff();
    reach = std::max(reach, kReach * h * (speed + h * pull));
  }
  return reach + kClose;
}

bool startMode(Island& island, double reach) {
  Mode& mode = island.s.mode;
  layOut(island);
  startCoordinates(island);
  mode.slow.rows.clear();  // of a step before, of other rows
  mode.rows.clear();
  const int count = static_cast<int>(island.bodies.size());
  for (int k = 0; k < count; ++k)
    if (!listOwn(*island.bodies[k], k, reach, mode) || !listPairs(island, k, k, 2 * reach))
      return false;
  for (int k = 0; k < count; ++k)  // what they share comes last (buildRows)
    for (int l = k + 1; l < count; ++l)
      if (!listPairs(island, k, l, 2 * reach)) return false;
  return true;
}

}  // namespace ragdoll
