#include "core/direct/island.h"

#include <algorithm>

#include "core/contact/constants.h"
#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/driving.h"
#include "core/direct/penetration.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

/// Where the bodies' motions lead, sleepers where they are; as poseAfter.
const Points& posesAfter(const Island& island) {
  const StepContext& step = island.context;
  for (const Body* body : island.bodies) poseAfter(*body);
  Points& poses = posesOf(step);
  for (const int i : island.s.all) {
    if (island.placeOf(i) >= 0) continue;
    const Ragdoll& r = step.model.ragdolls[i];
    const int n = step.model.skeletonOf(r).size();
    poses.middleCols(r.first, n) = step.state.x.middleCols(r.first, n);
  }
  return poses;
}

void startPair(const Island& island, Contact& c, double h) {
  if (island.context.relaxed) c.give = {};
  c.found = c.offset;
  c.before = c.isSoft() ? c.gap_start : gapBefore(c, c.gapAt(island.context.state.x));
  limitDepenetration(island, c, h);
}

void setRagdolls(const StepContext& step, IslandScratch& s) {
  s.place.resize(step.model.ragdolls.size());
  for (std::size_t k = 0; k < s.ragdolls.size(); ++k) s.place[s.ragdolls[k]] = static_cast<int>(k);
}

}  // namespace

bool Island::opensOverlaps() const {
  return std::all_of(bodies.begin(), bodies.end(),
                     [](const Body* body) { return body->overlaps == OverlapPolicy::kResolve; });
}

void makePlaces(const Model& model, const std::vector<int>& bodies, IslandScratch& s) {
  s.places.resize(model.skeletons.size());
  s.used.assign(model.skeletons.size(), 0);
  for (const int i : bodies) ++s.used[model.ragdolls[i].skeleton];
  for (std::size_t k = 0; k < s.used.size(); ++k)
    if (static_cast<int>(s.places[k].size()) < s.used[k]) s.places[k].resize(s.used[k]);
  s.used.assign(model.skeletons.size(), 0);
}

Body& takePlace(const Model& model, int ragdoll, IslandScratch& s) {
  const int skeleton = model.ragdolls[ragdoll].skeleton;
  return s.places[skeleton][s.used[skeleton]++];
}

void bindIsland(Island& island, const std::vector<int>& bodies, const std::vector<int>& others) {
  IslandScratch& s = island.s;
  s.ragdolls = bodies;
  setRagdolls(island.context, s);
  s.all.resize(bodies.size() + others.size());
  std::merge(bodies.begin(), bodies.end(), others.begin(), others.end(), s.all.begin());
  makePlaces(island.context.model, bodies, s);
  s.bodies.clear();
  for (const int i : bodies) {
    s.bodies.push_back(&takePlace(island.context.model, i, s));
    s.bodies.back()->bind(island.context, i);
  }
  s.pairs.clear();
}

void bindLone(Island& island, Body& body) {
  IslandScratch& s = island.s;
  s.ragdolls.assign(1, body.index);
  setRagdolls(island.context, s);
  s.all = s.ragdolls;
  s.bodies.assign(1, &body);
  s.pairs.clear();
}

double pairGapAfter(const Island& island, const Contact& c) {
  double gap = c.gapAt(island.context.state.x);
  for (int side = 0; side < 2; ++side) {
    const int place = island.placeOf(side == 0 ? c.ragdoll : c.other);
    if (place < 0) continue;
    const Body& body = *island.bodies[place];
    for (int k = 2 * side; k < 2 * side + 2; ++k)
      gap += c.weight[k] * c.normal.dot(body.motion.dx.col(c.particle[k] - body.first));
  }
  return gap;
}

double pairRate(const State& state, const Contact& c) { return c.normal.dot(c.of(state.v)); }

void limitDepenetration(const Island& island, Contact& pair, double h) {
  if (!pair.isSoft()) pair.offset = pair.found - allowedPenetration(pair, h, island.context.h);
}

void findCandidates(Island& island, double h) {
  for (Body* body : island.bodies) findCandidates(*body, h);
  PairSet& pairs = island.pairs;
  pairs.contacts.clear();
  if (island.isLone()) return;
  island.s.detector.appendBetween(island.context.model, island.context.state, island.s.all,
                                  island.context.state.x, posesAfter(island),
                                  PairSearch::touches(kNearBody), pairs.contacts);
  for (Contact& c : pairs.contacts) startPair(island, c, h);
  pairs.role.assign(pairs.contacts.size(), Role::kIfNear);
}

void findContactsAnew(Island& island, double over) {
  for (Body* body : island.bodies) findContactsAnew(*body, over);
  PairSet& pairs = island.pairs;
  const Body& any = *island.bodies[0];
  if (!hasOtherPlane(any, pairs.contacts, over)) return;
  pairs.missed.clear();
  island.s.detector.appendBetween(island.context.model, island.context.state, island.s.all,
                                  island.context.state.x, posesAfter(island),
                                  PairSearch::touches(kNearBody), pairs.missed);
  for (Contact& c : pairs.contacts)
    if (hasOtherPlane(any, c, over) && findAnew(pairs.missed, c)) startPair(island, c, over);
}

bool findMissed(Island& island, double h) {
  bool any = false;
  for (Body* body : island.bodies) any = findMissed(*body, h) || any;
  if (island.isLone()) return any;
  PairSet& pairs = island.pairs;
  pairs.missed.clear();
  island.s.detector.appendBetween(island.context.model, island.context.state, island.s.all,
                                  island.context.state.x, posesAfter(island),
                                  PairSearch::overlaps(kSlop), pairs.missed);
  const std::size_t known = pairs.contacts.size();
  for (Contact& c : pairs.missed) {
    startPair(island, c, h);
    if (c.isSoft() && isKnown(pairs.contacts, known, c)) continue;  // its spring overlaps
    if (pairGapAfter(island, c) >= -kSlop) continue;
    pairs.contacts.push_back(c);
    pairs.role.push_back(Role::kActive);
    any = true;
  }
  return any;
}

bool activateViolated(Island& island) {
  bool any = false;
  for (Body* body : island.bodies) any = activateViolated(*body) || any;
  PairSet& pairs = island.pairs;
  for (std::size_t i = 0; i < pairs.contacts.size(); ++i) {
    if (pairs.row[i] >= 0 || pairs.role[i] == Role::kComing) continue;
    if (pairGapAfter(island, pairs.contacts[i]) >= -island.context.tolerances.contact) continue;
    pairs.role[i] = Role::kActive;
    any = true;
  }
  return any;
}

void activateAll(Island& island) {
  for (Body* body : island.bodies) activateAll(*body);
  island.pairs.role.assign(island.pairs.contacts.size(), Role::kActive);
}

void save(Island& island) {
  for (Body* body : island.bodies) {
    SavedBody& saved = body->saved;
    saved.located = body->located;
    body->given = 0;
    saved.x = body->x();
    saved.v = body->v();
    saved.multipliers.assign(body->multipliers(), body->multipliers() + 2 * body->rows->s);
    saved.cache = body->cache;
  }
  island.pairs.saved = island.pairs.cache;
  island.pairs.pushed.clear();
  island.s.logged = logSize(island);
}

void restore(Island& island) {
  for (Body* body : island.bodies) {
    const SavedBody& saved = body->saved;
    body->x() = saved.x;
    body->v() = saved.v;
    driveAt(*body, body->xData());
    std::copy(saved.multipliers.begin(), saved.multipliers.end(), body->multipliers());
    body->cache = saved.cache;
  }
  island.pairs.cache = island.pairs.saved;
  cutLog(island, island.s.logged);
}

}  // namespace ragdoll
