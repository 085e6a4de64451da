#include "core/fast/pack_run.h"

#include <algorithm>
#include <cmath>

#include "core/contact/detect.h"
#include "core/contact/distance.h"
#include "core/contact/pair_detect.h"
#include "core/fast/constants.h"
#include "core/fast/dispatch.h"

namespace ragdoll::fast {
namespace {

/// Of a force, in the state: what the direct methods keep, whose position stage gives it over half
/// a step. So a body that goes from one to the other starts with what pressed.
constexpr double kKept = 0.5;

/// One pack on its way through a step.
class PackRun {
 public:
  /// left: parts like this one, it too, until the step's end. order: ragdolls, of which the batch
  /// has some. last: impulses of the part before; null: those of the state.
  PackRun(const StepContext& context, double h, int left, const StepBounds& bounds,
          const int* order, const std::vector<CachedImpulse>* last, const FastScratch& scratch,
          PackScratch& pack, Batch& batch)
      : model_(context.model),
        inputs_(context.inputs),
        h_(h),
        left_(left),
        bounds_(bounds),
        order_(order),
        last_(last),
        force_(context.force),
        scratch_(scratch),
        pack_(pack),
        predicted_(pack.predicted),
        state_(context.state),
        batch_(batch),
        body_(scratch.bodies[batch.system]),
        method_(packFor(context.model.solver.numbers == Numbers::kFloat, batch.count,
                        scratch.most_lanes)) {}

  void run() {
    prepare();
    method_.predict(body_, step_, lanes_, pack_.memory.data());
    for (int l = 0; l < batch_.count; ++l) endSearch(l);
    method_.finish(body_, step_, lanes_, pack_.memory.data());
    for (int l = 0; l < batch_.count; ++l) keep(l);
  }

 private:
  int ragdollOf(int l) const { return order_[batch_.begin + l]; }

  void setStep() {
    const SolverSpec& solver = model_.solver;
    step_.h = h_;
    step_.bounds = bounds_;
    for (int c = 0; c < 3; ++c) step_.gravity[c] = model_.gravity[c];
    step_.keep = solver.damping > 0 ? std::exp(-solver.damping * h_) : 1;
    step_.keep_inner = solver.joint_damping > 0 ? std::exp(-solver.joint_damping * h_) : 1;
    step_.planes = scratch_.planes.data();
    step_.plane_count = static_cast<int>(scratch_.planes.size());
    step_.solids = scratch_.solids.data();
    step_.solid_count = static_cast<int>(scratch_.solids.size());
    step_.whole = !scratch_.moving_planes.empty();
  }

  void prepare() {
    predicted_.resize(3, model_.size());
    const int n = 3 * body_.tree.particles, limits = static_cast<int>(body_.limits.size());
    setStep();
    const std::size_t bytes = method_.memory(body_, step_.plane_count) + 64;
    if (pack_.memory.size() < bytes) pack_.memory.resize(bytes);
    room_ = impulseRoom(body_, step_.plane_count);
    pack_.spare.resize(2 * kMaxLanes * n);
    if (static_cast<int>(pack_.start.size()) < 2 * kMaxLanes * n)
      pack_.start.resize(2 * kMaxLanes * n);
    pack_.limit_impulses.assign(kMaxLanes * limits + 1, 0.0);
    if (static_cast<int>(pack_.impulses.size()) < kMaxLanes * room_)
      pack_.impulses.resize(kMaxLanes * room_);
    const int features = static_cast<int>(body_.features.size());
    contact_room_ = features * kSlots;
    const int hard = features * step_.solid_count;
    if (static_cast<int>(pack_.contacts.size()) < kMaxLanes * contact_room_)
      pack_.contacts.resize(kMaxLanes * contact_room_);
    if (static_cast<int>(pack_.left_over.size()) < kMaxLanes * hard)
      pack_.left_over.resize(kMaxLanes * hard);
    for (int l = 0; l < method_.lanes; ++l) {
      lanes_[l] = Lane();
      lanes_[l].limit_impulse = pack_.limit_impulses.data() + l * limits;
      lanes_[l].impulses = pack_.impulses.data() + l * room_;
      if (l < batch_.count) {
        fill(l);
        lanes_[l].contacts = pack_.contacts.data() + l * contact_room_;
        lanes_[l].contact_room = contact_room_;
        lanes_[l].hard = pack_.left_over.data() + l * hard;
        lanes_[l].hard_room = hard;
      } else {  // a lane for no body: the first one's again
        lanes_[l].x = lanes_[0].x;
        lanes_[l].v = lanes_[0].v;
        lanes_[l].x1 = lanes_[l].tried_x = pack_.spare.data() + n * (kMaxLanes + l);
        lanes_[l].v1 = pack_.spare.data() + n * l;
      }
      lanes_[l].tried_v = pack_.spare.data() + n * l;
    }
  }

