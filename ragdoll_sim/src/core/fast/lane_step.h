// One step of a pack of bodies: reads as a table of contents. docs/fast.md#step.
#pragma once

#include "core/fast/lane_contacts.h"
#include "core/fast/lane_limits.h"

namespace ragdoll::fast {

/// Positions from the bodies' roots, so that single precision serves far from the world's origin.
template <class L>
RAGDOLL_SECTION void load(const FastBody& b, const PackStep& step, const Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const int n = 3 * b.tree.particles, root = 3 * b.tree.roots[0].particle;
  w.forced = false;
  for (int l = 0; l < L::W; ++l) {
    const Lane& lane = lanes[l];
    for (int c = 0; c < 3; ++c) w.origin[l][c] = lane.x[root + c];
    for (int i = 0; i < n; i += 3)
      for (int c = 0; c < 3; ++c) {
        setLane(w.x[i + c], l, N(lane.x[i + c] - w.origin[l][c]));
        setLane(w.v[i + c], l, N(lane.v[i + c]));
      }
    setLane(w.pull, l, N(lane.pull));
    setLane(w.shift.x, l, N(lane.pin[0]));
    setLane(w.shift.y, l, N(lane.pin[1]));
    setLane(w.shift.z, l, N(lane.pin[2]));
    w.forced = w.forced || lane.force;
  }
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
RAGDOLL_SECTION typename L::R energyOf(const FastBody& b, L& w, const typename L::R* dx,
                                       double rate2) {
  tree::momentum(b.tree, dx, w.tree);
  typename L::R sum{};
  for (int i = 0; i < 3 * b.tree.particles; ++i) sum += w.tree.force[i] * dx[i];
  return typename L::N(0.5 * rate2) * sum;
}

/// As joint_damping.h: velocities against those of the rigid motion with the same momenta. w.dx: used.
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
  tree::momentum(t, w.dx, w.tree);
  V3<R> angular{};
  R xx{}, yy{}, zz{}, xy{}, xz{}, yz{};
  for (int i = 0; i < t.particles; ++i) {
    const V3<R> r = load3(w.dx + 3 * i), m = load3(w.tree.force + 3 * i);
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

/// w.y = L^-T T^T (M (free - dx) + h^2 forces): what the coordinates still have to change by.
template <class L>
RAGDOLL_SECTION void setRest(const FastBody& b, L& w) {
  const int n = 3 * b.tree.particles;
  for (int i = 0; i < n; ++i) w.spare[i] = w.free[i] - w.dx[i];
  tree::momentum(b.tree, w.spare, w.tree);
  if (w.forced)
    for (int i = 0; i < n; ++i) w.tree.force[i] += w.force[i];
  tree::gather(b.tree, w.tree, w.y);
  tree::solveUp(b.tree, w.tree, w.y);
}

template <class L>
RAGDOLL_SECTION void setPose(const FastBody& b, L& w) {
  tree::retract(b.tree, w.q, w.shift, w.tree, w.dx, w.off);
}

/// Changes the coordinates by L^-1 y.
template <class L>
RAGDOLL_SECTION void moveOn(const FastBody& b, L& w) {
  for (int k = 0; k < b.tree.size; ++k) w.total[k] += w.y[k];
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
  if (step.keep != 1)
    for (int i = 0; i < n; ++i) w.v[i] = N(step.keep) * w.v[i];
  if (step.keep_inner != 1) dampInside(b, N(step.keep_inner), w);
  w.off = R{};
  checkLengths(b, w);
  tree::setFrames(t, w.x, w.tree);
  tree::setMatrix(t, b.depth.data(), w.tree);
  tree::factorise(t, 0, w.tree);
  R fastest{};
  for (int i = 0; i < n; i += 3) fastest = larger(fastest, dot(load3(w.v + i), load3(w.v + i)));
  w.travel = N(step.h) * squareRoot(fastest);
  w.margin = N(kNear) + N(kReach) * w.travel;
  const V3<R> fall = w.pull * spread3<L>(step.gravity);
  const N h = N(step.h), h2 = N(step.h * step.h);
  for (int i = 0; i < n; i += 3) store3(h * load3(w.v + i) + h2 * fall, w.free + i);
  for (int k = 0; k < t.size; ++k) w.q[k] = R{};
  setPose(b, w);
  setRest(b, w);
  for (int k = 0; k < t.size; ++k) w.start_y[k] = w.y[k];
  moveOn(b, w);
  setPose(b, w);
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].predicted)
      for (int i = 0; i < n; ++i) lanes[l].predicted[i] = lanes[l].x[i] + lane(w.dx[i], l);
}

/// [J] that what is pressed or hangs may have after a share of the step: what it had, and the work
/// of forces along w.dx; no bound where something drives it or nothing holds it. What hangs has
/// velocities of the middle of its steps: forces act along half of the step before, too.
template <class L>
typename L::R energyBound(const FastBody& b, const PackStep& step, const Lane* lanes, L& w,
                          const typename L::R& pressed, double share) {
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
  R free = select(less(R{}, pressed), R{}, R{} + N(1));
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].driven) setLane(free, l, N(1));
  return select(less(R{}, free), R{} + N(1e30), bound);
}

