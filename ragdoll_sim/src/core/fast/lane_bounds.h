// What the rounds of a step have not brought to its bounds: what is too deep, or is hit too fast
// for a step that does not find when. docs/fast.md#quality-and-cost.
#pragma once

#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// The lanes in which deep(row) is so of a contact that a body can press or that waits.
template <class L, class Deep>
RAGDOLL_INLINE typename L::Mask anyContact(const L& w, const Deep& deep) {
  using R = typename L::R;
  auto found = less(R{}, R{});
  for (int i = 0; i < w.contact_count; ++i) {
    const ContactRow<R>& row = w.contacts[i];
    found = either(found, both(deep(row), less(R{}, row.inverse_normal + row.waits)));
  }
  return found;
}

/// Where something is deeper than it may be left.
template <class L>
RAGDOLL_INLINE typename L::Mask tooDeep(const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  return anyContact(w, [&](const ContactRow<R>& row) {
    return both(less(row.gap + row.allowed, R{} - w.bound), less(row.gap, N(-kWorse) * w.bound));
  });
}

/// Where something began deeper than packs let it sink, in what rests or is driven: what moves
/// opens it itself.
template <class L>
RAGDOLL_INLINE typename L::Mask beganDeep(const L& w) {
  using R = typename L::R;
  using N = typename L::N;
  const auto deep = anyContact(w, [](const ContactRow<R>& row) {
    const double most = row.feature->b < 0 ? kSunkParticle : kSunkStick;
    return less(row.start + dot(row.axes[0], row.motion), R{} - N(most));
  });
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

}  // namespace ragdoll::fast
