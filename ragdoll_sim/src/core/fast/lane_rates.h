// The velocity stage of a pack: what pressed in the step does not close further. docs/fast.md#step.
#pragma once

#include <cmath>

#include "core/fast/lane_limits.h"
#include "core/fast/lane_presses.h"

namespace ragdoll::fast {

/// One sweep of the velocity stage: what pressed does not approach any more, or comes back by
/// Newton's law of impact where it came faster than rest. gap, slip: [m] h times the rates before.
template <class L>
RAGDOLL_SECTION void sweepRates(L& w) {
  using R = typename L::R;
  w.change = R{};
  for (int i = 0; i < w.pressing_contacts; ++i) {
    ContactRow<R>& row = w.contacts[w.pressing[i]];
    R rate[3] = {row.gap, row.slip[0], row.slip[1]};
    addAlong<3>(w, row.feature->row, row.z, rate);
    pressRow(w, row, rate, w.unsettled, row.impact, row.rate_press, row.rate_pull);
  }
  for (int i = 0; i < w.pressing_limits; ++i) {
    LimitRow<R>& row = w.limits[w.pressing[w.pressing_contacts + i]];
    R rate = row.value;
    addAlong<1>(w, row.limit->row, row.z, &rate);
    pressLimit(w, row, rate, row.allowed);
  }
  w.unsettled = both(w.unsettled, less(w.settled, w.change));
}

/// Where a row that presses starts in the velocity stage: at all that it pressed with in the step,
/// whose cone friction has, however much of an impact is in the motion already. Returns the share
/// that goes on: what pressed as hard before. rate: [m] h times what its point does.
template <class R, class M>
RAGDOLL_INLINE R startRate(const M& presses, const V3<R>& rate, ContactRow<R>& row) {
  using N = typename tree::NumberOf<R>::Type;
  row.inverse_normal = select(presses, row.inverse_normal, R{});
  row.inverse_tangent = select(presses, row.inverse_tangent, R{});
  row.gap = dot(row.axes[0], rate);
  row.rate_press = row.press;
  for (int c = 0; c < 2; ++c) {
    row.slip[c] = dot(row.axes[c + 1], rate);
    row.rate_pull[c] = row.pull[c];
  }
  const R lasting = select(less(row.last, row.press), row.last, row.press);
  row.impact = row.press - lasting;
  return lasting / atLeast(row.press, N(1e-30));
}

/// Where the velocity stage starts: half of what pressed in the step, against half of gravity.
template <class L>
RAGDOLL_SECTION void startRates(const FastBody& b, const PackStep& step,
                                const V3<typename L::R>& kick, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const double g = std::sqrt(step.gravity[0] * step.gravity[0] + step.gravity[1] * step.gravity[1] +
                             step.gravity[2] * step.gravity[2]);
  const R least = N(kBounce * g) * w.h;
  int* list = w.pressing;
  for (int i = 0; i < w.awake_count; ++i) {
    ContactRow<R>& row = w.contacts[w.awake[i]];
    const auto presses = less(R{}, row.press);
    if (!any(presses)) continue;
    *list++ = w.awake[i];
    const V3<R> rate = atFeature(*row.feature, row.weight, w.dx) + kick - row.motion;
    const R share = startRate(presses, rate, row);
    const R back = w.h * row.restitution * row.approach;
    const auto impact = less(least, row.approach);
    row.gap = row.gap - select(impact, back, R{});
    if (!any(less(R{}, share))) continue;
    const R pull[2] = {share * row.pull[0], share * row.pull[1]};
    push(w, row, share * row.press, pull);
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
    row.inverse = select(less(R{}, row.press), row.inverse, R{});
    row.value = R{};
    for (int k = 0; k < row.limit->row.size(); ++k)
      row.value += row.z[k] * w.total[row.limit->row.index[k]];
    if (any(less(R{}, row.allowed))) pushAlong<1>(row.limit->row, row.z, &row.allowed, w);
  }
  w.pressing_limits = static_cast<int>(list - w.pressing) - w.pressing_contacts;
}

/// w.dx <- what a pin leaves of it at the new pose [Andersen1983].
template <class L>
RAGDOLL_SECTION void holdVelocities(const FastBody& b, L& w) {
  const int n = 3 * b.tree.particles;
  for (int i = 0; i < n; i += 3) store3(load3(w.dx + i) - w.shift, w.dx + i);
  setTree(b, w);
  tree::momentum(b.tree, w.dx, w.tree);
  tree::gather(b.tree, w.tree, w.y);
  tree::solveUp(b.tree, w.tree, w.y);
  tree::solveDown(b.tree, w.tree, w.y);
  tree::move(b.tree, w.tree, w.y, w.dx);
  for (int i = 0; i < n; i += 3) store3(load3(w.dx + i) + w.shift, w.dx + i);
}

/// [m] Half a step of gravity, of velocities times h.
template <class L>
RAGDOLL_INLINE V3<typename L::R> kickOf(const PackStep& step, const L& w) {
  return w.half * spread3<L>(step.gravity);
}

/// What the velocity stage's rows have pushed (w.y) goes into w.dx.
template <class L>
RAGDOLL_SECTION void takePushes(const FastBody& b, L& w) {
  tree::solveDown(b.tree, w.tree, w.y);
  tree::move(b.tree, w.tree, w.y, w.spare);
  for (int i = 0; i < 3 * b.tree.particles; ++i) w.dx[i] += w.spare[i];
}

/// The rest of the velocities at the step's end.
template <class L>
RAGDOLL_INLINE void endRates(const FastBody& b, const V3<typename L::R>& kick, L& w) {
  for (int i = 0; i < 3 * b.tree.particles; i += 3) store3(load3(w.dx + i) + kick, w.dx + i);
  if (b.tree.roots[0].pinned) holdVelocities(b, w);
}

/// w.dx <- h times the velocities at the step's end: the mean's, half a step of gravity, and what
/// contacts, limits and a pin answer to that.
template <class L>
RAGDOLL_SECTION void endVelocities(const FastBody& b, const PackStep& step, L& w) {
  using R = typename L::R;
  const V3<typename L::R> kick = kickOf(step, w);
  if (w.contact_count + w.limit_count > 0) {
    for (int k = 0; k < b.tree.size; ++k) w.y[k] = typename L::R{};
    startRates(b, step, kick, w);
    if (w.pressing_contacts + w.pressing_limits > 0) {
      w.unsettled = less(R{}, R{} + typename L::N(1));
      for (int sweep = 0; sweep < kRateSweeps && any(w.unsettled); ++sweep) sweepRates(w);
      takePushes(b, w);
    }
  }
  endRates(b, kick, w);
}

}  // namespace ragdoll::fast
