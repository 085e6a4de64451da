#include "core/direct/island.h"

#include <algorithm>

#include "core/direct/contact_log.h"
#include "core/direct/driving.h"

namespace ragdoll {
namespace {

void setRagdolls(const StepContext& step, IslandScratch& s) {
  s.place.resize(step.model.ragdolls.size());
  for (std::size_t k = 0; k < s.ragdolls.size(); ++k) s.place[s.ragdolls[k]] = static_cast<int>(k);
}

}  // namespace

bool Island::opensOverlaps() const {
  return std::all_of(bodies.begin(), bodies.end(),
                     [](const Body* body) { return body->overlaps == OverlapPolicy::kResolve; });
}

void placeSleepers(const Island& island, Points& poses) {
  const StepContext& step = island.context;
  for (const int i : island.s.all) {
    if (island.placeOf(i) >= 0) continue;
    const Ragdoll& r = step.model.ragdolls[i];
    const int n = step.model.skeletonOf(r).size();
    poses.middleCols(r.first, n) = step.state.x.middleCols(r.first, n);
  }
}

void makeRoom(const Model& model, IslandScratch& s) {
  if (!s.places.empty()) return;
  const int most = model.ragdoll_collision
                       ? std::min<int>(kRoomForBodies, static_cast<int>(model.ragdolls.size()))
                       : 1;
  std::vector<int> bodies(model.skeletons.size(), 0);
  s.places.resize(bodies.size());
  for (const Ragdoll& r : model.ragdolls) {
    if (++bodies[r.skeleton] > most) continue;
    s.places[r.skeleton].emplace_back().makeRoom(model.systemOf(r).direct);
  }
  for (RowValues* values : {&s.b, &s.p, &s.total, &s.change, &s.start, &s.rates})
    values->resize(most * kRoomForRows);
  s.parts.resize(most);
  s.joint.makeRoom(most);
  s.place.resize(model.ragdolls.size());
  s.used.resize(bodies.size());
  makeRoom(model, s.removal);
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

void save(Island& island) {
  for (Body* body : island.bodies) {
    SavedBody& saved = body->saved;
    saved.located = body->located;
    body->given = body->damped = 0;
    save(island.context, body->index, saved);
    saved.cache = body->cache;
  }
  island.pairs.saved = island.pairs.cache;
  island.pairs.pushed.clear();
  island.s.logged = logSize(island);
}

void restore(Island& island) {
  for (Body* body : island.bodies) {
    restore(island.context, body->index, body->saved);
    driveAt(*body, body->xData());
    body->cache = body->saved.cache;
  }
  island.pairs.cache = island.pairs.saved;
  cutLog(island, island.s.logged);
}

}  // namespace ragdoll
