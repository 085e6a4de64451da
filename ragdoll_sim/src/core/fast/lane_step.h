// One step of a pack of bodies. docs/fast.md#step.
#pragma once

#include "core/fast/lane_energy.h"
#include "core/fast/lane_guess.h"
#include "core/fast/lane_limits.h"
#include "core/fast/lane_rates.h"
#include "core/fast/lane_search.h"
#include "core/fast/pack_transpose.h"

namespace ragdoll::fast {

/// out[i], lane l = numbers of lane l less what is at less(l): x, y, z, x, y ..., or null.
template <class L, class From, class Less>
RAGDOLL_INLINE void gatherLanes(int n, const From& from, const Less& less, typename L::R* out) {
  using N = typename L::N;
  constexpr int W = L::W;
  int i = 0;
  if constexpr (W > 1)
    for (; i + W <= n; i += W) {
      for (int l = 0; l < W; ++l) {
        Doubles<W> a = Doubles<W>::at(from(l) + i);
        if (less(l)) a.v -= Doubles<W>::at(less(l) + i % 3).v;
        out[i + l] = numbersOf<N>(a);
      }
      transpose(out + i);
    }
  for (; i < n; ++i)
    for (int l = 0; l < W; ++l) setLane(out[i], l, N(from(l)[i] - (less(l) ? less(l)[i % 3] : 0)));
}

/// Positions from the bodies' roots, so that single precision serves far from the world's origin.
template <class L>
RAGDOLL_SECTION void load(const FastBody& b, const PackStep& step, const Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const int n = 3 * b.tree.particles, root = 3 * b.tree.roots[0].particle;
  const int limits = static_cast<int>(b.limits.size());
  w.forced = false;
  for (int i = 0; i < limits; ++i) w.last_press[i] = R{};
  for (int l = 0; l < L::W; ++l) {
    const Lane& lane = lanes[l];
    for (int c = 0; c < L::W + 3; ++c) w.origin[l][c] = lane.x[root + c % 3];
    const double share = 0.5 * lane.h * lane.h;
    setLane(w.h, l, N(lane.h));
    setLane(w.rate, l, N(1 / lane.h));
    setLane(w.half, l, N(share));
    setLane(w.bound, l, N(lane.bounds.particle));
    setLane(w.opens, l, N(std::min(kRecovery, kRecoveryRate * lane.h)));
    for (int i = 0; i < (lane.limits_pressed ? limits : 0); ++i)
      setLane(w.last_press[i], l, N(share * lane.limit_impulse[i]));
    for (int p = 0; p < step.plane_count; ++p)
      setLane(w.offset[p], l,
              N(offsetFrom(w.origin[l], step.planes[p].normal, step.planes[p].offset)));
    setLane(w.shift.x, l, N(lane.pin[0]));
    setLane(w.shift.y, l, N(lane.pin[1]));
    setLane(w.shift.z, l, N(lane.pin[2]));
    w.forced = w.forced || lane.force;
  }
  gatherLanes<L>(
      n, [&](int l) { return lanes[l].x; }, [&](int l) { return w.origin[l]; }, w.x);
  gatherLanes<L>(
      n, [&](int l) { return lanes[l].v; }, [](int) -> const double* { return nullptr; }, w.v);
  if (!w.forced) return;
  for (int i = 0; i < n; ++i) {
    w.force[i] = R{};
    for (int l = 0; l < L::W; ++l)
      if (lanes[l].force) setLane(w.force[i], l, N(lanes[l].h * lanes[l].h * lanes[l].force[i]));
  }
}

/// What no pin holds and no bound of energy has drawn back has the momentum of the free motion and
/// of what presses on it, whatever the rounds have left: shifts w.dx as a whole.
template <class L>
RAGDOLL_SECTION void keepWhole(const FastBody& b, const Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  if (b.tree.roots[0].pinned) return;
  V3<R> whole = w.whole;
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    whole = whole + row.press * row.axes[0] + row.pull[0] * row.axes[1] + row.pull[1] * row.axes[2];
  }
  R share = R{} + N(1 / massOf(b));
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].limited) setLane(share, l, N(0));
  const V3<R> shift = share * (whole - wholeOf<L>(b, w.dx));
  for (int i = 0; i < 3 * b.tree.particles; i += 3) store3(load3(w.dx + i) + shift, w.dx + i);
}

