#include "core/fast/pack_run.h"

#include <algorithm>
#include <cmath>

#include "core/contact/detect.h"
#include "core/contact/distance.h"
#include "core/contact/pair_detect.h"
#include "core/fast/constants.h"

namespace ragdoll::fast {

PackRun::PackRun(const StepContext& context, const PackTask& task, const FastScratch& scratch,
                 Points& predicted, Points& tried, PackScratch& pack, Batch& batch)
    : model_(context.model),
      inputs_(context.inputs),
      task_(task),
      force_(context.force),
      scratch_(scratch),
      pack_(pack),
      predicted_(predicted),
      tried_(tried),
      state_(context.state),
      supports_(context.supports),
      batch_(batch),
      body_(scratch.bodies[batch.system]),
      method_(packFor(context.model.solver.numbers == Numbers::kFloat, batch.count,
                      scratch.most_lanes)) {}

void PackRun::run() {
  predict();
  endSearch();
  method_.finish(body_, step_, lanes_, pack_.memory.data());
  for (int l = 0; l < batch_.count; ++l) keep(l);
}

void PackRun::predict() {
  prepare();
  method_.predict(body_, step_, lanes_, pack_.memory.data());
}

void PackRun::endSearch() {
  for (int l = 0; l < batch_.count; ++l) endSearch(l);
}

void PackRun::setStep() {
  step_.h = task_.h;
  step_.bounds = task_.bounds;
  for (int c = 0; c < 3; ++c) step_.gravity[c] = model_.gravity[c];
  step_.planes = scratch_.planes.data();
  step_.plane_count = static_cast<int>(scratch_.planes.size());
  step_.solids = scratch_.solids.data();
  step_.solid_count = static_cast<int>(scratch_.solids.size());
  step_.whole = task_.together || !scratch_.moving_planes.empty();
}

void PackRun::prepare() {
  predicted_.resize(3, model_.size());
  tried_.resize(3, model_.size());
  const int n = 3 * body_.tree.particles, limits = static_cast<int>(body_.limits.size());
  setStep();
  const std::size_t bytes = method_.memory(body_, step_.plane_count) + 64;
  if (pack_.memory.size() < bytes) pack_.memory.resize(bytes);
  room_ = impulseRoom(body_, step_.plane_count);
  const int lanes = method_.lanes, features = static_cast<int>(body_.features.size());
  const int hard = features * step_.solid_count;
  contact_room_ = features * kSlots;
  const auto grow = [](auto& room, int size) {
    if (static_cast<int>(room.size()) < size) room.resize(size);
  };
  grow(pack_.spare, 2 * lanes * n);
  grow(pack_.start, 2 * lanes * n);
  grow(pack_.impulses, lanes * room_);
  grow(pack_.contacts, lanes * contact_room_);
  grow(pack_.left_over, lanes * hard);
  pack_.limit_impulses.assign(lanes * limits + 1, 0.0);
  for (int l = 0; l < method_.lanes; ++l) {
    lanes_[l] = Lane();
    lanes_[l].limit_impulse = pack_.limit_impulses.data() + l * limits;
    lanes_[l].impulses = pack_.impulses.data() + l * room_;
    if (l < batch_.count) {
      fill(l);
      setTime(l);
      lanes_[l].contacts = pack_.contacts.data() + l * contact_room_;
      lanes_[l].contact_room = contact_room_;
      lanes_[l].hard = pack_.left_over.data() + l * hard;
      lanes_[l].hard_room = hard;
    } else {  // a lane for no body: the first one's again
      lanes_[l].x = lanes_[0].x;
      lanes_[l].v = lanes_[0].v;
      lanes_[l].h = lanes_[0].h;
      lanes_[l].x1 = lanes_[l].tried_x = pack_.spare.data() + n * (lanes + l);
      lanes_[l].v1 = pack_.spare.data() + n * l;
    }
    lanes_[l].tried_v = pack_.spare.data() + n * l;
  }
}

void PackRun::fill(int l) {
  Lane& lane = lanes_[l];
  const int index = ragdollOf(l);
  const Ragdoll& r = model_.ragdolls[index];
  lane.x = state_.x.data() + 3 * r.first;
  lane.v = state_.v.data() + 3 * r.first;
  lane.x1 = state_.x.data() + 3 * r.first;
  lane.v1 = state_.v.data() + 3 * r.first;
  lane.tried_x = tried_.data() + 3 * r.first;
  lane.on_trial = model_.self_collision || task_.together;
  if (!scratch_.obstacles.empty() || step_.whole) lane.predicted = predicted_.data() + 3 * r.first;
  if (force_) lane.force = force_->data() + 3 * r.first;
  lane.driven = scratch_.driven;
  const PartTask* part = task_.parts ? task_.parts + batch_.begin + l : nullptr;
  if (task_.last && !(part && part->done == 0)) {
    // What a shorter part was pressed with may be an impact's.
    const double shorter = part ? std::min(1.0, part->last / part->share) : 1;
    for (const CachedImpulse& last : *task_.last) {
      if (last.ragdoll == index) takeImpulse(last, shorter * shorter, r, lane);
    }
  } else {
    for (int k = scratch_.first_impulse[index]; k < scratch_.first_impulse[index + 1]; ++k)
      takeImpulse(state_.impulses[scratch_.cached[k]], 1, r, lane);
  }
  for (std::size_t p = 0; p < inputs_.pins.size(); ++p) {
    if (model_.pins[p].ragdoll != index) continue;
    const Vec3 motion = inputs_.pins[p] - state_.x.col(model_.pins[p].particle);
    const double share = part ? part->share / (1 - part->done) : 1.0 / task_.left;
    for (int c = 0; c < 3; ++c) lane.pin[c] = share * motion[c];
    lane.driven = lane.driven || motion != Vec3::Zero();
  }
}

void PackRun::setTime(int l) {
  Lane& lane = lanes_[l];
  lane.h = task_.h;
  lane.bounds = task_.bounds;
  if (task_.parts) {
    lane.h = task_.parts[batch_.begin + l].share * task_.h;
    lane.bounds = task_.parts[batch_.begin + l].bounds;
  }
  const SolverSpec& solver = model_.solver;
  lane.keep = solver.damping > 0 ? std::exp(-solver.damping * lane.h) : 1;
  lane.keep_inner = solver.joint_damping > 0 ? std::exp(-solver.joint_damping * lane.h) : 1;
}

void PackRun::takeImpulse(const CachedImpulse& last, double share, const Ragdoll& r,
                          Lane& lane) const {
  if (last.a < 0) {
    if (-1 - last.a < static_cast<int>(body_.limits.size()))
      lane.limit_impulse[-1 - last.a] = share / kKept * last.impulse.x();
    lane.limits_pressed = true;
    return;
  }
  if (last.obstacle < 0) return;
  const int feature = featureOf(last.a - r.first, last.b < 0 ? -1 : last.b - r.first);
  if (feature < 0 || lane.impulse_count >= room_) return;
  LaneImpulse& to = lane.impulses[lane.impulse_count++];
  to.feature = feature;
  to.obstacle = last.obstacle;
  for (int c = 0; c < 3; ++c) to.impulse[c] = share / kKept * last.impulse[c];
}

int PackRun::featureOf(int a, int b) const {
  if (b < 0) return a < body_.particles ? a : -1;
  for (std::size_t f = body_.particles; f < body_.features.size(); ++f)
    if (body_.features[f].a == a && body_.features[f].b == b) return static_cast<int>(f);
  return -1;
}

/// What the pack has left over, and planes that move; then slots and last impulses of all.
void PackRun::endSearch(int l) {
  const int index = ragdollOf(l);
  Lane& lane = lanes_[l];
  pack_.found.clear();
  const double margin = lane.hard_count > 0 || step_.whole ? searchMargin(l) : 0;
  for (int k = 0; k < lane.hard_count; ++k) {
    const Feature& f = body_.features[lane.hard[k].feature];
    const SweptObstacle& m = scratch_.obstacles[lane.hard[k].solid];
    if (f.b < 0)
      appendParticleContact(model_, m, state_.x, predicted_, index, f.a, margin, pack_.found);
    else
      appendStickContacts(model_, m, state_.x, predicted_, index, f.stick, margin, pack_.found);
  }
  if (!scratch_.moving_planes.empty())
    appendContacts(model_, scratch_.moving_planes, state_.x, predicted_, index, margin,
                   pack_.found);
  for (const Contact& c : pack_.found) addContact(c, model_.ragdolls[index].first, lane);
  sortContacts(lane);
}

/// [m] As the packs' own.
double PackRun::searchMargin(int l) const {
  const int first = model_.ragdolls[ragdollOf(l)].first;
  const double h = lanes_[l].h;
  const double speed = std::sqrt(
      state_.v.middleCols(first, body_.tree.particles).colwise().squaredNorm().maxCoeff());
  return std::min({kMargin, kAside * h, kNear + kReach * h * speed});
}

void PackRun::addContact(const Contact& c, int first, Lane& lane) const {
  LaneContact to;
  to.feature = featureOf(c.particle[0] - first, c.count > 1 ? c.particle[1] - first : -1);
  if (to.feature < 0 || lane.contact_count >= lane.contact_room) return;
  to.obstacle = c.obstacle;
  to.weight = c.count > 1 ? c.weight[1] : 0;
  to.offset = c.offset - c.normal.dot(state_.x.col(first + body_.tree.roots[0].particle));
  to.friction = c.friction;
  to.restitution = c.restitution;
  for (int k = 0; k < 3; ++k) {
    to.normal[k] = c.normal[k];
    to.motion[k] = c.surface_motion[k];
  }
  lane.contacts[lane.contact_count++] = to;
}

/// Slots of the contacts, and what the same ones pressed with in the last step: a feature's with
/// an obstacle in their order.
void PackRun::sortContacts(Lane& lane) {
  if (lane.contact_count == 0) return;
  pack_.slots.assign(body_.features.size(), 0);
  int kept = 0;
  for (int i = 0; i < lane.contact_count; ++i) {
    LaneContact& c = lane.contacts[kept];
    c = lane.contacts[i];
    int& used = pack_.slots[c.feature];
    if (used >= kSlots) continue;
    int nth = 0;
    if (used > 0)
      for (int k = 0; k < kept; ++k)
        nth += lane.contacts[k].feature == c.feature && lane.contacts[k].obstacle == c.obstacle;
    c.slot = step_.plane_count + used++;
    for (int k = 0; k < lane.impulse_count; ++k)
      if (lane.impulses[k].feature == c.feature && lane.impulses[k].obstacle == c.obstacle &&
          nth-- == 0)
        std::copy_n(lane.impulses[k].impulse, 3, c.impulse);
    ++kept;
  }
  lane.contact_count = kept;
}

/// Of a stick, or one particle.
Bounds PackRun::boundsOf(const Skeleton& s, int first, int a, int b) const {
  const auto x = tried_.col(first + a), y = tried_.col(first + b);
  const double pad = std::max(s.radius[a], s.radius[b]);
  return {x.cwiseMin(y).array() - pad, x.cwiseMax(y).array() + pad};
}

/// Whether a particle has gone deep where no row held it off; tried_: where the body is now.
bool PackRun::particlesSink(const Ragdoll& r, const StepBounds& bounds,
                            const SweptObstacle& m) const {
  const Skeleton& s = model_.skeletonOf(r);
  for (int i = 0; i < s.named; ++i) {
    if (body_.tree.roots[0].pinned && body_.tree.roots[0].particle == i) continue;
    if (!overlap(boundsOf(s, r.first, i, i), m.bounds, -bounds.particle)) continue;
    const Vec3 x0 = state_.x.col(r.first + i), x1 = tried_.col(r.first + i);
    const double gap = signedDistanceValue(*m.obstacle, m.toEnd(x1)) - s.radius[i];
    const double before = signedDistanceValue(*m.obstacle, m.toStart(x0)) - s.radius[i];
    if (gap < -bounds.particle && gap < before - kDeeper * bounds.particle) return true;
  }
  return false;
}

/// Whether a stick has turned over an edge into an obstacle, maybe with its axis; tried_:
/// where the body is now. By how much bounds overlap along an axis bounds the depth.
bool PackRun::sticksSink(const Ragdoll& r, const StepBounds& bounds, const SweptObstacle& m) const {
  const Skeleton& s = model_.skeletonOf(r);
  return std::any_of(s.sticks.begin(), s.sticks.end(), [&](const Stick& k) {
    if (k.a >= s.named || k.b >= s.named ||
        !overlap(boundsOf(s, r.first, k.a, k.b), m.bounds, -bounds.stick))
      return false;
    const int a = r.first + k.a, b = r.first + k.b;
    const double gap = stickGap(*m.obstacle, m.toEnd(tried_.col(a)), m.toEnd(tried_.col(b)),
                                s.radius[k.a], s.radius[k.b]);
    if (gap >= -bounds.stick) return false;
    const double before = stickGap(*m.obstacle, m.toStart(state_.x.col(a)),
                                   m.toStart(state_.x.col(b)), s.radius[k.a], s.radius[k.b]);
    return gap < before - kDeeper * bounds.stick;
  });
}

/// Whether something is deep in an obstacle that no row has kept out.
bool PackRun::sinks(int l) const {
  const Ragdoll& r = model_.ragdolls[ragdollOf(l)];
  const StepBounds& bounds = lanes_[l].bounds;
  const Skeleton& s = model_.skeletonOf(r);
  Bounds all = boundsOf(s, r.first, 0, 0);
  for (int i = 1; i < s.named; ++i) {
    const Bounds one = boundsOf(s, r.first, i, i);
    all = {all.lo.cwiseMin(one.lo), all.hi.cwiseMax(one.hi)};
  }
  return std::any_of(scratch_.obstacles.begin(), scratch_.obstacles.end(),
                     [&](const SweptObstacle& m) {
                       return overlap(all, m.bounds, -bounds.particle) &&
                              (particlesSink(r, bounds, m) || sticksSink(r, bounds, m));
                     });
}

/// Whether limbs come near each other on the way: what touches is for shake.
bool PackRun::touchesItself(int index) {
  if (!model_.self_collision) return false;
  pack_.found.clear();
  pack_.detector.appendSelf(model_, state_.x, tried_, index, PairSearch::touches(kSelfNear),
                            pack_.found);
  return !pack_.found.empty();
}

/// What became of a body.
void PackRun::keep(int l) {
  const Lane& lane = lanes_[l];
  const int index = ragdollOf(l);
  if (!lane.good || (lane.deep && sinks(l)) || touchesItself(index)) {
    batch_.left.push_back(index);
    batch_.hits.push_back(lane.hit);
    return;
  }
  accept(l);
}

void PackRun::accept(int l) {
  const Lane& lane = lanes_[l];
  const int index = ragdollOf(l);
  const Ragdoll& r = model_.ragdolls[index];
  const int n = 3 * body_.tree.particles;
  if (lane.tried()) {
    std::copy_n(lane.tried_x, n, lane.x1);
    std::copy_n(lane.tried_v, n, lane.v1);
  }
  const auto add = [&](int a, int b, int obstacle, const Vec3& impulse) {
    batch_.impulses.emplace_back();
    CachedImpulse& last = batch_.impulses.back();
    last.ragdoll = index;
    last.a = a;
    last.b = b;
    last.obstacle = obstacle;
    last.impulse = kKept * impulse;
  };
  supports_.gripped[index] = 0;
  for (int k = 0; k < lane.impulse_count; ++k) {
    const LaneImpulse& last = lane.impulses[k];
    const Feature& f = body_.features[last.feature];
    if (last.grips) supports_.gripped[index] = 1;
    add(r.first + f.a, f.b < 0 ? -1 : r.first + f.b, last.obstacle,
        {last.impulse[0], last.impulse[1], last.impulse[2]});
  }
  batch_.contacts += lane.impulse_count;
  if (lane.limited) batch_.limited.push_back(index);
  for (std::size_t i = 0; i < body_.limits.size(); ++i)
    if (lane.limit_impulse[i] > 0)
      add(-1 - static_cast<int>(i), body_.limits[i].joint, -1, {lane.limit_impulse[i], 0, 0});
}

void clear(Batch& batch) {
  batch.impulses.clear();
  batch.left.clear();
  batch.hits.clear();
  batch.limited.clear();
  batch.contacts = 0;
}

bool stepsInParts(const StepContext& context, const FastScratch& scratch) {
  return !isDriven(scratch) && !context.model.self_collision;
}

void stepPack(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
              Batch& batch) {
  PackTask task;
  task.h = context.h;
  task.bounds = stepsInParts(context, scratch) ? kOfStep : kOfPart;
  task.order = scratch.order.data();
  PackRun(context, task, scratch, pack.predicted, pack.predicted, pack, batch).run();
}

}  // namespace ragdoll::fast
