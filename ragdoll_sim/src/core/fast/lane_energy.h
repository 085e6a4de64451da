// Energy of a pack's bodies: joint damping, and bounds of what a step may gain. docs/fast.md#step.
#pragma once

#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// [J] of the particles' motion by dx in a time whose square is 1 / rate2.
template <class L>
RAGDOLL_SECTION typename L::R energyOf(const FastBody& b, const typename L::R* dx,
                                       const typename L::R& rate2) {
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
  return rate2 * sum;
}

/// [kg m^2] Of particles about a point: sums of m r^T.
template <class R>
struct SecondMoments {
  R xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

  RAGDOLL_INLINE void add(const V3<R>& m, const V3<R>& r) {
    xx += m.x * r.x;
    yy += m.y * r.y;
    zz += m.z * r.z;
    xy += m.x * r.y;
    xz += m.x * r.z;
    yz += m.y * r.z;
  }
};

/// The spin of a rigid body with these moments and that angular momentum. Inertia: trace less
/// second moments; a body on a line takes no spin about it.
template <class R>
RAGDOLL_INLINE V3<R> spinOf(const SecondMoments<R>& s, const V3<R>& angular) {
  using N = typename tree::NumberOf<R>::Type;
  const R xx = s.xx, yy = s.yy, zz = s.zz, xy = s.xy, xz = s.xz, yz = s.yz;
  const R small = N(1e-9) * (xx + yy + zz) + N(1e-30);
  const R a = yy + zz + small, d = xx + zz + small, f = xx + yy + small;
  const R A = d * f - yz * yz, B = xz * yz + xy * f, C = xy * yz + d * xz;
  const R D = a * f - xz * xz, E = a * yz + xy * xz, F = a * d - xy * xy;
  const R inverse = N(1) / (a * A - xy * B - xz * C);
  return inverse * V3<R>{A * angular.x + B * angular.y + C * angular.z,
                         B * angular.x + D * angular.y + E * angular.z,
                         C * angular.x + E * angular.y + F * angular.z};
}

/// How a body turns, by `motion` of its particles at w.x, about its centre of mass; about a pin.
template <class R>
struct Turning {
  V3<R> drift{}, angular{};
  SecondMoments<R> second;
};

/// arms: of its particles.
template <class L>
RAGDOLL_INLINE Turning<typename L::R> turningOf(const FastBody& b, const typename L::R* motion,
                                                const L& w, typename L::R* arms) {
  using R = typename L::R;
  using N = typename L::N;
  const Tree& t = b.tree;
  V3<R> centre{};
  Turning<R> turning;
  if (t.roots[0].pinned) {
    centre = load3(w.x + 3 * t.roots[0].particle);
    turning.drift = load3(motion + 3 * t.roots[0].particle);
  } else {
    double whole = 0;
    for (int i = 0; i < t.particles; ++i) {
      whole += t.mass[i];
      centre = centre + N(t.mass[i]) * load3(w.x + 3 * i);
      turning.drift = turning.drift + N(t.mass[i]) * load3(motion + 3 * i);
    }
    centre = N(1 / whole) * centre;
    turning.drift = N(1 / whole) * turning.drift;
  }
  for (int i = 0; i < t.particles; ++i) store3(load3(w.x + 3 * i) - centre, arms + 3 * i);
  for (int i = 0; i < t.particles; ++i) {
    const V3<R> r = load3(arms + 3 * i), m = tree::momentumOf(t, i, arms);
    turning.angular = turning.angular + cross(m, load3(motion + 3 * i) - turning.drift);
    turning.second.add(m, r);
  }
  return turning;
}

/// As joint_damping.h: velocities against those of the rigid motion with the same momenta. w.dx:
/// used.
template <class L>
RAGDOLL_SECTION void dampInside(const FastBody& b, const typename L::R& keep, L& w) {
  using R = typename L::R;
  const Turning<R> turning = turningOf(b, w.v, w, w.dx);
  const V3<R> spin = spinOf(turning.second, turning.angular);
  for (int i = 0; i < b.tree.particles; ++i) {
    const V3<R> rigid = turning.drift + cross(spin, load3(w.dx + 3 * i));
    store3(rigid + keep * (load3(w.v + 3 * i) - rigid), w.v + 3 * i);
  }
}