/// w.goal and the energy before of the free motion, which stands in w.spare: h v + fall.
template <class L>
RAGDOLL_SECTION void setGoal(const FastBody& b, const V3<typename L::R>& fall, L& w) {
  tree::momentum(b.tree, w.spare, w.tree);
  w.whole = wholeOf<L>(b, w.spare);
  w.before = energyBefore(b, fall, w);
  if (w.forced)
    for (int i = 0; i < 3 * b.tree.particles; i += 3) {
      const V3<typename L::R> poke = load3(w.force + i);
      store3(load3(w.tree.force + i) + poke, w.tree.force + i);
      w.whole = w.whole + poke;
    }
  tree::gather(b.tree, w.tree, w.goal);
  tree::solveUp(b.tree, w.tree, w.goal);
}

/// w.y: what the coordinates still have to change by.
template <class L>
RAGDOLL_SECTION void setRest(const FastBody& b, L& w) {
  tree::project(b.tree, w.tree, w.dx, w.done);
  tree::solveUp(b.tree, w.tree, w.done);
  for (int k = 0; k < b.tree.size; ++k) w.y[k] = w.goal[k] - w.done[k];
}

/// Changes the coordinates by L^-1 y.
template <class L>
RAGDOLL_SECTION void moveOn(const FastBody& b, L& w) {
  tree::solveDown(b.tree, w.tree, w.y);
  for (int k = 0; k < b.tree.size; ++k) w.q[k] += w.y[k];
}

/// How far lengths are from the model's at the start, in units of what is allowed, squared sines'
/// bound: what is being joined is not for a pack.
template <class L>
RAGDOLL_SECTION void checkLengths(const FastBody& b, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  for (const TreeLink& k : b.tree.links) {
    const V3<R> e = load3(w.x + 3 * k.base[0]) - load3(w.x + 3 * k.attach);
    const N length2 = N(k.base_reach * k.base_reach);
    const R error = N(0.5) / length2 * (dot(e, e) - length2);
    w.off = larger(w.off, N(kMostSine2 / kMostStretch) * (signOf(error) * error));
  }
}

/// Damping, where there is any.
template <class L>
RAGDOLL_INLINE void damp(const FastBody& b, const Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  R keep, keep_inner;
  bool all = false, inner = false;
  for (int l = 0; l < L::W; ++l) {
    setLane(keep, l, N(lanes[l].keep));
    setLane(keep_inner, l, N(lanes[l].keep_inner));
    all = all || lanes[l].keep != 1;
    inner = inner || lanes[l].keep_inner != 1;
  }
  if (all)
    for (int i = 0; i < 3 * b.tree.particles; ++i) w.v[i] = keep * w.v[i];
  if (inner) dampInside(b, keep_inner, w);
}

template <class L>
void predict(const FastBody& b, const PackStep& step, Lane* lanes, void* memory) {
  using R = typename L::R;
  using N = typename L::N;
  L& w = *L::in(memory, b, step.plane_count);
  const Tree& t = b.tree;
  const int n = 3 * t.particles;
  load(b, step, lanes, w);
  damp(b, lanes, w);
  w.off = R{};
  checkLengths(b, w);
  setTree(b, w);
  R fastest{};
  for (int i = 0; i < n; i += 3) fastest = larger(fastest, dot(load3(w.v + i), load3(w.v + i)));
  w.travel = w.h * squareRoot(fastest);
  w.margin = N(kNear) + N(kReach) * w.travel;
  const V3<R> fall = w.half * spread3<L>(step.gravity);
  for (int i = 0; i < n; i += 3) store3(w.h * load3(w.v + i) + fall, w.spare + i);
  setGoal(b, fall, w);
  for (int k = 0; k < t.size; ++k) w.q[k] = R{};
  if (t.roots[0].pinned) {
    setPose(b, w);
    setRest(b, w);
  } else {
    for (int k = 0; k < t.size; ++k) w.y[k] = w.goal[k];
  }
  moveOn(b, w);
  extrapolate(b, w);
  setPose(b, w);
  findSolids(b, step, lanes, w);
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].predicted && (step.whole || lanes[l].hard_count > 0))
      for (int i = 0; i < n; ++i) lanes[l].predicted[i] = lanes[l].x[i] + lane(w.dx[i], l);
}