/// Draws back a motion that lifts a body by more than its energy: scales the coordinates.
template <class L>
RAGDOLL_SECTION void limitMotion(const FastBody& b, const PackStep& step, Lane* lanes, L& w,
                                 const typename L::R& pressed) {
  using R = typename L::R;
  using N = typename L::N;
  const R after = energyOf(b, w, w.dx, 1 / (step.h * step.h));
  const R bound = energyBound(b, step, lanes, w, pressed, 0.5);  // w.dx: of its middle
  const auto much = less(bound, after);
  if (!any(much)) return;
  // share^2 after = before + share work
  const R work = bound - w.before;
  const R root = squareRoot(atLeast(work * work + N(4) * after * w.before, N(0)));
  const R share = (work + root) / atLeast(N(2) * after, N(1e-30));
  const R scale = select(much, atLeast(share, N(0)), R{} + N(1));
  for (int k = 0; k < b.tree.size; ++k) {
    w.q[k] = scale * w.q[k];
    w.total[k] = scale * w.total[k];
  }
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
  const R after = energyOf(b, w, w.dx, 1 / (step.h * step.h));
  const auto much = less(bound, after);
  if (!any(much)) return;
  for (int i = 0; i < n; ++i) {
    w.spare[i] = w.dx[i];
    w.v[i] = rate * w.dx[i];
  }
  dampInside(b, N(0), w);
  const R rigid = select(less(R{}, touched), R{}, energyOf(b, w, w.v, 1.0));
  const R inside = select(much, atLeast(bound - rigid, N(0)) / atLeast(after - rigid, N(1e-30)),
                          R{} + N(1));
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

/// One sweep of the velocity stage over contacts: what pressed does not approach any more, or comes
/// back by Newton's law of impact where it came faster than rest. row.base: [m] h times the rates
/// before; row.allowed, row.motion: the impulses.
template <class L>
RAGDOLL_SECTION void sweepRates(L& w) {
  using R = typename L::R;
  using N = typename L::N;
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<R>& row = w.contacts[i];
    const V3<R> rate = row.base + motionOf(w, row);
    const R along = dot(row.normal, rate);
    const R press = larger(row.allowed - (along - row.restitution) * row.inverse_normal, R{});
    if (!any(either(less(R{}, press), less(R{}, row.allowed)))) continue;
    const V3<R> wanted = row.motion - row.inverse_tangent * (rate - along * row.normal);
    const R share = row.friction * press / squareRoot(atLeast(dot(wanted, wanted), N(1e-30)));
    const V3<R> pull = select(less(share, R{} + N(1)), share, R{} + N(1)) * wanted;
    push(w, row, (press - row.allowed) * row.normal + (pull - row.motion));
    row.allowed = press;
    row.motion = pull;
  }
  for (int i = 0; i < w.limit_count; ++i) {
    LimitRow<R>& row = w.limits[i];
    const int* index = row.limit->index.data();
    const int size = static_cast<int>(row.limit->index.size());
    R rate = row.value;
    for (int k = 0; k < size; ++k) rate += row.z[k] * w.y[index[k]];
    const R press = larger(row.allowed - rate * row.inverse, R{});
    const R change = press - row.allowed;
    row.allowed = press;
    for (int k = 0; k < size; ++k) w.y[index[k]] += row.z[k] * change;
  }
}

