// One step of a pack of bodies. docs/fast.md#step.
#pragma once

#include "core/fast/lane_guess.h"
#include "core/fast/lane_limits.h"
#include "core/fast/lane_presses.h"
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
  for (int l = 0; l < L::W; ++l) {
    const Lane& lane = lanes[l];
    for (int c = 0; c < L::W + 3; ++c) w.origin[l][c] = lane.x[root + c % 3];
    const double share = lane.pull * step.h * step.h;
    for (int i = 0; i < limits; ++i) setLane(w.last_press[i], l, N(share * lane.limit_impulse[i]));
    for (int p = 0; p < step.plane_count; ++p)
      setLane(w.offset[p], l,
              N(offsetFrom(w.origin[l], step.planes[p].normal, step.planes[p].offset)));
    setLane(w.pull, l, N(lane.pull));
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
  const double h2 = step.h * step.h;
  for (int i = 0; i < n; ++i) {
    w.force[i] = R{};
    for (int l = 0; l < L::W; ++l)
      if (lanes[l].force) setLane(w.force[i], l, N(h2 * lanes[l].force[i]));
  }
}

/// [J] of the particles' motion by dx in a time whose square is 1 / rate2.
template <class L>
RAGDOLL_SECTION typename L::R energyOf(const FastBody& b, const typename L::R* dx, double rate2) {
  using R = typename L::R;
  using N = typename L::N;
  R sum{};
  for (int i = 0; i < b.tree.particles; ++i) {  // the matrix is symmetric: its upper half
    const V3<R> d = load3(dx + 3 * i);
    V3<R> p{};
    for (int k = b.tree.mass_begin[i]; k < b.tree.mass_begin[i + 1]; ++k) {
      const Tree::Mass& m = b.tree.masses[k];
      if (m.column < i) continue;
      p = p + N(m.column == i ? 0.5 * m.value : m.value) * load3(dx + 3 * m.column);
    }
    sum += dot(p, d);
  }
  return N(rate2) * sum;
}

/// As joint_damping.h: velocities against those of the rigid motion with the same momenta. w.dx:
/// used.
template <class L>
RAGDOLL_SECTION void dampInside(const FastBody& b, typename L::N keep, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const Tree& t = b.tree;
  const bool pinned = t.roots[0].pinned;
  V3<R> centre{}, drift{};
  if (pinned) {
    centre = load3(w.x + 3 * t.roots[0].particle);
    drift = load3(w.v + 3 * t.roots[0].particle);
  } else {
    double whole = 0;
    for (int i = 0; i < t.particles; ++i) {
      whole += t.mass[i];
      centre = centre + N(t.mass[i]) * load3(w.x + 3 * i);
      drift = drift + N(t.mass[i]) * load3(w.v + 3 * i);
    }
    centre = N(1 / whole) * centre;
    drift = N(1 / whole) * drift;
  }
  for (int i = 0; i < t.particles; ++i) store3(load3(w.x + 3 * i) - centre, w.dx + 3 * i);  // arms
  V3<R> angular{};
  R xx{}, yy{}, zz{}, xy{}, xz{}, yz{};
  for (int i = 0; i < t.particles; ++i) {
    const V3<R> r = load3(w.dx + 3 * i), m = tree::momentumOf(t, i, w.dx);
    angular = angular + cross(m, load3(w.v + 3 * i) - drift);
    xx += m.x * r.x;
    yy += m.y * r.y;
    zz += m.z * r.z;
    xy += m.x * r.y;
    xz += m.x * r.z;
    yz += m.y * r.z;
  }
  // Inertia: trace less second moments; a body on a line takes no spin about it.
  const R small = N(1e-9) * (xx + yy + zz) + N(1e-30);
  const R a = yy + zz + small, d = xx + zz + small, f = xx + yy + small;
  const R A = d * f - yz * yz, B = xz * yz + xy * f, C = xy * yz + d * xz;
  const R D = a * f - xz * xz, E = a * yz + xy * xz, F = a * d - xy * xy;
  const R inverse = N(1) / (a * A - xy * B - xz * C);
  const V3<R> spin = inverse * V3<R>{A * angular.x + B * angular.y + C * angular.z,
                                     B * angular.x + D * angular.y + E * angular.z,
                                     C * angular.x + E * angular.y + F * angular.z};
  for (int i = 0; i < t.particles; ++i) {
    const V3<R> rigid = drift + cross(spin, load3(w.dx + 3 * i));
    store3(rigid + keep * (load3(w.v + 3 * i) - rigid), w.v + 3 * i);
  }
}