/// Positions (w.x) and velocities (w.dx, times h), which it uses up, of the bodies that came
/// through.
template <class L>
RAGDOLL_SECTION void store(const FastBody& b, Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const int n = 3 * b.tree.particles;
  R sum[2] = {R{}, R{}};
  for (int i = 0; i < n; ++i) {
    sum[0] += w.x[i];
    sum[1] += w.dx[i];
  }
  for (int l = 0; l < L::W; ++l) {
    Lane& out = lanes[l];
    out.good = lane(w.off, l) < N(kMostSine2) && std::isfinite(lane(sum[0], l)) &&
               std::isfinite(lane(sum[1], l));
  }
  int i = 0;
  if constexpr (L::W > 1)
    for (; i + L::W <= n; i += L::W) {
      transpose(w.x + i);
      transpose(w.dx + i);
      for (int l = 0; l < L::W; ++l) {
        if (!lanes[l].good) continue;
        Doubles<L::W> x = doublesOf(w.x[i + l]), v = doublesOf(w.dx[i + l]);
        x.v += Doubles<L::W>::at(w.origin[l] + i % 3).v;
        v.v *= 1 / lanes[l].h;
        x.to((lanes[l].tried() ? lanes[l].tried_x : lanes[l].x1) + i);
        v.to((lanes[l].tried() ? lanes[l].tried_v : lanes[l].v1) + i);
      }
    }
  for (; i < n; ++i)
    for (int l = 0; l < L::W; ++l) {
      const Lane& out = lanes[l];
      if (!out.good) continue;
      (out.tried() ? out.tried_x : out.x1)[i] = w.origin[l][i % 3] + lane(w.x[i], l);
      (out.tried() ? out.tried_v : out.v1)[i] = 1 / out.h * lane(w.dx[i], l);
    }
}

/// [kg m] h times the impulse of a row that presses: of the step and of the velocity stage.
template <class R>
RAGDOLL_INLINE R pressOf(const ContactRow<R>& row) {
  return row.rate_press + (row.press - row.impact);
}
template <class R>
RAGDOLL_INLINE R pullOf(const ContactRow<R>& row, int c) {
  using N = typename tree::NumberOf<R>::Type;
  return row.rate_pull[c] + (row.press - row.impact) / atLeast(row.press, N(1e-30)) * row.pull[c];
}

/// Whether friction is less than it could be, as isInsideCone (mechanics/supports.h).
RAGDOLL_INLINE bool grips(double friction, double press, double first, double second) {
  const double cone = (1 - 1e-6) * friction * press;
  return press > 0 && first * first + second * second < cone * cone;
}

template <class L>
RAGDOLL_SECTION void storePresses(const FastBody& b, Lane* lanes, const L& w) {
  using R = typename L::R;
  for (int l = 0; l < L::W; ++l) {
    Lane& out = lanes[l];
    if (!out.good) continue;
    const double rate2 = 1 / (out.h * out.h);
    out.impulse_count = 0;
    for (int i = 0; i < w.contact_count; ++i) {
      const ContactRow<R>& row = w.contacts[i];
      if (!(lane(row.press, l) > 0)) continue;
      const R f[] = {pressOf(row), pullOf(row, 0), pullOf(row, 1)};
      LaneImpulse& to = out.impulses[out.impulse_count++];
      to.feature = static_cast<int>(row.feature - b.features.data());
      to.obstacle = w.obstacle_of[i * L::W + l];
      to.grips = grips(lane(row.friction, l), lane(f[0], l), lane(f[1], l), lane(f[2], l));
      for (int c = 0; c < 3; ++c) to.impulse[c] = 0;
      for (int k = 0; k < 3; ++k) {
        to.impulse[0] += rate2 * lane(f[k], l) * lane(row.axes[k].x, l);
        to.impulse[1] += rate2 * lane(f[k], l) * lane(row.axes[k].y, l);
        to.impulse[2] += rate2 * lane(f[k], l) * lane(row.axes[k].z, l);
      }
    }
    for (std::size_t i = 0; i < b.limits.size(); ++i) out.limit_impulse[i] = 0;
    for (int i = 0; i < w.limit_count; ++i)
      out.limit_impulse[w.limits[i].limit - b.limits.data()] =
          2 * rate2 * lane(w.limits[i].press, l);
  }
}

/// Where something is deeper than it may be left.
template <class L>
RAGDOLL_INLINE typename L::Mask tooDeep(const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  auto deep = less(R{}, R{});
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    const auto worse =
        both(less(row.gap + row.allowed, R{} - w.bound), less(row.gap, N(-kWorse) * w.bound));
    deep = either(deep, both(worse, less(R{}, row.inverse_normal + row.waits)));
  }
  return deep;
}

/// Where something began deeper than packs let it sink, in what rests or is driven: what moves
/// opens it itself.
template <class L>
RAGDOLL_INLINE typename L::Mask beganDeep(const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  auto deep = less(R{}, R{});
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    const double most = row.feature->b < 0 ? kSunkParticle : kSunkStick;
    const R began = row.start + dot(row.axes[0], row.motion);
    deep =
        either(deep, both(less(began, R{} - N(most)), less(R{}, row.inverse_normal + row.waits)));
  }
  const auto rests = less(w.square, R{} + N(kRests * kRests));
  return both(deep, either(rests, less(R{} + N(0.5 * kNoBound), w.recovery)));
}