  void fill(int l) {
    Lane& lane = lanes_[l];
    const int index = ragdollOf(l);
    const Ragdoll& r = model_.ragdolls[index];
    lane.x = state_.x.data() + 3 * r.first;
    lane.v = state_.v.data() + 3 * r.first;
    lane.x1 = state_.x.data() + 3 * r.first;
    lane.v1 = state_.v.data() + 3 * r.first;
    lane.tried_x = predicted_.data() + 3 * r.first;
    lane.on_trial = model_.self_collision;
    if (!scratch_.obstacles.empty() || step_.whole)
      lane.predicted = predicted_.data() + 3 * r.first;
    if (force_) lane.force = force_->data() + 3 * r.first;
    lane.driven = scratch_.driven;
    if (last_)
      for (const CachedImpulse& last : *last_) {
        if (last.ragdoll == index) takeImpulse(last, r, lane);
      }
    else
      for (int k = scratch_.first_impulse[index]; k < scratch_.first_impulse[index + 1]; ++k)
        takeImpulse(state_.impulses[scratch_.cached[k]], r, lane);
    for (std::size_t p = 0; p < inputs_.pins.size(); ++p) {
      if (model_.pins[p].ragdoll != index) continue;
      const Vec3 motion = inputs_.pins[p] - state_.x.col(model_.pins[p].particle);
      for (int c = 0; c < 3; ++c) lane.pin[c] = motion[c] / left_;
      lane.driven = lane.driven || motion != Vec3::Zero();
    }
  }

  void takeImpulse(const CachedImpulse& last, const Ragdoll& r, Lane& lane) const {
    if (last.a < 0) {
      if (-1 - last.a < static_cast<int>(body_.limits.size()))
        lane.limit_impulse[-1 - last.a] = last.impulse.x() / kKept;
      lane.limits_pressed = true;
      return;
    }
    if (last.obstacle < 0) return;
    const int feature = featureOf(last.a - r.first, last.b < 0 ? -1 : last.b - r.first);
    if (feature < 0 || lane.impulse_count >= room_) return;
    LaneImpulse& to = lane.impulses[lane.impulse_count++];
    to.feature = feature;
    to.obstacle = last.obstacle;
    for (int c = 0; c < 3; ++c) to.impulse[c] = last.impulse[c] / kKept;
  }

  int featureOf(int a, int b) const {
    if (b < 0) return a < body_.particles ? a : -1;
    for (std::size_t f = body_.particles; f < body_.features.size(); ++f)
      if (body_.features[f].a == a && body_.features[f].b == b) return static_cast<int>(f);
    return -1;
  }

