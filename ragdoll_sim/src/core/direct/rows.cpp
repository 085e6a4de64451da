#include "core/direct/rows.h"

#include <algorithm>
#include <cmath>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/contact_rows.h"

namespace ragdoll {
namespace {

using Kind = Schur::Row::Kind;

void buildContactRows(Body& body, bool leapfrog) {
  Schur& schur = body.memory->schur;
  addContactRows(
      body.constraints, body.cache, [&body](const Contact& c) { return gapAfter(body, c); },
      [&](const Contact& c, int source, bool reached) {
        const int row = schur.size();
        schur.addContact(leapfrog ? c.atStart() : c, source);
        if (reached) schur.smooth(row);
        return row;
      });
}

void buildLimitRows(Body& body, double h, bool leapfrog) {
  ConstraintSet& set = body.constraints;
  Schur& schur = body.memory->schur;
  set.softness.resize(set.limits.size());
  set.limit_row.assign(set.limits.size(), -1);
  if (set.limits.empty()) return;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    LimitRow& limit = set.limits[i];
    if (set.limit_role[i] == Role::kComing) continue;
    if (set.limit_role[i] == Role::kIfNear && limit.compliance == 0 &&
        angles[limit.limit] > kClose / kLever && !body.cache.find(limit))
      continue;
    // One that touches at the start pushes along its direction there, as the sticks do.
    if (leapfrog && limit.compliance == 0 &&
        std::abs(limit.before) < body.context->tolerances.touching_angle)
      anglesBefore(body).evaluate(limit);
    else
      angles.evaluate(limit);
    set.softness[i] = leapfrog ? limit.middleSoftness(h) : limit.eulerSoftness(h);
    set.limit_row[i] = schur.size();
    schur.addLimit(limit, static_cast<int>(i), set.softness[i].compliance);
  }
}

CachedImpulse keyOfRow(const Body& body, const Schur::Row& row) {
  return row.kind == Kind::kLimit ? keyOf(body.constraints.limits[row.source])
                                  : keyOf(body.constraints.contacts[row.source]);
}

/// Whether the contact whose rows begin at i, with an obstacle, sticks.
bool grips(const Body& body, int i) {
  const Contact& c = body.constraints.contacts[body.memory->schur.row(i).source];
  return c.obstacle >= 0 && c.friction > 0 &&
         isInsideCone(c.friction, body.total[i], std::hypot(body.total[i + 1], body.total[i + 2]));
}

/// How the motion moves the body's surface at a contact; of two of its sticks, beside its turn.
Vec3 slipOf(const Body& body, const Contact& c) {
  Vec3 slip = Vec3::Zero(), apart = Vec3::Zero();
  for (int k = 0; k < c.count; ++k)
    slip += c.middleWeight(k) * body.motion.dx.col(c.particle[k] - body.first);
  if (c.obstacle >= 0) return slip;
  for (int k = 0; k < c.count; ++k) {
    const int own = c.particle[k] - body.first;
    apart += c.middleWeight(k) * (body.x().col(own) + 0.5 * body.motion.dx.col(own));
  }
  return slip - body.turn.cross(apart);
}

}  // namespace

void buildRows(Body& body, double h, bool leapfrog) {
  body.memory->schur.start(body.first);
  buildContactRows(body, leapfrog);
  buildLimitRows(body, h, leapfrog);
  body.constraints.own_rows = body.memory->schur.size();
}

void evaluateGaps(Body& body, double h) {
  const double share = h / body.context->h;
  const ConstraintSet& set = body.constraints;
  const Schur& schur = body.memory->schur;
  body.b.resize(set.own_rows);
  LimitAngles::Pose* angles = set.limits.empty() ? nullptr : &anglesAfter(body);
  for (int i = 0; i < set.own_rows; ++i) {
    const Schur::Row& row = schur.row(i);
    if (row.kind == Kind::kLimit) {
      const LimitRow& limit = set.limits[row.source];
      body.b[i] = (*angles)[limit.limit] + limit.opening + set.softness[row.source].offset +
                  row.compliance * body.total[i];
    } else if (row.kind == Kind::kNormal) {
      body.b[i] = gapAfter(body, set.contacts[row.source]);
      if (set.contacts[row.source].isSoft())
        body.b[i] += set.springs[row.source].offset + row.compliance * body.total[i];
    } else {
      const Contact& c = set.contacts[row.source];
      body.b[i] = row.direction.dot(c.slipOf(slipOf(body, c) - share * c.surface_motion));
    }
  }
}

bool soften(Body& body, double h, bool leapfrog) {
  return softenContacts(body.constraints, body.memory->schur, h, leapfrog);
}

double worstResidual(Body& body, bool closed) {
  const ConstraintSet& set = body.constraints;
  const auto gap = [&body](const Contact& c) { return gapAfter(body, c); };
  double worst = worstResidual(set, body.total, gap, closed);
  if (set.limits.empty()) return worst;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    const LimitRow& limit = set.limits[i];
    const int row = set.limit_row[i];
    if (row < 0 || limit.compliance > 0) continue;
    const bool presses = closed && body.total[row] > 0;
    if (presses || !angles.isBeyond(limit.limit, -limit.opening))
      worst = std::max(
          worst, residual(angles[limit.limit] + limit.opening, body.total[row], closed) * kLever);
  }
  return worst;
}

void warmStart(const Body& body, double h, Eigen::Ref<Eigen::VectorXd> p) {
  p.setZero();
  if (body.cache.empty()) return;
  const Schur& schur = body.memory->schur;
  const CachedImpulse* last = nullptr;
  for (int i = 0; i < body.constraints.own_rows; ++i) {
    const Schur::Row& row = schur.row(i);
    if (row.kind != Kind::kTangent) last = body.cache.find(keyOfRow(body, row));
    if (!last || (row.kind == Kind::kTangent && row.friction == 0)) continue;
    if (row.kind == Kind::kLimit)
      p[i] = last->impulse.x() * h * h;
    else
      p[i] = last->impulse.dot(row.direction) * h * h;
    if (row.kind == Kind::kNormal) p[i] = std::max(0.0, p[i]);
  }
}

void rememberImpulses(Body& body, double h) {
  body.cache.clear();
  bool pressed = false;  // the contact whose friction follows
  for (int i = 0; i < body.constraints.own_rows; ++i) {
    const Schur::Row& row = body.memory->schur.row(i);
    const double force = body.total[i] / (h * h);
    if (row.kind == Kind::kTangent) {
      if (pressed && force != 0) body.cache.last().impulse += force * row.direction;
      continue;
    }
    pressed = row.kind == Kind::kNormal && force != 0;
    if (force == 0) continue;
    if (row.kind == Kind::kNormal && !body.cache.gripped() && grips(body, i))
      body.cache.setGripped();
    body.cache.add(keyOfRow(body, row));
    body.cache.last().impulse =
        row.kind == Kind::kLimit ? Vec3(force, 0, 0) : Vec3(force * row.direction);
  }
}

}  // namespace ragdoll
