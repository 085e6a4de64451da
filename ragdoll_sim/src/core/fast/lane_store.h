// Bodies into the lanes of a pack, and what became of them out of these.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/fast/lane_work.h"
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

}  // namespace ragdoll::fast