/// The sum of the particles' momenta, of motions or velocities.
template <class L>
RAGDOLL_INLINE V3<typename L::R> wholeOf(const FastBody& b, const typename L::R* dx) {
  V3<typename L::R> sum{};
  for (int i = 0; i < b.tree.particles; ++i)
    sum = sum + typename L::N(b.tree.mass[i]) * load3(dx + 3 * i);
  return sum;
}

inline double massOf(const FastBody& b) {
  double mass = 0;
  for (int i = 0; i < b.tree.particles; ++i) mass += b.tree.mass[i];
  return mass;
}

/// w.whole of the free motion, which stands in w.spare.
template <class L>
RAGDOLL_SECTION void setWhole(const FastBody& b, L& w) {
  w.whole = wholeOf<L>(b, w.spare);
  if (w.forced)
    for (int i = 0; i < 3 * b.tree.particles; i += 3) w.whole = w.whole + load3(w.force + i);
}

/// What nothing holds has the momentum of the free motion, whatever the rounds have left: shifts
/// w.dx as a whole.
template <class L>
RAGDOLL_SECTION void keepWhole(const FastBody& b, L& w, const typename L::R& held) {
  using R = typename L::R;
  using N = typename L::N;
  const R share = select(less(R{}, held), R{}, R{} + N(1 / massOf(b)));
  const V3<R> shift = share * (w.whole - wholeOf<L>(b, w.dx));
  for (int i = 0; i < 3 * b.tree.particles; i += 3) store3(load3(w.dx + i) + shift, w.dx + i);
}