  /// What the pack has left over, and planes that move; then slots and last impulses of all.
  void endSearch(int l) {
    const int index = ragdollOf(l);
    Lane& lane = lanes_[l];
    pack_.found.clear();
    const double margin = lane.hard_count > 0 || step_.whole ? searchMargin(index) : 0;
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
  double searchMargin(int index) const {
    const int first = model_.ragdolls[index].first;
    const double speed = std::sqrt(
        state_.v.middleCols(first, body_.tree.particles).colwise().squaredNorm().maxCoeff());
    return std::min({kMargin, kAside * h_, kNear + kReach * h_ * speed});
  }

  void addContact(const Contact& c, int first, Lane& lane) const {
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
  void sortContacts(Lane& lane) {
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
  Bounds boundsOf(const Skeleton& s, int first, int a, int b) const {
    const auto x = predicted_.col(first + a), y = predicted_.col(first + b);
    const double pad = std::max(s.radius[a], s.radius[b]);
    return {x.cwiseMin(y).array() - pad, x.cwiseMax(y).array() + pad};
  }

  /// Whether a particle has gone deep where no row held it off; predicted_: where the body is now.
  bool particlesSink(const Ragdoll& r, const SweptObstacle& m) const {
    const Skeleton& s = model_.skeletonOf(r);
    for (int i = 0; i < s.named; ++i) {
      if (body_.tree.roots[0].pinned && body_.tree.roots[0].particle == i) continue;
      if (!overlap(boundsOf(s, r.first, i, i), m.bounds, -bounds_.particle)) continue;
      const Vec3 x0 = state_.x.col(r.first + i), x1 = predicted_.col(r.first + i);
      const double gap = signedDistanceValue(*m.obstacle, m.toEnd(x1)) - s.radius[i];
      const double before = signedDistanceValue(*m.obstacle, m.toStart(x0)) - s.radius[i];
      if (gap < -bounds_.particle && gap < before - kDeeper * bounds_.particle) return true;
    }
    return false;
  }

  /// Whether a stick has turned over an edge into an obstacle, maybe with its axis; predicted_:
  /// where the body is now. By how much bounds overlap along an axis bounds the depth.
  bool sticksSink(const Ragdoll& r, const SweptObstacle& m) const {
    const Skeleton& s = model_.skeletonOf(r);
    return std::any_of(s.sticks.begin(), s.sticks.end(), [&](const Stick& k) {
      if (k.a >= s.named || k.b >= s.named ||
          !overlap(boundsOf(s, r.first, k.a, k.b), m.bounds, -bounds_.stick))
        return false;
      const int a = r.first + k.a, b = r.first + k.b;
      const double gap = stickGap(*m.obstacle, m.toEnd(predicted_.col(a)),
                                  m.toEnd(predicted_.col(b)), s.radius[k.a], s.radius[k.b]);
      if (gap >= -bounds_.stick) return false;
      const double before = stickGap(*m.obstacle, m.toStart(state_.x.col(a)),
                                     m.toStart(state_.x.col(b)), s.radius[k.a], s.radius[k.b]);
      return gap < before - kDeeper * bounds_.stick;
    });
  }

  /// Whether something is deep in an obstacle that no row has kept out.
  bool sinks(int index) const {
    const Ragdoll& r = model_.ragdolls[index];
    const Skeleton& s = model_.skeletonOf(r);
    Bounds all = boundsOf(s, r.first, 0, 0);
    for (int i = 1; i < s.named; ++i) {
      const Bounds one = boundsOf(s, r.first, i, i);
      all = {all.lo.cwiseMin(one.lo), all.hi.cwiseMax(one.hi)};
    }
    return std::any_of(scratch_.obstacles.begin(), scratch_.obstacles.end(),
                       [&](const SweptObstacle& m) {
                         return overlap(all, m.bounds, -bounds_.particle) &&
                                (particlesSink(r, m) || sticksSink(r, m));
                       });
  }

  /// Whether limbs come near each other on the way: what touches is for shake.
  bool touchesItself(int index) {
    if (!model_.self_collision) return false;
    pack_.found.clear();
    PairDetector().appendSelf(model_, state_.x, predicted_, index, PairSearch::touches(kSelfNear),
                              pack_.found);
    return !pack_.found.empty();
  }

  /// What became of a body.
  void keep(int l) {
    const Lane& lane = lanes_[l];
    const int index = ragdollOf(l);
    if (!lane.good || (lane.deep && sinks(index)) || touchesItself(index)) {
      batch_.left.push_back(index);
      return;
    }
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
    for (int k = 0; k < lane.impulse_count; ++k) {
      const LaneImpulse& last = lane.impulses[k];
      const Feature& f = body_.features[last.feature];
      add(r.first + f.a, f.b < 0 ? -1 : r.first + f.b, last.obstacle,
          {last.impulse[0], last.impulse[1], last.impulse[2]});
    }
    batch_.contacts += lane.impulse_count;
    batch_.limited += lane.limited;
    for (std::size_t i = 0; i < body_.limits.size(); ++i)
      if (lane.limit_impulse[i] > 0)
        add(-1 - static_cast<int>(i), body_.limits[i].joint, -1, {lane.limit_impulse[i], 0, 0});
  }

  const Model& model_;
  const Inputs& inputs_;
  double h_;
  int left_;
  StepBounds bounds_;
  const int* order_;
  const std::vector<CachedImpulse>* last_;
  const Points* force_;
  const FastScratch& scratch_;
  PackScratch& pack_;
  Points& predicted_;
  State& state_;
  Batch& batch_;
  const FastBody& body_;
  const PackMethod& method_;
  PackStep step_;
  Lane lanes_[kMaxLanes];
  int room_ = 0, contact_room_ = 0;
};

void clear(Batch& batch) {
  batch.impulses.clear();
  batch.left.clear();
  batch.contacts = batch.limited = 0;
}

/// What packs have left, in parts of the step: what turns over an edge or is stopped errs by less
/// the shorter they are.
class Parts {
 public:
  Parts(const StepContext& context, const FastScratch& scratch, PackScratch& pack, Batch& batch)
      : context_(context), scratch_(scratch), pack_(pack), batch_(batch) {
    const auto first = scratch.again.begin() + batch.begin;
    pack.again.assign(first, first + batch.count);
    n_ = 3 * scratch.bodies[batch.system].tree.particles;
  }

  /// Leaves what does not come through either where it was.
  void run() {
    exchange(false);
    pack_.moving = pack_.again;
    const std::vector<CachedImpulse>* last = nullptr;
    for (int part = 0; part < kParts && !pack_.moving.empty(); ++part) {
      Batch& own = pack_.parts[part % 2];
      clear(own);
      own.system = batch_.system;
      own.begin = 0;
      own.count = static_cast<int>(pack_.moving.size());
      PackRun(context_, context_.h / kParts, kParts - part, kOfPart, pack_.moving.data(), last,
              scratch_, pack_, own)
          .run();
      append(own.left, batch_.left);
      const auto stays = [&own](int index) { return has(own.left, index); };
      pack_.moving.erase(std::remove_if(pack_.moving.begin(), pack_.moving.end(), stays),
                         pack_.moving.end());
      last = &own.impulses;
      add(own, part + 1 == kParts);
    }
    Roomy<CachedImpulse>& all = batch_.impulses;
    const auto stayed = [this](const CachedImpulse& p) { return has(batch_.left, p.ragdoll); };
    all.erase(std::remove_if(all.begin(), all.end(), stayed), all.end());
    exchange(true);
  }

 private:
  static bool has(const Roomy<int>& all, int index) {
    return std::find(all.begin(), all.end(), index) != all.end();
  }

  /// Contacts press with their mean over the step, limits as at its end.
  void add(const Batch& part, bool last) {
    for (std::size_t i = 0; i < part.impulses.size(); ++i) {
      const CachedImpulse& p = part.impulses[i];
      if (p.obstacle >= 0)
        sameAs(part.impulses, i).impulse += (1.0 / kParts) * p.impulse;
      else if (last)
        batch_.impulses.push_back(p);
    }
    if (!last) return;
    batch_.contacts += part.contacts;
    batch_.limited += part.limited;
  }

  /// The batch's entry of the i-th impulse of a part: the same feature's with the same obstacle, in
  /// their order.
  CachedImpulse& sameAs(const Roomy<CachedImpulse>& part, std::size_t i) {
    const CachedImpulse& p = part[i];
    const auto same = [&p](const CachedImpulse& q) {
      return q.ragdoll == p.ragdoll && q.a == p.a && q.b == p.b && q.obstacle == p.obstacle;
    };
    auto nth = std::count_if(part.begin(), part.begin() + i, same);
    for (CachedImpulse& q : batch_.impulses)
      if (same(q) && nth-- == 0) return q;
    batch_.impulses.push_back(p);
    batch_.impulses.back().impulse = Vec3::Zero();
    return batch_.impulses.back();
  }

  /// Keeps x and v, or gives them back to what is left.
  void exchange(bool back) {
    for (std::size_t i = 0; i < pack_.again.size(); ++i) {
      if (back && !has(batch_.left, pack_.again[i])) continue;
      const int first = 3 * context_.model.ragdolls[pack_.again[i]].first;
      for (double* state : {context_.state.x.data() + first, context_.state.v.data() + first}) {
        const bool is_v = state != context_.state.x.data() + first;
        double* kept = pack_.start.data() + n_ * (2 * i + is_v);
        if (back)
          std::copy_n(kept, n_, state);
        else
          std::copy_n(state, n_, kept);
      }
    }
  }

  const StepContext& context_;
  const FastScratch& scratch_;
  PackScratch& pack_;
  Batch& batch_;
  int n_ = 0;  ///< 3 per particle
};

}  // namespace

bool stepsInParts(const StepContext& context, const FastScratch& scratch) {
  return !scratch.driven && scratch.moving_planes.empty() && !context.model.self_collision;
}

void stepPack(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
              Batch& batch) {
  const StepBounds& bounds = stepsInParts(context, scratch) ? kOfStep : kOfPart;
  PackRun(context, context.h, 1, bounds, scratch.order.data(), nullptr, scratch, pack, batch).run();
}

void stepParts(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
               Batch& batch) {
  Parts(context, scratch, pack, batch).run();
}

}  // namespace ragdoll::fast