/// Where the velocity stage starts: half of what pressed in the step, against half of gravity.
template <class L>
RAGDOLL_SECTION void startRates(const PackStep& step, bool free, const V3<typename L::R>& kick,
                                L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const double g = std::sqrt(step.gravity[0] * step.gravity[0] + step.gravity[1] * step.gravity[1] +
                             step.gravity[2] * step.gravity[2]);
  const R least = R{} + N(kBounce * g * step.h);
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<R>& row = w.contacts[i];
    const auto presses = less(R{}, row.press);
    row.inverse_normal = select(presses, row.inverse_normal, R{});
    row.inverse_tangent = select(presses, row.inverse_tangent, R{});
    row.base = atFeature(*row.feature, row.weight, w.dx) + kick - row.motion;
    const R back = N(step.h) * row.restitution * row.approach;
    const auto impact = less(least, row.approach);
    row.restitution = select(impact, back, R{});
    // What pressed as hard before goes on; the rest was an impact.
    const R lasting = select(less(row.last, row.press), row.last, row.press);
    const R share = N(free ? 1 : 0) * lasting / atLeast(row.press, N(1e-30));
    row.allowed = share * row.press;
    row.motion = share * row.pull;
    push(w, row, row.allowed * row.normal + row.motion);
  }
  for (int i = 0; i < w.limit_count; ++i) {
    LimitRow<R>& row = w.limits[i];
    row.value = R{};
    row.allowed = select(less(row.last, row.press), row.last, row.press);
    if (row.limit->compliance > 0) {  // a spring's second half step, whatever the rate
      row.inverse = R{};
      row.allowed = row.press;
    }
    row.allowed = N(free ? 1 : 0) * row.allowed;
    row.inverse = select(less(R{}, row.press), row.inverse, R{});
    for (std::size_t k = 0; k < row.limit->index.size(); ++k) {
      row.value += row.z[k] * w.total[row.limit->index[k]];
      w.y[row.limit->index[k]] += row.z[k] * row.allowed;
    }
  }
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
    startRates(step, free, kick, w);
    for (int sweep = 0; sweep < kRateSweeps; ++sweep) sweepRates(w);
    tree::solveDown(b.tree, w.tree, w.y);
    tree::move(b.tree, w.tree, w.y, w.spare);
    for (int i = 0; i < 3 * b.tree.particles; ++i) w.dx[i] += w.spare[i];
  }
  for (int i = 0; i < 3 * b.tree.particles; i += 3) store3(load3(w.dx + i) + kick, w.dx + i);
}

/// Positions (w.x) and velocities (w.dx, times h) of the bodies that came through.
template <class L>
RAGDOLL_SECTION void store(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using N = typename L::N;
  const int n = 3 * b.tree.particles;
  for (int l = 0; l < L::W; ++l) {
    Lane& out = lanes[l];
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += lane(w.x[i], l) + lane(w.dx[i], l);
    out.good = lane(w.off, l) < N(kMostSine2) && std::isfinite(sum);
    if (!out.good) continue;
    for (int i = 0; i < n; i += 3)
      for (int c = 0; c < 3; ++c) {
        out.x1[i + c] = w.origin[l][c] + lane(w.x[i + c], l);
        out.v1[i + c] = lane(w.dx[i + c], l) / step.h;
      }
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
      to.impulse[0] = press * lane(row.normal.x, l) + rate2 * lane(row.pull.x, l);
      to.impulse[1] = press * lane(row.normal.y, l) + rate2 * lane(row.pull.y, l);
      to.impulse[2] = press * lane(row.normal.z, l) + rate2 * lane(row.pull.z, l);
    }
    for (std::size_t i = 0; i < b.limits.size(); ++i) out.limit_impulse[i] = 0;
    for (int i = 0; i < w.limit_count; ++i)
      out.limit_impulse[w.limits[i].limit - b.limits.data()] = rate2 * lane(w.limits[i].press, l);
  }
}