/// w.goal of the free motion, which stands in w.spare.
template <class L>
RAGDOLL_SECTION void setGoal(const FastBody& b, L& w) {
  tree::momentum(b.tree, w.spare, w.tree);
  if (w.forced)
    for (int i = 0; i < 3 * b.tree.particles; ++i) w.tree.force[i] += w.force[i];
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

template <class L>
RAGDOLL_SECTION void setPose(const FastBody& b, L& w) {
  tree::retract(b.tree, w.q, w.shift, w.tree, w.dx, w.off);
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

/// Directions, H and its factors at the start.
template <class L>
RAGDOLL_SECTION void setTree(const FastBody& b, L& w) {
  tree::setFrames(b.tree, w.x, w.tree);
  tree::setMatrix(b.tree, b.depth.data(), w.tree);
  tree::factorise(b.tree, 0, w.tree);
}

template <class L>
void predict(const FastBody& b, const PackStep& step, Lane* lanes, void* memory) {
  using R = typename L::R;
  using N = typename L::N;
  L& w = *L::in(memory, b, step.plane_count);
  const Tree& t = b.tree;
  const int n = 3 * t.particles;
  load(b, step, lanes, w);
  if (step.keep != 1)
    for (int i = 0; i < n; ++i) w.v[i] = N(step.keep) * w.v[i];
  if (step.keep_inner != 1) dampInside(b, N(step.keep_inner), w);
  w.off = R{};
  checkLengths(b, w);
  setTree(b, w);
  R fastest{};
  for (int i = 0; i < n; i += 3) fastest = larger(fastest, dot(load3(w.v + i), load3(w.v + i)));
  w.travel = N(step.h) * squareRoot(fastest);
  w.margin = N(kNear) + N(kReach) * w.travel;
  const V3<R> fall = w.pull * spread3<L>(step.gravity);
  const N h = N(step.h), h2 = N(step.h * step.h);
  for (int i = 0; i < n; i += 3) store3(h * load3(w.v + i) + h2 * fall, w.spare + i);
  setWhole(b, w);
  setGoal(b, w);
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

/// [J] that a body may have after a share of the step: what it had, and the work of forces along
/// w.dx; no bound where something drives it. What hangs has velocities of the middle of its steps:
/// forces act along half of the step before, too.
template <class L>
typename L::R energyBound(const FastBody& b, const PackStep& step, const Lane* lanes, const L& w,
                          double share) {
  using R = typename L::R;
  using N = typename L::N;
  const bool hangs = b.tree.roots[0].pinned;
  const N now = N(hangs ? 0.5 : share), last = N(hangs ? 0.5 * step.h : 0);
  R bound = w.before;
  for (int i = 0; i < b.tree.particles; ++i)
    for (int c = 0; c < 3; ++c) {
      const int k = 3 * i + c;
      const R moved = now * w.dx[k] + last * w.v[k];
      bound += N(b.tree.mass[i] * step.gravity[c]) * moved;
      if (w.forced) bound += N(1 / (step.h * step.h)) * w.force[k] * moved;
    }
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].driven) setLane(bound, l, N(kNoBound));
  return bound;
}

/// Draws back a motion that lifts a body by more than its energy: scales the coordinates.
template <class L>
RAGDOLL_SECTION void limitMotion(const FastBody& b, const PackStep& step, Lane* lanes, L& w,
                                 const typename L::R& held) {
  using R = typename L::R;
  using N = typename L::N;
  const R after = energyOf<L>(b, w.dx, 1 / (step.h * step.h));
  const R bound = select(less(R{}, held), energyBound(b, step, lanes, w, 0.5),  // w.dx: its middle
                         R{} + N(kNoBound));
  const auto much = less(bound, after);
  if (!any(much)) return;
  // share^2 after = before + share work
  const R work = bound - w.before;
  const R root = squareRoot(atLeast(work * work + N(4) * after * w.before, N(0)));
  const R share = (work + root) / atLeast(N(2) * after, N(1e-30));
  const R scale = select(much, atLeast(share, N(0)), R{} + N(1));
  for (int k = 0; k < b.tree.size; ++k) w.q[k] = scale * w.q[k];
  setPose(b, w);
  for (int l = 0; l < L::W; ++l) lanes[l].limited = lane(scale, l) < N(1 - kReportedShare);
}

/// The same of the velocities at the end (w.dx, times h). Where no obstacle takes momentum, motion
/// against the rigid one with the same momenta alone, if that is enough.
template <class L>
RAGDOLL_SECTION void limitVelocities(const FastBody& b, const PackStep& step, Lane* lanes, L& w,
                                     const typename L::R& bound, const typename L::R& touched) {
  using R = typename L::R;
  using N = typename L::N;
  const int n = 3 * b.tree.particles;
  const N h = N(step.h), rate = N(1 / step.h);
  const R after = energyOf<L>(b, w.dx, 1 / (step.h * step.h));
  const auto much = less(bound, after);
  if (!any(much)) return;
  for (int i = 0; i < n; ++i) {
    w.spare[i] = w.dx[i];
    w.v[i] = rate * w.dx[i];
  }
  dampInside(b, N(0), w);
  const R rigid = select(less(R{}, touched), R{}, energyOf<L>(b, w.v, 1.0));
  const R inside =
      select(much, atLeast(bound - rigid, N(0)) / atLeast(after - rigid, N(1e-30)), R{} + N(1));
  const R hung = select(less(R{}, touched), R{} + N(1), R{} + N(b.tree.roots[0].pinned ? 1 : 0));
  const R whole = select(both(much, both(less(R{}, hung), less(bound, rigid))),
                         squareRoot(atLeast(bound, N(0)) / atLeast(rigid, N(1e-30))), R{} + N(1));
  const R scale = squareRoot(inside);
  for (int i = 0; i < n; ++i) {
    const R base = select(less(R{}, touched), R{}, h * w.v[i]);
    w.dx[i] = select(much, whole * (base + scale * (w.spare[i] - base)), w.spare[i]);
  }
  for (int l = 0; l < L::W; ++l)
    lanes[l].limited = lanes[l].limited || lane(scale, l) < N(1 - kReportedShare);
}

/// One sweep of the velocity stage: what pressed does not approach any more, or comes back by
/// Newton's law of impact where it came faster than rest. gap, slip: [m] h times the rates before.
template <class L>
RAGDOLL_SECTION void sweepRates(L& w) {
  using R = typename L::R;
  const auto everywhere = less(R{}, R{} + typename L::N(1));
  for (int i = 0; i < w.pressing_contacts; ++i) {
    ContactRow<R>& row = w.contacts[w.pressing[i]];
    R rate[3] = {row.gap, row.slip[0], row.slip[1]};
    addAlong<3>(w, row.feature->row, row.z, rate);
    pressRow(w, row, rate, everywhere, row.rate_press, row.rate_pull);
  }
  for (int i = 0; i < w.pressing_limits; ++i) {
    LimitRow<R>& row = w.limits[w.pressing[w.pressing_contacts + i]];
    R rate = row.value;
    addAlong<1>(w, row.limit->row, row.z, &rate);
    const R press = larger(row.allowed - rate * row.inverse, R{});
    if (!any(either(less(R{}, press), less(R{}, row.allowed)))) continue;
    const R change = press - row.allowed;
    row.allowed = press;
    pushAlong<1>(row.limit->row, row.z, &change, w);
  }
}

/// Where the velocity stage starts: half of what pressed in the step, against half of gravity.
template <class L>
RAGDOLL_SECTION void startRates(const FastBody& b, const PackStep& step, bool free,
                                const V3<typename L::R>& kick, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const double g = std::sqrt(step.gravity[0] * step.gravity[0] + step.gravity[1] * step.gravity[1] +
                             step.gravity[2] * step.gravity[2]);
  const R least = R{} + N(kBounce * g * step.h);
  int* list = w.pressing;
  for (int i = 0; i < w.awake_count; ++i) {
    ContactRow<R>& row = w.contacts[w.awake[i]];
    const auto presses = less(R{}, row.press);
    if (!any(presses)) continue;
    *list++ = w.awake[i];
    row.inverse_normal = select(presses, row.inverse_normal, R{});
    row.inverse_tangent = select(presses, row.inverse_tangent, R{});
    const V3<R> rate = atFeature(*row.feature, row.weight, w.dx) + kick - row.motion;
    const R back = N(step.h) * row.restitution * row.approach;
    const auto impact = less(least, row.approach);
    row.gap = dot(row.axes[0], rate) - select(impact, back, R{});
    // What pressed as hard before goes on; the rest was an impact.
    const R lasting = select(less(row.last, row.press), row.last, row.press);
    const R share = N(free ? 1 : 0) * lasting / atLeast(row.press, N(1e-30));
    row.rate_press = share * row.press;
    for (int c = 0; c < 2; ++c) {
      row.slip[c] = dot(row.axes[c + 1], rate);
      row.rate_pull[c] = share * row.pull[c];
    }
    if (any(less(R{}, row.rate_press))) push(w, row, row.rate_press, row.rate_pull);
  }
  w.pressing_contacts = static_cast<int>(list - w.pressing);
  const int* const limits = list;
  for (int i = 0; i < w.limit_count; ++i) {
    LimitRow<R>& row = w.limits[i];
    if (!any(less(R{}, row.press))) continue;
    if (list == limits) tree::factorTimes(b.tree, w.tree, w.q, w.total);
    *list++ = i;
    row.allowed = select(less(row.last, row.press), row.last, row.press);
    if (row.limit->compliance > 0) {  // a spring's second half step, whatever the rate
      row.inverse = R{};
      row.allowed = row.press;
    }
    row.allowed = N(free ? 1 : 0) * row.allowed;
    row.inverse = select(less(R{}, row.press), row.inverse, R{});
    row.value = R{};
    for (int k = 0; k < row.limit->row.size(); ++k)
      row.value += row.z[k] * w.total[row.limit->row.index[k]];
    if (any(less(R{}, row.allowed))) pushAlong<1>(row.limit->row, row.z, &row.allowed, w);
  }
  w.pressing_limits = static_cast<int>(list - w.pressing) - w.pressing_contacts;
}

/// w.dx <- h times the velocities at the step's end: the mean's, half a step of gravity, and what
/// contacts and limits answer to that.
template <class L>
RAGDOLL_SECTION void endVelocities(const FastBody& b, const PackStep& step, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const bool free = !b.tree.roots[0].pinned;  // docs/fast.md#velocities
  const V3<R> kick = N(free ? 0.5 * step.h * step.h : 0) * spread3<L>(step.gravity);
  if (w.contact_count + w.limit_count > 0) {
    for (int k = 0; k < b.tree.size; ++k) w.y[k] = R{};
    startRates(b, step, free, kick, w);
    if (w.pressing_contacts + w.pressing_limits > 0) {
      for (int sweep = 0; sweep < kRateSweeps; ++sweep) sweepRates(w);
      tree::solveDown(b.tree, w.tree, w.y);
      tree::move(b.tree, w.tree, w.y, w.spare);
      for (int i = 0; i < 3 * b.tree.particles; ++i) w.dx[i] += w.spare[i];
    }
  }
  for (int i = 0; i < 3 * b.tree.particles; i += 3) store3(load3(w.dx + i) + kick, w.dx + i);
}

/// Positions (w.x) and velocities (w.dx, times h), which it uses up, of the bodies that came
/// through.
template <class L>
RAGDOLL_SECTION void store(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const int n = 3 * b.tree.particles;
  const double rate = 1 / step.h;
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
        v.v *= rate;
        x.to(lanes[l].x1 + i);
        v.to(lanes[l].v1 + i);
      }
    }
  for (; i < n; ++i)
    for (int l = 0; l < L::W; ++l) {
      if (!lanes[l].good) continue;
      lanes[l].x1[i] = w.origin[l][i % 3] + lane(w.x[i], l);
      lanes[l].v1[i] = rate * lane(w.dx[i], l);
    }
}

