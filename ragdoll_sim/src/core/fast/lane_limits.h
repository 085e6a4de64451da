// Joint limits of a pack: rows in tangent coordinates. docs/fast.md#limits.
#pragma once

#include "core/fast/lane_directions.h"

namespace ragdoll::fast {

/// z of a limit, and what it answers with.
template <class L>
RAGDOLL_INLINE void setAnswer(const FastBody& b, L& w, LimitRow<typename L::R>& row) {
  const RowShape& shape = row.limit->row;
  row.z = w.z_next;
  w.z_next += shape.size();
  setGradient(b, w, *row.limit);
  for (int k = 0; k < shape.size(); ++k) row.z[k] = w.row[shape.index[k]];
  eliminate<1>(w, shape, row.z);
  row.answer = typename L::R{};
  for (int k = 0; k < shape.size(); ++k) row.answer += row.z[k] * row.z[k];
}

/// As of contacts (lane_presses.h).
template <class L>
RAGDOLL_INLINE auto wake(const FastBody& b, L& w, LimitRow<typename L::R>& row) {
  using R = typename L::R;
  using N = typename L::N;
  const auto near = either(less(row.value, R{} + N(kWakeAngle)), less(R{}, row.press));
  const auto wakes = both(less(R{}, row.waits), near);
  if (any(wakes)) {
    if (!row.z) setAnswer(b, w, row);
    const R whole = row.answer + row.compliance;
    row.inverse = select(wakes, N(1) / atLeast(whole, N(1e-12)), row.inverse);
    row.waits = select(wakes, R{}, row.waits);
  }
  return both(wakes, less(row.value, R{}));
}

/// Rows of the limits that the free motion (where w is) comes near, or that pressed.
template <class L>
RAGDOLL_SECTION void setLimits(const FastBody& b, L& w) {
  using N = typename L::N;
  using R = typename L::R;
  w.limit_count = 0;
  const R turn = N(kOwnTurn) * squareRoot(w.off);
  const R margin = N(kNearAngle) + select(w.met, N(kTurnReach) * w.travel, turn);
  SeenChild<R> now, then;
  for (std::size_t i = 0; i < b.limits.size(); ++i) {
    const FastLimit& limit = b.limits[i];
    const R press = w.last_press[i], there = valueOf<true>(b, w, limit, then);
    const auto near = either(less(there, margin), less(R{}, press));
    if (!any(near)) continue;
    const R start = valueOf<false>(b, w, limit, now);
    LimitRow<R>& row = w.limits[w.limit_count++];
    row.limit = &limit;
    row.z = nullptr;
    const R violated = select(less(start, R{}), start, R{});
    row.compliance = R{};
    row.allowed = allowedOf(start, w.opens, R(N(kTurnReach) * w.recovery));
    if (limit.compliance > 0) {  // docs/equations.md#soft
      const R damper = N(limit.damping) * w.rate, whole = N(1 / limit.compliance) + damper;
      row.compliance = N(2) * w.rate * w.rate / whole;
      row.allowed = damper / whole * violated;
    }
    row.answer = row.inverse = R{};
    row.waits = select(near, R{} + N(1), R{});
    row.press = row.last = select(near, press, R{});
    row.value = there - row.allowed;
    row.start = start;
    row.free = there;
    wake(b, w, row);
  }
}

/// The rows' values at the present coordinates. Returns as measureContacts.
template <class L>
RAGDOLL_SECTION typename L::Mask measureLimits(const FastBody& b, L& w) {
  using R = typename L::R;
  auto sunk = less(R{}, R{});
  SeenChild<R> seen;
  for (int i = 0; i < w.limit_count; ++i) {
    LimitRow<R>& row = w.limits[i];
    row.value = valueOf<true>(b, w, *row.limit, seen) - row.allowed;
    sunk = either(sunk, wake(b, w, row));
  }
  return sunk;
}

/// One update of a limit's push, which closes gap [rad] if it pushes, or its rate.
template <class R, class L>
RAGDOLL_INLINE void pressLimit(L& w, const LimitRow<R>& row, const R& gap, R& press) {
  const R next = select(w.unsettled, larger(press - gap * row.inverse, R{}), press);
  if (!any(either(less(R{}, next), less(R{}, press)))) return;
  const R change = next - press;
  w.change = larger(w.change, row.answer * (signOf(change) * change));
  press = next;
  pushAlong<1>(row.limit->row, row.z, &change, w);
}

template <class L>
RAGDOLL_SECTION void sweepLimits(L& w) {
  using R = typename L::R;
  for (int i = 0; i < w.limit_count; ++i) {
    LimitRow<R>& row = w.limits[i];
    if (!row.z) continue;
    R gap = row.value + row.compliance * row.press;
    addAlong<1>(w, row.limit->row, row.z, &gap);
    pressLimit(w, row, gap, row.press);
  }
}

}  // namespace ragdoll::fast
