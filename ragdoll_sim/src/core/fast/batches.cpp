#include "core/fast/batches.h"

#include <algorithm>
#include <cstdint>

#include "core/direct/workspace.h"
#include "core/fast/body_build.h"
#include "core/fast/dispatch.h"
#include "core/fast/pack_run.h"

namespace ragdoll::fast {
namespace {

bool moves(const SweptObstacle& o) { return o.p0 != o.p1 || o.R0 != o.R1; }

Solid solidOf(const SweptObstacle& o) {
  Solid solid;
  solid.obstacle = o.index;
  solid.is_box = o.obstacle->type == ObstacleSpec::Type::kBox;
  solid.moves = moves(o);
  solid.radius = o.obstacle->radius;
  solid.friction = o.obstacle->friction;
  solid.restitution = o.obstacle->restitution;
  const Vec3 middle = 0.5 * (o.p0 + o.p1);
  const Vec3 extent = (o.bounds.hi - middle).cwiseMax(middle - o.bounds.lo);
  for (int c = 0; c < 3; ++c) {
    solid.half[c] = o.obstacle->half[c];
    solid.place0[c] = o.p0[c];
    solid.place1[c] = o.p1[c];
    solid.extent[c] = extent[c];
    for (int k = 0; k < 3; ++k) {
      solid.axes0[3 * k + c] = o.R0(c, k);
      solid.axes1[3 * k + c] = o.R1(c, k);
    }
  }
  return solid;
}

/// Obstacles as the packs want them.
void sortObstacles(const std::vector<SweptObstacle>& all, FastScratch& s) {
  s.obstacles.clear();
  s.solids.clear();
  s.planes.clear();
  s.moving_planes.clear();
  s.driven = false;
  for (const SweptObstacle& o : all) {
    s.driven = s.driven || moves(o);
    if (o.obstacle->type != ObstacleSpec::Type::kPlane) {
      s.obstacles.push_back(o);
      s.solids.push_back(solidOf(o));
      continue;
    }
    if (moves(o)) {
      s.moving_planes.push_back(o);
      continue;
    }
    StillPlane plane;
    plane.obstacle = o.index;
    const Vec3 n = o.R1.col(2);
    for (int c = 0; c < 3; ++c) plane.normal[c] = n[c];
    plane.offset = n.dot(o.p1);
    plane.friction = o.obstacle->friction;
    plane.restitution = o.obstacle->restitution;
    s.planes.push_back(plane);
  }
}

/// Where each ragdoll's last impulses are.
void sortPresses(const Model& model, const State& state, FastScratch& s) {
  s.first_impulse.assign(model.ragdolls.size() + 2, 0);
  for (const CachedImpulse& p : state.impulses) ++s.first_impulse[p.ragdoll + 2];
  for (std::size_t i = 2; i < s.first_impulse.size(); ++i)
    s.first_impulse[i] += s.first_impulse[i - 1];
  s.cached.reserve(state.impulses.capacity());
  s.cached.resize(state.impulses.size());
  for (std::size_t k = 0; k < state.impulses.size(); ++k)
    s.cached[s.first_impulse[state.impulses[k].ragdoll + 1]++] = static_cast<int>(k);
}

/// The links of a body that pressed in the last step, a bit each.
std::uint32_t pressedLinks(const Model& model, const State& state, const FastScratch& s, int index,
                           const Tree& tree) {
  const int first = model.ragdolls[index].first;
  std::uint32_t links = 0;
  for (int k = s.first_impulse[index]; k < s.first_impulse[index + 1]; ++k) {
    const CachedImpulse& last = state.impulses[s.cached[k]];
    if (last.obstacle >= 0) links |= 1u << (tree.owner[last.a - first] + 1) % 32;
  }
  return links;
}

/// Bodies that lie on the same limbs share packs, which work out the rows that one of them needs.
void sortByLinks(const Model& model, const State& state, int begin, const Tree& tree,
                 FastScratch& s) {
  s.pressed.clear();
  for (std::size_t k = begin; k < s.order.size(); ++k)
    s.pressed.emplace_back(pressedLinks(model, state, s, s.order[k], tree), s.order[k]);
  if (std::is_sorted(s.pressed.begin(), s.pressed.end())) return;
  std::sort(s.pressed.begin(), s.pressed.end());
  for (std::size_t k = begin; k < s.order.size(); ++k) s.order[k] = s.pressed[k - begin].second;
}

/// Adds ragdolls [begin, end) of a list in batches that a pack takes; used: batches in use.
void addBatches(const Model& model, int most_lanes, int system, int begin, int end,
                std::vector<Batch>& batches, int& used) {
  const bool single = model.solver.numbers == Numbers::kFloat;
  for (int at = begin; at < end;) {
    const int lanes = packFor(single, end - at, most_lanes).lanes;
    if (used == static_cast<int>(batches.size())) batches.emplace_back();
    Batch& batch = batches[used++];
    batch.system = system;
    batch.begin = at;
    batch.count = std::min(lanes, end - at);
    clear(batch);
    at += batch.count;
  }
}

/// Bodies, system by system, in batches.
void sortBodies(const Model& model, const State& state, const std::vector<int>& bodies,
                FastScratch& s, std::vector<int>& left) {
  s.order.clear();
  int used = 0;
  for (std::size_t system = 0; system < model.systems.size(); ++system) {
    const int begin = static_cast<int>(s.order.size());
    for (const int i : bodies) {
      if (model.ragdolls[i].system != static_cast<int>(system)) continue;
      (s.bodies[system].why_not.empty() ? s.order : left).push_back(i);
    }
    const int end = static_cast<int>(s.order.size());
    if (end > begin) sortByLinks(model, state, begin, s.bodies[system].tree, s);
    addBatches(model, s.most_lanes, static_cast<int>(system), begin, end, s.batches, used);
  }
  s.batch_count = used;
  while (s.again_batches.size() < s.batches.size()) s.again_batches.emplace_back();
  s.again.reserve(model.ragdolls.size());
  s.again_hits.reserve(model.ragdolls.size());
}

/// What packs have left, of all of them: in batches that are stepped in parts, or for the direct
/// method.
void sortLeft(const StepContext& context, FastScratch& s, std::vector<int>& left) {
  const bool parts = stepsInParts(context, s);
  s.again.clear();
  s.again_hits.clear();
  s.again_count = 0;
  for (int i = 0; i < s.batch_count;) {
    const int system = s.batches[i].system, begin = static_cast<int>(s.again.size());
    for (; i < s.batch_count && s.batches[i].system == system; ++i) {
      append(s.batches[i].left, parts ? s.again : left);
      if (parts) append(s.batches[i].hits, s.again_hits);
    }
    addBatches(context.model, s.most_lanes, system, begin, static_cast<int>(s.again.size()),
               s.again_batches, s.again_count);
  }
}

}  // namespace

void prepare(const StepContext& context, FastScratch& s) {
  const Model& model = context.model;
  if (s.bodies.size() != model.systems.size()) {
    s.bodies.clear();
    for (const System& system : model.systems) s.bodies.push_back(buildBody(model, system));
  }
  sortObstacles(context.ws.obstacles, s);
  sortPresses(model, context.state, s);
}

void stepBatches(const StepContext& context, const std::vector<int>& bodies, FastScratch& s,
                 std::vector<int>& left) {
  sortBodies(context.model, context.state, bodies, s, left);
  s.packs.resize(Workers::count(context.model.solver.threads));
  forEachPart(context, s.batch_count, [&](StepContext& own, int part) {
    stepPack(own, s, s.packs[own.worker], s.batches[part]);
  });
  sortLeft(context, s, left);
  forEachPart(context, s.again_count, [&](StepContext& own, int part) {
    stepParts(own, s, s.packs[own.worker], s.again_batches[part]);
  });
  for (int i = 0; i < s.again_count; ++i) append(s.again_batches[i].left, left);
}

}  // namespace ragdoll::fast