template <class L>
RAGDOLL_SECTION void storePresses(const FastBody& b, const PackStep& step, Lane* lanes,
                                  const L& w) {
  using R = typename L::R;
  for (int l = 0; l < L::W; ++l) {
    Lane& out = lanes[l];
    if (!out.good) continue;
    const double rate2 = 1 / (out.pull * step.h * step.h);
    out.impulse_count = 0;
    for (int i = 0; i < w.contact_count; ++i) {
      const ContactRow<R>& row = w.contacts[i];
      const double press = rate2 * lane(row.press, l);
      if (!(press > 0)) continue;
      LaneImpulse& to = out.impulses[out.impulse_count++];
      to.feature = static_cast<int>(row.feature - b.features.data());
      to.obstacle = w.obstacle_of[i * L::W + l];
      const double f[] = {press, rate2 * lane(row.pull[0], l), rate2 * lane(row.pull[1], l)};
      for (int c = 0; c < 3; ++c) to.impulse[c] = 0;
      for (int k = 0; k < 3; ++k) {
        to.impulse[0] += f[k] * lane(row.axes[k].x, l);
        to.impulse[1] += f[k] * lane(row.axes[k].y, l);
        to.impulse[2] += f[k] * lane(row.axes[k].z, l);
      }
    }
    for (std::size_t i = 0; i < b.limits.size(); ++i) out.limit_impulse[i] = 0;
    for (int i = 0; i < w.limit_count; ++i)
      out.limit_impulse[w.limits[i].limit - b.limits.data()] = rate2 * lane(w.limits[i].press, l);
  }
}