/// first <- the share of the step after which something is hit, where it presses, comes faster than
/// `fast` and is the first. gap: at the step's start; free: where the free motion leads, by a
/// parabola that closes as `approach` at first.
template <class L>
RAGDOLL_INLINE void takeHit(const typename L::R& gap, const typename L::R& free,
                            const typename L::R& approach, const typename L::R& press,
                            const typename L::R& fast, const L& w, typename L::R& first) {
  using R = typename L::R;
  using N = typename L::N;
  const R speed = w.rate * (gap - free);
  const auto comes = both(less(fast, speed), less(R{}, press));
  if (!any(comes)) return;
  const R before = atLeast(gap, N(0)), closes = w.h * approach, bends = free - gap + closes;
  const R root = squareRoot(atLeast(closes * closes - N(4) * bends * before, N(0)));
  const R after = N(2) * before / atLeast(closes + root, N(1e-30));
  first = select(both(comes, less(after, first)), after, first);
}

/// Where something is hit, or reaches its limit, that comes too fast for a step that does not find
/// when; when the first of it comes goes to the lanes.
template <class L>
RAGDOLL_INLINE typename L::Mask findHits(Lane* lanes, const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  R fast, first = R{} + N(1);
  for (int l = 0; l < L::W; ++l) setLane(fast, l, N(lanes[l].bounds.stopped));
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    takeHit(R(row.start + dot(row.axes[0], row.motion)), row.free, row.approach, row.press, fast, w,
            first);
  }
  for (int i = 0; i < w.limit_count; ++i) {
    const LimitRow<R>& row = w.limits[i];
    if (row.limit->compliance == 0)
      takeHit(row.start, row.free, R(w.rate * (row.start - row.free)), row.press,
              R(N(kStopReach) * fast), w, first);
  }
  for (int l = 0; l < L::W; ++l) lanes[l].hit = lane(first, l);
  return less(first, R{} + N(1));
}

/// What the rounds have not brought to its bounds is not for a pack (w.off above its own).
template <class L>
RAGDOLL_SECTION void checkBounds(Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const auto leaves = either(findHits(lanes, w), either(tooDeep(w), beganDeep(w)));
  w.off = select(leaves, R{} + N(1), w.off);
  for (int i = 0; i < w.limit_count; ++i) {
    const LimitRow<R>& row = w.limits[i];
    if (row.limit->compliance > 0) continue;
    const auto deep =
        both(less(row.value, R{} - N(kMostAngle)), less(R{}, row.inverse + row.waits));
    w.off = select(deep, R{} + N(1), w.off);
  }
}

/// What rows pressed with in the last step.
template <class L>
RAGDOLL_SECTION void startRows(L& w) {
  using R = typename L::R;
  for (int i = 0; i < w.awake_count; ++i) {
    const ContactRow<R>& row = w.contacts[w.awake[i]];
    if (any(less(R{}, row.press))) push(w, row, row.press, row.pull);
  }
  for (int i = 0; i < w.limit_count; ++i)
    if (any(less(R{}, w.limits[i].press)))
      pushAlong<1>(w.limits[i].limit->row, w.limits[i].z, &w.limits[i].press, w);
}

/// Lanes whose rows do not move any more rest: they are not swept on for their neighbours' sake.
template <class L>
RAGDOLL_SECTION void sweepRows(L& w) {
  using R = typename L::R;
  w.unsettled = w.unsolved;
  for (int sweep = 0; sweep < kSweeps && any(w.unsettled); ++sweep) {
    w.change = R{};
    sweepContacts(w);
    sweepLimits(w);
    w.unsettled = both(w.unsettled, less(w.settled, w.change));
  }
}