/// w.angular, from the momentum of the free motion (w.tree.force), before pokes: gravity turns
/// nothing about the centre of mass.
template <class L>
RAGDOLL_INLINE void setAngular(const FastBody& b, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  V3<R> centre{};
  double mass = 0;
  w.angular = V3<R>{};
  for (int i = 0; i < b.tree.particles; ++i) {
    const V3<R> x = load3(w.x + 3 * i);
    mass += b.tree.mass[i];
    centre = centre + N(b.tree.mass[i]) * x;
    w.angular = w.angular + cross(x, load3(w.tree.force + 3 * i));
  }
  w.angular = w.angular - cross(N(1 / mass) * centre, w.whole);
}

/// What nothing outside turns keeps its angular momentum: what the rounds and an end's chord have
/// left of it comes back as a spin, in the velocities (w.dx, times h) at w.x. outside: 1 in the
/// lanes that something presses.
template <class L>
RAGDOLL_SECTION void keepAngular(const FastBody& b, const typename L::R& outside, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  if (b.tree.roots[0].pinned) return;
  const auto flies = less(outside + w.poked, R{} + N(0.5));
  if (!any(flies)) return;
  const Turning<R> turning = turningOf(b, w.dx, w, w.spare);
  const V3<R> spin = spinOf(turning.second, w.angular - turning.angular);
  for (int i = 0; i < 3 * b.tree.particles; i += 3) {
    const V3<R> at = load3(w.dx + i), turned = at + cross(spin, load3(w.spare + i));
    store3(V3<R>{select(flies, turned.x, at.x), select(flies, turned.y, at.y),
                 select(flies, turned.z, at.z)},
           w.dx + i);
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

/// The sum of the particles' momenta, of motions or velocities.
template <class L>
RAGDOLL_INLINE V3<typename L::R> wholeOf(const FastBody& b, const typename L::R* dx) {
  V3<typename L::R> sum{};
  for (int i = 0; i < b.tree.particles; ++i)
    sum = sum + typename L::N(b.tree.mass[i]) * load3(dx + 3 * i);
  return sum;
}

RAGDOLL_INLINE double massOf(const FastBody& b) {
  double mass = 0;
  for (int i = 0; i < b.tree.particles; ++i) mass += b.tree.mass[i];
  return mass;
}

/// [J] of the velocities w.v, from the momentum of the free motion h v + fall (w.tree.force), whose
/// sum is w.whole.
template <class L>
RAGDOLL_INLINE typename L::R energyBefore(const FastBody& b, const V3<typename L::R>& fall,
                                          const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  R sum{};
  for (int i = 0; i < 3 * b.tree.particles; i += 3)
    sum += dot(load3(w.tree.force + i), load3(w.v + i));
  // What `fall` has of that: fall . sum of m v.
  const V3<R> momentum = w.rate * (w.whole - N(massOf(b)) * fall);
  return N(0.5) * w.rate * (sum - dot(fall, momentum));
}

/// [J] that a body may have after a share of the step: what it had, and the work of forces along
/// w.dx; no bound where something drives it.
template <class L>
typename L::R energyBound(const FastBody& b, const PackStep& step, const Lane* lanes, const L& w,
                          double share) {
  using R = typename L::R;
  using N = typename L::N;
  R bound = w.before;
  for (int i = 0; i < b.tree.particles; ++i)
    for (int c = 0; c < 3; ++c) {
      const int k = 3 * i + c;
      const R moved = N(share) * w.dx[k];
      bound += N(b.tree.mass[i] * step.gravity[c]) * moved;
      if (w.forced) bound += w.rate * w.rate * w.force[k] * moved;
    }
  for (int l = 0; l < L::W; ++l)
    if (lanes[l].driven) setLane(bound, l, N(kNoBound));
  return bound;
}

/// By how much a motion is scaled whose energy is more than it had and the work along it: share^2
/// after = before + share work.
template <class R>
RAGDOLL_INLINE R motionShare(const R& before, const R& after, const R& work) {
  using N = typename tree::NumberOf<R>::Type;
  const R root = squareRoot(atLeast(work * work + N(4) * after * before, N(0)));
  return atLeast((work + root) / atLeast(N(2) * after, N(1e-30)), N(0));
}

/// Draws back a motion that lifts a body by more than its energy: scales the coordinates. Little is
/// left to the velocities' bound, as scaling takes momentum.
template <class L>
RAGDOLL_SECTION void limitMotion(const FastBody& b, const PackStep& step, Lane* lanes, L& w,
                                 const typename L::R& held) {
  using R = typename L::R;
  using N = typename L::N;
  const R after = energyOf<L>(b, w.dx, w.rate * w.rate);
  const R bound = select(less(R{}, held), energyBound(b, step, lanes, w, 0.5),  // w.dx: its middle
                         R{} + N(kNoBound));
  const auto much = less(bound + N(kUnseenShare) * after, after);
  if (!any(much)) return;
  const R share = motionShare(w.before, after, R(bound - w.before));
  const R scale = select(much, share, R{} + N(1));
  for (int k = 0; k < b.tree.size; ++k) w.q[k] = scale * w.q[k];
  setPose(b, w);
  for (int l = 0; l < L::W; ++l) lanes[l].limited = lane(scale, l) < N(1 - kReportedShare);
}

/// What touches no obstacle has its energy, but for what limits take in an impact: what it misses
/// tells how far the step has gone astray.
template <class L>
RAGDOLL_INLINE void checkEnergy(const FastBody& b, const Lane* lanes, const typename L::R& kept,
                                const typename L::R& after, const typename L::R& touched, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  R most;
  for (int l = 0; l < L::W; ++l) {
    const double missed = lanes[l].bounds.missed;
    setLane(most, l, N(0.5 * missed * missed * massOf(b)));
  }
  const R missed = signOf(after - kept) * (after - kept);
  const auto known = both(less(touched, R{} + N(0.5)), less(kept, R{} + N(0.5 * kNoBound)));
  w.off = select(both(known, less(most, missed)), R{} + N(1), w.off);
}

/// The same of the velocities at the end (w.dx, times h), against kept + slack. Where no obstacle
/// takes momentum, and where little is drawn back, motion against the rigid one with the same
/// momenta alone, if that is enough: what obstacles gave stays within their cones.
template <class L>
RAGDOLL_SECTION void limitVelocities(const FastBody& b, Lane* lanes, L& w,
                                     const typename L::R& kept, const typename L::R& slack,
                                     const typename L::R& touched) {
  using R = typename L::R;
  using N = typename L::N;
  const int n = 3 * b.tree.particles;
  const R after = energyOf<L>(b, w.dx, w.rate * w.rate);
  checkEnergy(b, lanes, kept, after, touched, w);
  const R bound = kept + slack;
  const auto much = less(bound + N(kReportedShare) * after, after);
  if (!any(much)) return;
  for (int i = 0; i < n; ++i) {
    w.spare[i] = w.dx[i];
    w.v[i] = w.rate * w.dx[i];
  }
  dampInside(b, R{}, w);
  // What touches is scaled as a whole, as then nothing comes nearer, but for less than shows there.
  const R alone = energyOf<L>(b, w.v, R{} + N(1));
  const auto shows = either(less(bound + N(kUnseenShare) * after, after), less(bound, alone));
  const auto as_one = both(less(R{}, touched), shows);
  const R rigid = select(as_one, R{}, alone);
  const R inside =
      select(much, atLeast(bound - rigid, N(0)) / atLeast(after - rigid, N(1e-30)), R{} + N(1));
  const R hung = select(less(R{}, touched), R{} + N(1), R{} + N(b.tree.roots[0].pinned ? 1 : 0));
  const R whole = select(both(much, both(less(R{}, hung), less(bound, rigid))),
                         squareRoot(atLeast(bound, N(0)) / atLeast(rigid, N(1e-30))), R{} + N(1));
  const R scale = squareRoot(inside);
  for (int i = 0; i < n; ++i) {
    const R base = select(as_one, R{}, w.h * w.v[i]);
    w.dx[i] = select(much, whole * (base + scale * (w.spare[i] - base)), w.spare[i]);
  }
  for (int l = 0; l < L::W; ++l)
    lanes[l].limited = lanes[l].limited || lane(scale, l) < N(1 - kReportedShare);
}

}  // namespace ragdoll::fast
