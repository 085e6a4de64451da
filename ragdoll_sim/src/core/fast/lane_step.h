// One step of a pack of bodies. docs/fast.md#step.
#pragma once

#include "core/fast/lane_bounds.h"
#include "core/fast/lane_energy.h"
#include "core/fast/lane_guess.h"
#include "core/fast/lane_limits.h"
#include "core/fast/lane_rates.h"
#include "core/fast/lane_search.h"
#include "core/fast/lane_store.h"

namespace ragdoll::fast {

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
  setAngular(b, w);
  w.poked = typename L::R{};
  if (w.forced)
    for (int i = 0; i < 3 * b.tree.particles; i += 3) {
      const V3<typename L::R> poke = load3(w.force + i);
      w.poked = select(less(typename L::R{}, dot(poke, poke)), typename L::R{} + typename L::N(1),
                       w.poked);
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
  const auto turns = less(R{} + N(w.settled_turns), (before + after) * change);
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

/// [rad^2] of a step.
RAGDOLL_INLINE double settledTurns(double h) {
  const double share = h < kSettledStep ? h / kSettledStep : 1;
  return kSettled * share * share * share * share;
}

/// Rows; where the free motion leads.
template <class L>
RAGDOLL_INLINE void beginRounds(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using R = typename L::R;
  w.z_next = w.z;
  w.settled = typename L::N(kSettledSpeed) * w.h;
  w.settled_turns = settledTurns(step.h);
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
  keepAngular(b, touched, w);
  limitVelocities(b, lanes, w, kept, slack, touched);
  findDeep(b, step, lanes, w);
  store(b, lanes, w);
  storePresses(b, lanes, w);
}

}  // namespace ragdoll::fast
