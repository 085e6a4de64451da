// Contacts of a pack in the rounds: who takes part, gaps, and what presses. docs/fast.md#contacts.
#pragma once

#include "core/fast/lane_contacts.h"

namespace ragdoll::fast {

/// Whether a contact that waits takes part from now on: it is near, or pressed in the last step.
template <class R>
RAGDOLL_INLINE auto joins(const ContactRow<R>& row) {
  using N = typename tree::NumberOf<R>::Type;
  return both(less(R{}, row.waits), either(less(row.gap, R{} + N(kWake)), less(R{}, row.press)));
}

/// Lets it, where its answers are known.
template <class R, class M>
RAGDOLL_INLINE void takePart(const M& wakes, ContactRow<R>& row) {
  using N = typename tree::NumberOf<R>::Type;
  const auto invert = [&wakes](const R& answer, R& inverse) {
    inverse = select(wakes, N(1) / atLeast(answer, N(1e-12)), inverse);
  };
  invert(row.answer_normal, row.inverse_normal);
  invert(row.answer_tangent, row.inverse_tangent);
  row.waits = select(wakes, R{}, row.waits);
}

/// Lets the contacts take part that wait, where they are near now or pressed in the last step: most
/// of those that a step may meet, it does not. Returns the lanes where such a one is too deep.
template <class L>
RAGDOLL_INLINE auto wake(const FastBody& b, L& w, ContactRow<typename L::R>& row) {
  using R = typename L::R;
  const auto wakes = joins(row);
  if (any(wakes)) {
    if (!row.z) setAnswer(b, w, row);
    takePart(wakes, row);
  }
  return both(wakes, less(row.gap, R{}));
}

/// Gaps and slips at the present coordinates (w.dx), and who takes part. Returns the lanes where
/// what took no part yet is too deep.
template <class L>
RAGDOLL_SECTION typename L::Mask measureContacts(const FastBody& b, L& w) {
  using R = typename L::R;
  auto sunk = less(R{}, R{});
  w.awake_count = 0;
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<R>& row = w.contacts[i];
    const V3<R> moved = atFeature(*row.feature, row.weight, w.dx);
    row.gap = row.start + dot(row.axes[0], moved) - row.allowed;
    sunk = either(sunk, wake(b, w, row));
    if (!row.z) continue;
    w.awake[w.awake_count++] = i;
    const V3<R> slip = moved - row.motion;
    for (int c = 0; c < 2; ++c) row.slip[c] = dot(row.axes[c + 1], slip);
  }
  return sunk;
}

/// y += z (press, pull).
template <class L>
RAGDOLL_INLINE void push(L& w, const ContactRow<typename L::R>& row, const typename L::R& press,
                         const typename L::R* pull) {
  const typename L::R p[3] = {press, pull[0], pull[1]};
  pushAlong<3>(row.feature->row, row.z, p, w);
}

/// What stops the point altogether, and where that takes a pull within the cone.
template <class R, class M>
RAGDOLL_INLINE M gripped(const ContactRow<R>& row, const R* moved, const M& takes, const R& least,
                         const R& press, const R* pull, R* stops) {
  const R* c = row.grip;
  stops[0] = press - (c[0] * moved[0] + c[1] * moved[1] + c[2] * moved[2]);
  stops[1] = pull[0] - (c[1] * moved[0] + c[3] * moved[1] + c[4] * moved[2]);
  stops[2] = pull[1] - (c[2] * moved[0] + c[4] * moved[1] + c[5] * moved[2]);
  const R cone = row.friction * stops[0];
  const auto within = less(stops[1] * stops[1] + stops[2] * stops[2], cone * cone);
  const auto may = both(less(R{}, row.inverse_normal), less(R{}, c[0]));
  return both(both(takes, may), both(within, less(least, stops[0])));
}

/// Presses a row so that moved[0] comes to nothing, but not less than `least`, and rubs against the
/// other two within the cone; moved: at the impulses (press, pull), which change by `change` where
/// `takes` is true. most: the largest change of a sweep, [m]. Returns whether anything changes.
template <class R, class M>
RAGDOLL_INLINE bool solveRow(const ContactRow<R>& row, const R* moved, const M& takes,
                             const R& least, R& press, R* pull, R* change, R& most) {
  using N = typename tree::NumberOf<R>::Type;
  R pressed = select(takes, larger(press - moved[0] * row.inverse_normal, least), press);
  const auto works = either(less(R{}, pressed), less(R{}, press));
  if (!any(works)) return false;
  R stops[3], wanted[2];
  const auto grips = gripped(row, moved, M(both(takes, works)), least, press, pull, stops);
  for (int c = 0; c < 2; ++c)
    wanted[c] = pull[c] - row.inverse_tangent * (moved[c + 1] + row.couple[c] * (pressed - press));
  const R size2 = wanted[0] * wanted[0] + wanted[1] * wanted[1], cone = row.friction * pressed;
  const auto slips = less(cone * cone, size2);
  if (any(slips)) {
    const R share = select(slips, cone / squareRoot(atLeast(size2, N(1e-30))), R{} + N(1));
    for (int c = 0; c < 2; ++c) wanted[c] = share * wanted[c];
  }
  pressed = select(grips, stops[0], pressed);
  for (int c = 0; c < 2; ++c) {
    wanted[c] = select(grips, stops[c + 1], select(takes, wanted[c], pull[c]));
    change[c + 1] = wanted[c] - pull[c];
    most = larger(most, row.answer_tangent * (signOf(change[c + 1]) * change[c + 1]));
  }
  change[0] = pressed - press;
  most = larger(most, row.answer_normal * (signOf(change[0]) * change[0]));
  press = pressed;
  for (int c = 0; c < 2; ++c) pull[c] = wanted[c];
  return true;
}

template <class L>
RAGDOLL_INLINE void pressRow(L& w, const ContactRow<typename L::R>& row, const typename L::R* moved,
                             const typename L::Mask& takes, const typename L::R& least,
                             typename L::R& press, typename L::R* pull) {
  typename L::R change[3];
  if (solveRow(row, moved, takes, least, press, pull, change, w.change))
    push(w, row, change[0], change + 1);
}

template <class L>
RAGDOLL_SECTION void sweepContacts(L& w) {
  using R = typename L::R;
  for (int i = 0; i < w.awake_count; ++i) {
    ContactRow<R>& row = w.contacts[w.awake[i]];
    R moved[3] = {row.gap, row.slip[0], row.slip[1]};
    addAlong<3>(w, row.feature->row, row.z, moved);
    pressRow(w, row, moved, w.unsettled, R{}, row.press, row.pull);
  }
}

}  // namespace ragdoll::fast
