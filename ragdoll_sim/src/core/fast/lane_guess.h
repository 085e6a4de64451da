// Where a free motion ends, to third order. docs/fast.md#step.
#pragma once

#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// Columns of A = I - R^T along a group's axes, R its rotation in the step before: from what two of
/// its points move by, relative to `attach`.
template <class R>
RAGDOLL_INLINE void turnBefore(const TreeLink& k, const R* axes, const V3<R>& first,
                               const V3<R>& second, V3<R>* a) {
  using N = typename tree::NumberOf<R>::Type;
  const V3<R> u = load3(axes), e1 = load3(axes + 3);
  a[0] = first;
  a[1] = N(1 / k.base_side) * (second - N(k.base_along) * first);
  a[2] = cross(u, a[1]) + cross(a[0], e1) - cross(a[0], a[1]);
}

/// w.row <- tangent coordinates of the step before, from dX_free (w.spare): those at which the
/// retraction, reversed, ends where that step began. Root particles: dX_free itself. w.tree.turn is
/// used.
template <class L>
RAGDOLL_INLINE void setBefore(const FastBody& b, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const Tree& t = b.tree;
  store3(load3(w.spare + 3 * t.roots[0].particle), w.row + t.roots[0].first);
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& k = t.links[j];
    const R* axes = w.tree.axes + 9 * j;
    const V3<R> o = load3(w.spare + 3 * k.attach);
    const V3<R> u = load3(axes), e1 = load3(axes + 3), e2 = load3(axes + 6);
    const V3<R> first = N(1 / k.base_reach) * (load3(w.spare + 3 * k.base[0]) - o);
    if (k.kind == TreeLink::Kind::kPointer) {
      w.row[k.first] = dot(e1, first);
      w.row[k.first + 1] = dot(e2, first);
      continue;
    }
    V3<R> a[3];
    turnBefore(k, axes, first, load3(w.spare + 3 * k.base[1]) - o, a);
    for (int c = 0; c < 3; ++c) store3(a[c], w.tree.turn + 9 * j + 3 * c);
    if (k.kind == TreeLink::Kind::kTurn) {
      store3(N(0.5) * (cross(u, a[0]) + cross(e1, a[1]) + cross(e2, a[2])), w.row + k.first);
      continue;
    }
    const R* base = w.tree.axes + 9 * k.parent;
    const R* turn = w.tree.turn + 9 * k.parent;
    V3<R> back = e2;  // what e2 is where the parent was
    for (int c = 0; c < 3; ++c) back = back - dot(load3(base + 3 * c), e2) * load3(turn + 3 * c);
    w.row[k.first] = dot(e2, e1) - dot(back, e1 - a[1]);
  }
}

/// q of the free motion from its linearised solve (w.q), which misses what the retraction bends:
/// dX_free has as much of the step before, so that the solve's difference from that step's
/// coordinates is counted twice. Saves a round. What no reversed step explains is left as it is:
/// pokes, pins, bodies that turn far.
template <class L>
RAGDOLL_SECTION void extrapolate(const FastBody& b, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  if (b.tree.roots[0].pinned) return;
  setBefore(b, w);
  R most{}, forced{};
  for (int k = 3; k < b.tree.size; ++k)
    most = larger(most, larger(w.q[k] * w.q[k], w.row[k] * w.row[k]));
  if (w.forced)
    for (int i = 0; i < 3 * b.tree.particles; ++i) forced = larger(forced, w.force[i] * w.force[i]);
  const auto known = both(less(most, R{} + N(kGuessSine2)), less(forced, R{} + N(1e-30)));
  for (int k = 0; k < b.tree.size; ++k) w.q[k] = select(known, N(2) * w.q[k] - w.row[k], w.q[k]);
}

}  // namespace ragdoll::fast
