#include "core/direct/pair_rows.h"

#include <algorithm>
#include <cmath>

#include "core/direct/angular_momentum.h"
#include "core/direct/constants.h"
#include "core/direct/contact_rows.h"
#include "core/direct/rows.h"

namespace ragdoll {
namespace {

/// How the bodies' motions move the two sides of a contact along each other, beside their turn.
Vec3 slipAfter(const Island& island, const Contact& c) {
  Vec3 slip = Vec3::Zero();
  const Vec3 turn = commonTurn(island, c);
  for (int side = 0; side < 2; ++side) {
    const int place = island.placeOf(side == 0 ? c.ragdoll : c.other);
    if (place < 0) continue;
    const Body& body = *island.bodies[place];
    for (int k = 2 * side; k < 2 * side + 2; ++k) {
      const int own = c.particle[k] - body.first;
      const Vec3 dx = body.motion.dx.col(own);
      slip += c.middleWeight(k) * (dx - turn.cross(Vec3(body.x().col(own) + 0.5 * dx)));
    }
  }
  return slip;
}

}  // namespace

int addPairRows(Island& island, const Contact& c, int source, bool smooth) {
  JointSchur& joint = island.s.joint;
  const int first = joint.size();
  const std::array<int, 2> place{island.placeOf(c.ragdoll), island.placeOf(c.other)};
  std::array<int, 2> row{-1, -1};
  for (int side = 0; side < 2; ++side) {
    if (place[side] < 0) continue;
    Schur& schur = island.bodies[place[side]]->memory->schur;
    row[side] = schur.size();
    schur.addContact(c, source, 2 * side, 2 * side + 2);
    if (smooth) schur.smooth(row[side]);
  }
  joint.addShared(c, place[0], row[0], place[1], row[1]);
  return first;
}

void buildRows(Island& island, double h, bool leapfrog) {
  island.s.joint.clear(island.opensOverlaps());
  for (Body* body : island.bodies) {
    buildRows(*body, h, leapfrog);
    island.s.joint.addBody(body->memory->schur);
  }
  PairSet& pairs = island.pairs;
  addContactRows(
      pairs, pairs.cache, [&island](const Contact& c) { return pairGapAfter(island, c); },
      [&](const Contact& c, int source, bool reached) {
        return addPairRows(island, leapfrog ? c.atStart() : c, source, reached);
      });
}

void evaluateGaps(Island& island, double h) {
  IslandScratch& s = island.s;
  findTurns(island, TurnOf::kMotion);
  s.b.resize(s.joint.size());
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    evaluateGaps(body, h);
    s.b.segment(s.joint.firstOf(static_cast<int>(k)), body.constraints.own_rows) = body.b;
  }
  for (std::size_t i = 0; i < island.pairs.contacts.size(); ++i) {
    const int row = island.pairs.row[i];
    if (row < 0) continue;
    const Contact& c = island.pairs.contacts[i];
    s.b[row] = pairGapAfter(island, c);
    if (c.isSoft())
      s.b[row] += island.pairs.springs[i].offset + s.joint.row(row).compliance * s.total[row];
    const Vec3 slip = c.slipOf(slipAfter(island, c));
    for (int k = 1; k < 3; ++k) s.b[row + k] = s.joint.row(row + k).direction.dot(slip);
  }
}

bool soften(Island& island, double h, bool leapfrog) {
  bool any = false;
  for (Body* body : island.bodies)
    if (!body->memory->schur.empty()) any = soften(*body, h, leapfrog) || any;
  return softenContacts(island.pairs, island.s.joint, h, leapfrog) || any;
}

bool anyCloses(const Island& island) {
  const auto presses = [](const Contact& c) { return c.isSoft() && c.before < 0; };
  const auto any = [&](const std::vector<Contact>& all) {
    return std::any_of(all.begin(), all.end(), presses);
  };
  if (any(island.pairs.contacts) ||
      std::any_of(island.bodies.begin(), island.bodies.end(),
                  [&](const Body* body) { return any(body->constraints.contacts); }))
    return true;
  for (int i = 0; i < island.s.joint.size(); ++i)
    if (island.s.joint.row(i).kind != Schur::Row::Kind::kTangent && island.s.b[i] < 0) return true;
  return false;
}

void warmStart(Island& island, double h) {
  IslandScratch& s = island.s;
  s.p.setZero(s.joint.size());
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    warmStart(
        *island.bodies[k], h,
        s.p.segment(s.joint.firstOf(static_cast<int>(k)), island.bodies[k]->constraints.own_rows));
  PairSet& pairs = island.pairs;
  pairs.cache.startHandingOut();  // two capsules that lie along each other have two contacts
  for (std::size_t i = 0; i < pairs.contacts.size(); ++i) {
    const int row = pairs.row[i];
    if (row < 0) continue;
    const CachedImpulse* last = pairs.cache.handOut(pairs.contacts[i]);
    if (!last) continue;
    const int count = s.joint.row(row).friction > 0 ? 3 : 1;
    for (int d = 0; d < count; ++d)
      s.p[row + d] = last->impulse.dot(s.joint.row(row + d).direction) * h * h;
    s.p[row] = std::max(0.0, s.p[row]);
  }
}

void rememberPairs(Island& island, double h) {
  PairSet& pairs = island.pairs;
  pairs.cache.clear();
  pairs.pressing.clear();
  for (std::size_t i = 0; i < pairs.contacts.size(); ++i) {
    const int row = pairs.row[i];
    if (row < 0 || !(island.s.total[row] > 0)) continue;
    const Contact& c = pairs.contacts[i];
    pairs.cache.add(keyOf(c));
    for (int d = 0; d < 3; ++d)
      pairs.cache.last().impulse +=
          island.s.total[row + d] / (h * h) * island.s.joint.row(row + d).direction;
    const double friction = std::hypot(island.s.total[row + 1], island.s.total[row + 2]);
    pairs.pressing.push_back(
        {c.ragdoll, c.other, isInsideCone(c.friction, island.s.total[row], friction)});
    pairs.pushed.push_back(pairs.pressing.back());
  }
}

double worstPairResidual(const Island& island, bool closed) {
  const auto gap = [&island](const Contact& c) { return pairGapAfter(island, c); };
  return worstResidual(island.pairs, island.s.total, gap, closed);
}

}  // namespace ragdoll