/// Where something is deeper than it may be left.
template <class L>
RAGDOLL_INLINE typename L::Mask tooDeep(const PackStep& step, const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  auto deep = less(R{}, R{});
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    const auto worse = both(less(row.gap + row.allowed, R{} - N(step.deepest.particle)),
                            less(row.gap, R{} - N(kWorse * step.deepest.particle)));
    deep = either(deep, both(worse, less(R{}, row.inverse_normal + row.waits)));
  }
  return deep;
}

/// What the rounds have not brought to its bounds is not for a pack (w.off above its own).
template <class L>
RAGDOLL_SECTION void checkBounds(const PackStep& step, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  w.off = select(tooDeep(step, w), R{} + N(1), w.off);
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
  using N = typename L::N;
  w.unsettled = w.unsolved;
  for (int sweep = 0; sweep < kSweeps && any(w.unsettled); ++sweep) {
    w.change = R{};
    sweepContacts(w);
    sweepLimits(w);
    w.unsettled = both(w.unsettled, less(R{} + N(kSettledRow), w.change));
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

template <class L>
void finish(const FastBody& b, const PackStep& step, Lane* lanes, void* memory) {
  using R = typename L::R;
  using N = typename L::N;
  L& w =
      *reinterpret_cast<L*>((reinterpret_cast<std::uintptr_t>(memory) + 63) & ~std::uintptr_t(63));
  w.z_next = w.z;
  setContacts(b, step, lanes, w);
  setLimits(b, step, w);
  w.unsolved = less(R{}, R{} + N(1));
  measureContacts(b, w);
  for (int round = 0; round < kMostRounds && any(w.unsolved); ++round) {
    if (round >= kNewton) {
      w.unsolved = both(w.unsolved, tooDeep(step, w));
      if (!any(w.unsolved)) break;
    }
    setRest(b, w);
    if (round == 0) startRows(w);
    sweepRows(w);
    endRound(b, w);
  }
  checkBounds(step, w);
  R touched{};
  for (int i = 0; i < w.contact_count; ++i)
    touched = larger(touched, select(less(R{}, w.contacts[i].press), R{} + N(1), R{}));
  R pressed = larger(touched, R{} + N(b.tree.roots[0].pinned ? 1 : 0));
  const R held = pressed;
  for (int i = 0; i < w.limit_count; ++i)
    if (w.limits[i].limit->compliance == 0)
      pressed = larger(pressed, select(less(R{}, w.limits[i].press), R{} + N(1), R{}));
  w.before = energyOf<L>(b, w.v, 1.0);
  if (any(less(R{}, held))) limitMotion(b, step, lanes, w, held);
  keepWhole(b, w, held);
  tree::place(b.tree, w.tree, w.x, w.dx, w.x);  // the new positions
  const N gain = N(0.5 * kFreeGain * kFreeGain * massOf(b));
  const R slack = select(less(R{}, pressed), R{}, R{} + gain);
  const R bound = energyBound(b, step, lanes, w, 1) + slack;
  endVelocities(b, step, w);
  limitVelocities(b, step, lanes, w, bound, touched);
  findDeep(b, step, lanes, w);
  store(b, step, lanes, w);
  storePresses(b, step, lanes, w);
}

template <class L>
constexpr PackMethod methodOf() {
  return {L::W, &L::room, &predict<L>, &finish<L>};
}

}  // namespace ragdoll::fast