/// What the rounds have not brought to its bounds is not for a pack (w.off above its own).
template <class L>
RAGDOLL_SECTION void checkBounds(const FastBody& b, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  measureContacts(w);
  measureLimits(b, w);
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    const R gap = row.start + dot(row.normal, row.base);
    const auto worse = both(less(gap, R{} - N(kMostDeep)), less(gap, row.allowed - N(kWorse)));
    const auto deep = both(worse, less(R{}, row.inverse_normal));
    w.off = select(deep, R{} + N(1), w.off);
  }
  for (int i = 0; i < w.limit_count; ++i) {
    const LimitRow<R>& row = w.limits[i];
    if (row.limit->compliance > 0) continue;
    const auto deep = both(less(row.value, R{} - N(kMostAngle)), less(R{}, row.inverse));
    w.off = select(deep, R{} + N(1), w.off);
  }
}

template <class L>
void finish(const FastBody& b, const PackStep& step, Lane* lanes, void* memory) {
  using R = typename L::R;
  using N = typename L::N;
  L& w =
      *reinterpret_cast<L*>((reinterpret_cast<std::uintptr_t>(memory) + 63) & ~std::uintptr_t(63));
  w.z_next = w.z;
  setContacts(b, step, lanes, w);
  setLimits(b, step, lanes, w);
  for (int k = 0; k < b.tree.size; ++k) {
    w.q[k] = w.total[k] = R{};
    w.y[k] = w.start_y[k];
  }
  setPose(b, w);
  for (int i = 0; i < w.contact_count; ++i) w.contacts[i].last = w.contacts[i].press;
  for (int i = 0; i < w.limit_count; ++i) w.limits[i].last = w.limits[i].press;
  for (int round = 0; round < kNewton; ++round) {
    if (round > 0) setRest(b, w);
    measureContacts(w);
    measureLimits(b, w);
    for (int i = 0; i < w.contact_count; ++i)
      push(w, w.contacts[i], w.contacts[i].press * w.contacts[i].normal + w.contacts[i].pull);
    for (int i = 0; i < w.limit_count; ++i) {
      const LimitRow<R>& row = w.limits[i];
      for (std::size_t k = 0; k < row.limit->index.size(); ++k)
        w.y[row.limit->index[k]] += row.z[k] * row.press;
    }
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      sweepContacts(w);
      sweepLimits(w);
    }
    moveOn(b, w);
    setPose(b, w);
  }
  checkBounds(b, w);
  R touched{};
  for (int i = 0; i < w.contact_count; ++i)
    touched = larger(touched, select(less(R{}, w.contacts[i].press), R{} + N(1), R{}));
  R pressed = larger(touched, R{} + N(b.tree.roots[0].pinned ? 1 : 0));
  const R held = pressed;
  for (int i = 0; i < w.limit_count; ++i)
    if (w.limits[i].limit->compliance == 0)
      pressed = larger(pressed, select(less(R{}, w.limits[i].press), R{} + N(1), R{}));
  const bool any_pressed = any(less(R{}, pressed));
  if (any_pressed) {
    w.before = energyOf(b, w, w.v, 1.0);
    limitMotion(b, step, lanes, w, held);
  }
  tree::place(b.tree, w.tree, w.x, w.dx, w.x);  // the new positions
  R bound{};
  if (any_pressed) bound = energyBound(b, step, lanes, w, pressed, 1);
  endVelocities(b, step, w);
  if (any_pressed) limitVelocities(b, step, lanes, w, bound, touched);
  store(b, step, lanes, w);
  storePresses(b, step, lanes, w);
}

template <class L>
constexpr PackMethod methodOf() {
  return {L::W, &L::room, &predict<L>, &finish<L>};
}

}  // namespace ragdoll::fast
