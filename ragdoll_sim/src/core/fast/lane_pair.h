// What presses between two bodies of one step, or between two sticks of one: a row of both.
// docs/fast.md#together.
#pragma once

#include "core/fast/lane_step.h"

namespace ragdoll::fast {

/// One body's part of a contact between two.
template <class L>
struct PairSide {
  const FastBody* b;
  L* w;  ///< null: it does not move
  const Feature* feature;
  typename L::R weight;
  typename L::R* z;
};

template <class L>
struct PairRow {
  ContactRow<typename L::R> row;  ///< but for what the sides have
  PairSide<L> side[2];            ///< the second is pushed against the axes
};

/// All bodies of a step, one after the other.
template <class L, class To>
RAGDOLL_INLINE void forPartners(const Partners& all, const To& to) {
  for (int i = 0; i < all.count; ++i) {
    const Partner& p = all.bodies[i];
    to(*p.body, p.lane, workIn<L>(p.memory));
  }
}

/// What the places of a contact do relative to each other; of(w): 3 numbers per particle.
template <class L, class Of>
RAGDOLL_INLINE V3<typename L::R> between(const PairRow<L>& p, const Of& of) {
  V3<typename L::R> sum{};
  for (int k = 0; k < 2; ++k) {
    const PairSide<L>& s = p.side[k];
    if (!s.w) continue;
    const V3<typename L::R> own = atFeature(*s.feature, s.weight, of(*s.w));
    sum = k == 0 ? sum + own : sum - own;
  }
  return sum;
}

/// Adds a contact's coordinates' part to what it moves by.
template <class L>
RAGDOLL_INLINE void addBetween(const PairRow<L>& p, typename L::R* moved) {
  for (int k = 0; k < 2; ++k) {
    const PairSide<L>& s = p.side[k];
    if (!s.w) continue;
    typename L::R own[3] = {};
    addAlong<3>(*s.w, s.feature->row, s.z, own);
    for (int c = 0; c < 3; ++c) moved[c] += k == 0 ? own[c] : -own[c];
  }
}

template <class L>
RAGDOLL_INLINE void pushApart(const PairRow<L>& p, const typename L::R& press,
                              const typename L::R* pull) {
  for (int k = 0; k < 2; ++k) {
    const PairSide<L>& s = p.side[k];
    if (!s.w) continue;
    typename L::R push[3] = {press, pull[0], pull[1]};
    for (int c = 0; c < 3 && k == 1; ++c) push[c] = -push[c];
    pushAlong<3>(s.feature->row, s.z, push, *s.w);
  }
}

/// Both sides' z, and what they answer with: of a body with itself, that of their difference.
template <class L>
RAGDOLL_SECTION void setAnswer(PairRow<L>& p) {
  using R = typename L::R;
  Answer<R> sum;
  for (PairSide<L>& s : p.side) {
    if (!s.w) continue;
    p.row.feature = s.feature;
    p.row.weight = s.weight;
    setRows(*s.b, *s.w, p.row);
    s.z = p.row.z;
    for (int k = 0; k < s.feature->row.size(); ++k) sum.add(R(1), s.z + 3 * k, s.z + 3 * k);
  }
  const PairSide<L>&a = p.side[0], &b = p.side[1];
  if (a.w == b.w) {
    const RowShape &first = a.feature->row, &second = b.feature->row;
    for (int i = 0, k = 0; i < first.size() && k < second.size();) {
      if (first.index[i] == second.index[k]) {
        sum.add(R(-1), a.z + 3 * i, b.z + 3 * k);
        sum.add(R(-1), b.z + 3 * k, a.z + 3 * i);
      }
      first.index[i] < second.index[k] ? ++i : ++k;
    }
  }
  setAnswer(sum, p.row);
}

/// A contact's row, where the free motion leads.
template <class L>
RAGDOLL_INLINE void setPair(const PackStep& step, const Partners& all, const PairContact& c,
                            PairRow<L>& p) {
  using R = typename L::R;
  for (int k = 0; k < 2; ++k) {
    PairSide<L>& s = p.side[k];
    s.w = nullptr;
    if (c.body[k] < 0) continue;
    const Partner& body = all.bodies[c.body[k]];
    s = {body.body, &workIn<L>(body.memory), &body.body->features[c.feature[k]], R(c.weight[k]),
         nullptr};
  }
  ContactRow<R>& row = p.row;
  row = ContactRow<R>{};
  row.axes[0] = {R(c.normal[0]), R(c.normal[1]), R(c.normal[2])};
  const R share = R(0.5 * step.h * step.h);
  row.axes[1] = {share * R(c.impulse[0]), share * R(c.impulse[1]), share * R(c.impulse[2])};
  row.friction = R(c.friction);
  row.waits = R(1);
  setTangents(row);
  row.start = R(c.gap);
  R recovery{};
  for (const PairSide<L>& s : p.side)
    if (s.w) recovery = larger(recovery, s.w->recovery);
  row.allowed = allowedOf(row.start, R(kRecovery), recovery);
}

/// As measureContacts. turned: [m] what does not count as slip.
template <class L>
RAGDOLL_INLINE bool measurePair(const V3<typename L::R>& turned, PairRow<L>& p) {
  using R = typename L::R;
  ContactRow<R>& row = p.row;
  const V3<R> moved = between(p, [](const L& w) { return w.dx; });
  row.gap = row.start + dot(row.axes[0], moved) - row.allowed;
  for (int c = 0; c < 2; ++c) row.slip[c] = dot(row.axes[c + 1], moved - turned);
  const auto wakes = joins(row);
  if (wakes) {
    setAnswer(p);
    takePart(wakes, row);
  }
  return both(wakes, less(row.gap, R{}));
}

template <class L>
RAGDOLL_INLINE bool tooDeep(const StepBounds& bounds, const PairRow<L>& p) {
  const ContactRow<typename L::R>& row = p.row;
  return row.gap + row.allowed < -bounds.particle && row.gap < -kWorse * bounds.particle;
}

/// As of a body's own rows (lane_step.h), where both rest: what moves opens it itself.
template <class L>
RAGDOLL_INLINE bool beganDeep(const PairRow<L>& p) {
  using R = typename L::R;
  R square{};
  for (const PairSide<L>& s : p.side)
    if (s.w) square = larger(square, s.w->square);
  return p.row.start < R(-kSunkStick) && square < R(kRests * kRests);
}

}  // namespace ragdoll::fast