/// As moveOn, of the lanes that are not solved yet; what is left then is of second order, and what
/// has come near.
template <class L>
RAGDOLL_SECTION void endRound(const FastBody& b, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  R before{}, after{}, change{};
  const auto largest = [](R& most, const R& value) { most = larger(most, signOf(value) * value); };
  for (int k = 0; k < b.tree.size; ++k) w.goal[k] = w.done[k] + w.y[k];
  tree::solveDown(b.tree, w.tree, w.y);
  const int first_turn = b.tree.roots[0].pinned ? 0 : 3;
  for (int k = 0; k < b.tree.size; ++k) {
    const R last = w.q[k];
    w.q[k] = select(w.unsolved, last + w.y[k], last);
    if (k < first_turn) continue;  // a shift has no second order
    largest(before, last);
    largest(change, w.y[k]);
    largest(after, w.q[k]);
  }
  setPose(b, w);
  const auto turns = less(R{} + N(kSettled), (before + after) * change);
  const auto sunk = either(measureContacts(b, w), measureLimits(b, w));
  w.unsolved = both(w.unsolved, either(sunk, either(turns, w.unsettled)));
}

/// The pack that `predict` has left in memory.
template <class L>
RAGDOLL_INLINE L& workIn(void* memory) {
  return *reinterpret_cast<L*>((reinterpret_cast<std::uintptr_t>(memory) + 63) &
                               ~std::uintptr_t(63));
}

/// [m] By which the body can be lifted in the step by the energy that it has: what opens an overlap
/// needs it, and without it the bound of energy would hold the whole body as it is.
template <class L>
RAGDOLL_INLINE void setRecovery(const FastBody& b, const PackStep& step, const Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  double pull = 0;
  for (int c = 0; c < 3; ++c) pull += step.gravity[c] * step.gravity[c];
  w.square = N(2 / massOf(b)) * atLeast(w.before, N(0));  // r^2 / h^2 + 2 g r
  const R root = squareRoot(R{} + N(pull) + w.rate * w.rate * w.square);
  w.recovery = w.square / atLeast(N(std::sqrt(pull)) + root, N(1e-30));
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].driven) setLane(w.recovery, l, N(kNoBound));
}

/// Rows; where the free motion leads.
template <class L>
RAGDOLL_INLINE void beginRounds(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using R = typename L::R;
  w.z_next = w.z;
  w.settled = typename L::N(kSettledSpeed) * w.h;
  setRecovery(b, step, lanes, w);
  setContacts(b, step, lanes, w);
  setLimits(b, w);
  w.unsolved = less(R{}, R{} + typename L::N(1));
  measureContacts(b, w);
  for (int i = 0; i < w.contact_count; ++i)
    w.contacts[i].free = w.contacts[i].gap + w.contacts[i].allowed;
}

/// 1 in the lanes that an obstacle presses.
template <class L>
RAGDOLL_INLINE typename L::R touchedOf(const L& w) {
  using R = typename L::R;
  R touched{};
  for (int i = 0; i < w.contact_count; ++i)
    touched = larger(touched, select(less(R{}, w.contacts[i].press), R{} + typename L::N(1), R{}));
  return touched;
}

/// Those, and in which a rigid limit presses.
template <class L>
RAGDOLL_INLINE typename L::R pressedOf(const L& w, typename L::R pressed) {
  using R = typename L::R;
  for (int i = 0; i < w.limit_count; ++i)
    if (w.limits[i].limit->compliance == 0)
      pressed = larger(pressed, select(less(R{}, w.limits[i].press), R{} + typename L::N(1), R{}));
  return pressed;
}

/// [J] What nothing presses may gain.
RAGDOLL_INLINE double freeGain(const FastBody& b) {
  return 0.5 * kFreeGain * kFreeGain * massOf(b);
}

template <class L>
void finish(const FastBody& b, const PackStep& step, Lane* lanes, void* memory) {
  using R = typename L::R;
  using N = typename L::N;
  L& w = workIn<L>(memory);
  beginRounds(b, step, lanes, w);
  for (int round = 0; round < kMostRounds && any(w.unsolved); ++round) {
    if (round >= kNewton) {
      w.unsolved = both(w.unsolved, tooDeep(w));
      if (!any(w.unsolved)) break;
    }
    setRest(b, w);
    if (round == 0) startRows(w);
    sweepRows(w);
    endRound(b, w);
  }
  checkBounds(lanes, w);
  const R touched = touchedOf(w), pressed = pressedOf(w, touched);
  if (any(less(R{}, touched))) limitMotion(b, step, lanes, w, touched);
  keepWhole(b, lanes, w);
  tree::place(b.tree, w.tree, w.x, w.dx, w.x);  // the new positions
  const R slack = select(less(R{}, pressed), R{}, R{} + N(freeGain(b)));
  const R kept = energyBound(b, step, lanes, w, 1);
  endVelocities(b, step, w);
  limitVelocities(b, lanes, w, kept, slack, touched);
  findDeep(b, step, lanes, w);
  store(b, lanes, w);
  storePresses(b, lanes, w);
}

}  // namespace ragdoll::fast
