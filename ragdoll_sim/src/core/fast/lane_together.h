// Bodies that touch each other, or themselves, in one step: packs of one body each, whose rounds go
// side by side. docs/fast.md#together.
#pragma once

#include "core/fast/lane_groups.h"

namespace ragdoll::fast {

/// Bodies with a row of every contact that they may have, whatever their own obstacles.
template <class L>
RAGDOLL_INLINE bool hasRoom(const Partners& all) {
  for (int i = 0; i < all.count; ++i) {
    const L& w = workIn<L>(all.bodies[i].memory);
    int rows = w.contact_count;
    for (int k = 0; k < all.contact_count; ++k)
      rows += (all.contacts[k].body[0] == i) + (all.contacts[k].body[1] == i);
    if (rows > static_cast<int>(all.bodies[i].body->features.size()) * w.slots) return false;
  }
  return true;
}

/// The sweeps of one round, over all bodies and what is between them.
template <class L>
RAGDOLL_SECTION bool sweepTogether(const PackStep& step, const Partners& all, PairRow<L>* pairs) {
  using R = typename L::R;
  forPartners<L>(all, [](const FastBody&, Lane*, L& w) { w.unsettled = true; });
  for (int sweep = 0; sweep < kSweepsTogether; ++sweep) {
    R change{};
    for (int k = 0; k < all.contact_count; ++k) {
      ContactRow<R>& row = pairs[k].row;
      if (row.waits > 0) continue;
      R moved[3] = {row.gap, row.slip[0], row.slip[1]}, by[3];
      addBetween(pairs[k], moved);
      if (solveRow(row, moved, true, R{}, row.press, row.pull, by, change))
        pushApart(pairs[k], by[0], by + 1);
    }
    forPartners<L>(all, [&change](const FastBody&, Lane*, L& w) {
      w.change = R{};
      sweepContacts(w);
      sweepLimits(w);
      change = larger(change, w.change);
    });
    if (!(change > R(kSettledSpeed * step.h))) return false;
  }
  return true;
}

/// Positions: rounds until nothing is left, as `finish`.
template <class L>
RAGDOLL_SECTION void solveTogether(const PackStep& step, const Partners& all, PairRow<L>* pairs,
                                   Group* groups) {
  const auto measure = [&] {
    bool sunk = false;
    setTurns(all, pairs, groups);
    for (int k = 0; k < all.contact_count; ++k)
      if (measurePair(turnedBy<L>(step.h, all.contacts[k], groups), pairs[k])) sunk = true;
    return sunk;
  };
  measure();
  const auto isDeep = [&] {
    bool deep = false;
    forPartners<L>(all, [&](const FastBody&, Lane*, L& w) { deep = deep || tooDeep(w); });
    for (int k = 0; k < all.contact_count; ++k) deep = deep || tooDeep(step.bounds, pairs[k]);
    return deep;
  };
  bool unsolved = true;
  for (int round = 0; round < kMostRounds && unsolved; ++round) {
    if (round >= kNewton && !isDeep()) break;
    forPartners<L>(all, [&](const FastBody& b, Lane*, L& w) {
      setRest(b, w);
      if (round == 0) startRows(w);
    });
    for (int k = 0; k < all.contact_count && round == 0; ++k)
      if (pairs[k].row.press > 0) pushApart(pairs[k], pairs[k].row.press, pairs[k].row.pull);
    unsolved = sweepTogether(step, all, pairs);
    forPartners<L>(all, [&](const FastBody& b, Lane*, L& w) {
      w.unsolved = true;
      w.unsettled = false;
      endRound(b, w);
      unsolved = unsolved || w.unsolved;
    });
    unsolved = measure() || unsolved;
  }
}

/// How the bodies are held and pressed, all of them together.
struct Hold {
  bool pressed = false;  ///< by anything
  bool outside = false;  ///< by something that takes momentum
  bool driven = false;   ///< by something that may give energy
};

template <class L>
RAGDOLL_INLINE Hold holdOf(const Partners& all, const PairRow<L>* pairs) {
  Hold hold;
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) {
    const bool touched = touchedOf(w) > 0;
    hold.pressed = hold.pressed || pressedOf(w, touchedOf(w)) > 0;
    hold.outside = hold.outside || touched || b.tree.roots[0].pinned;
    hold.driven = hold.driven || lane->driven;
  });
  for (int k = 0; k < all.contact_count; ++k) {
    if (!(pairs[k].row.press > 0)) continue;
    hold.pressed = true;
    hold.outside = hold.outside || !pairs[k].side[0].w || !pairs[k].side[1].w;
  }
  return hold;
}

/// As limitMotion, by the energy of all of them; where something outside presses.
template <class L>
RAGDOLL_SECTION void limitMotions(const PackStep& step, const Partners& all) {
  double before = 0, after = 0, work = 0;
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) {
    after += energyOf<L>(b, w.dx, w.rate * w.rate);
    before += w.before;
    work += energyBound(b, step, lane, w, 0.5) - w.before;
  });
  if (!(before + work + kUnseenShare * after < after)) return;
  const double share = motionShare(before, after, work);
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) {
    for (int k = 0; k < b.tree.size; ++k) w.q[k] = share * w.q[k];
    setPose(b, w);
    lane->limited = share < 1 - kReportedShare;
  });
}

/// Where the velocity stage starts (startRates), of bodies and of what is between them.
template <class L>
RAGDOLL_SECTION void startAllRates(const PackStep& step, const Partners& all, PairRow<L>* pairs,
                                   const Group* groups) {
  using R = typename L::R;
  const V3<R> kick = kickOf(step, workIn<L>(all.bodies[0].memory));
  forPartners<L>(all, [&](const FastBody& b, Lane*, L& w) {
    for (int k = 0; k < b.tree.size; ++k) w.y[k] = R{};
    startRates(b, step, kick, w);
  });
  for (int k = 0; k < all.contact_count; ++k) {
    PairRow<L>& p = pairs[k];
    if (!(p.row.press > 0)) continue;
    V3<R> rate = between(p, [](const L& w) { return w.dx; });
    if (!p.side[1].w) rate = rate + kick;
    if (!p.side[0].w) rate = rate - kick;
    const R share = startRate(true, rate - turnedBy<L>(step.h, all.contacts[k], groups), p.row);
    const R pull[2] = {share * p.row.pull[0], share * p.row.pull[1]};
    pushApart(p, share * p.row.press, pull);
  }
}

template <class L>
RAGDOLL_SECTION void sweepAllRates(const PackStep& step, const Partners& all, PairRow<L>* pairs) {
  using R = typename L::R;
  bool unsettled = true;
  for (int sweep = 0; sweep < kRateSweeps && unsettled; ++sweep) {
    R change{};
    for (int k = 0; k < all.contact_count; ++k) {
      ContactRow<R>& row = pairs[k].row;
      if (!(row.press > 0)) continue;
      R rate[3] = {row.gap, row.slip[0], row.slip[1]}, by[3];
      addBetween(pairs[k], rate);
      if (solveRow(row, rate, true, row.impact, row.rate_press, row.rate_pull, by, change))
        pushApart(pairs[k], by[0], by + 1);
    }
    unsettled = change > R(kSettledSpeed * step.h);
    forPartners<L>(all, [&unsettled](const FastBody&, Lane*, L& w) {
      w.unsettled = true;
      sweepRates(w);
      unsettled = unsettled || w.unsettled;
    });
  }
}

/// Velocities, as endVelocities.
template <class L>
RAGDOLL_SECTION void solveRates(const PackStep& step, const Partners& all, PairRow<L>* pairs,
                                Group* groups) {
  setTurns(all, pairs, groups);
  startAllRates(step, all, pairs, groups);
  sweepAllRates(step, all, pairs);
  forPartners<L>(all, [&](const FastBody& b, Lane*, L& w) {
    takePushes(b, w);
    endRates(b, kickOf(step, w), w);
  });
}

/// As limitVelocities, by the energy of all of them: against their motion as one where nothing
/// outside takes momentum.
template <class L>
RAGDOLL_SECTION void limitRates(const PackStep& step, const Partners& all, const Hold& hold,
                                double bound) {
  using R = typename L::R;
  const double rate2 = 1 / (step.h * step.h);
  double after = 0;
  forPartners<L>(all,
                 [&](const FastBody& b, Lane*, L& w) { after += energyOf<L>(b, w.dx, rate2); });
  if (!(bound + kReportedShare * after < after)) return;
  Moments sum;
  if (!hold.outside)
    forPartners<L>(all,
                   [&](const FastBody& b, Lane*, L& w) { addTo(sum, momentsOf(all, b, w, w.dx)); });
  const bool moves = !hold.outside;
  const D3 centre = moves ? centreOf(sum) : D3{},
           spin = moves ? turnOf(sum, ownAngular(sum)) : D3{};
  const D3 drift = moves ? (1 / sum.mass) * sum.momentum : D3{};
  const double rigid =
      moves ? 0.5 * rate2 * (dot(drift, sum.momentum) + dot(spin, ownAngular(sum))) : 0;
  const double scale = squareRoot(atLeast(bound - rigid, 0) / atLeast(after - rigid, 1e-30));
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) {
    const D3 base = originOf(all, w) - centre;
    for (int i = 0; i < 3 * b.tree.particles; i += 3) {
      const D3 whole = drift + cross(spin, base + inDoubles(load3(w.x + i)));
      const V3<R> common{R(whole.x), R(whole.y), R(whole.z)};
      store3(common + R(scale) * (load3(w.dx + i) - common), w.dx + i);
    }
    lane->limited = lane->limited || scale < 1 - kReportedShare;
  });
}

template <class L>
RAGDOLL_INLINE void storePair(const PackStep& step, const PairRow<L>& p, PairContact& c) {
  const ContactRow<typename L::R>& row = p.row;
  const double rate2 = row.press > 0 ? 1 / (step.h * step.h) : 0;
  const double f[] = {rate2 * pressOf(row), rate2 * pullOf(row, 0), rate2 * pullOf(row, 1)};
  for (int i = 0; i < 3; ++i) c.impulse[i] = 0;
  for (int k = 0; k < 3; ++k) {
    c.impulse[0] += f[k] * row.axes[k].x;
    c.impulse[1] += f[k] * row.axes[k].y;
    c.impulse[2] += f[k] * row.axes[k].z;
  }
  c.holds = grips(row.friction, row.press, row.pull[0], row.pull[1]);
}

template <class L>
void finishTogether(const PackStep& step, const Partners& all) {
  using R = typename L::R;
  Group* groups = static_cast<Group*>(all.memory);
  PairRow<L>* pairs = reinterpret_cast<PairRow<L>*>(groups + all.count);
  startGroups<L>(step, all, groups);
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) { beginRounds(b, step, lane, w); });
  if (!hasRoom<L>(all)) {
    for (int i = 0; i < all.count; ++i) all.bodies[i].lane->good = false;
    return;
  }
  for (int k = 0; k < all.contact_count; ++k) setPair(step, all, all.contacts[k], pairs[k]);
  solveTogether(step, all, pairs, groups);
  forPartners<L>(all, [](const FastBody&, Lane* lane, L& w) { checkBounds(lane, w); });
  for (int k = 0; k < all.contact_count; ++k)
    for (PairSide<L>& s : pairs[k].side)
      if (s.w && (tooDeep(step.bounds, pairs[k]) || beganDeep(pairs[k]))) s.w->off = R(1);
  const Hold hold = holdOf(all, pairs);
  if (hold.outside && !hold.driven) limitMotions<L>(step, all);
  for (int k = 0; k < all.contact_count; ++k) {
    const ContactRow<R>& row = pairs[k].row;
    const V3<R> push =
        row.press * row.axes[0] + row.pull[0] * row.axes[1] + row.pull[1] * row.axes[2];
    for (int i = 0; i < 2; ++i)
      if (L* w = pairs[k].side[i].w) w->whole = i == 0 ? w->whole + push : w->whole - push;
  }
  double bound = 0;
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) {
    keepWhole(b, lane, w);
    tree::place(b.tree, w.tree, w.x, w.dx, w.x);
    bound += energyBound(b, step, lane, w, 1) + (hold.pressed ? 0 : freeGain(b));
  });
  solveRates(step, all, pairs, groups);
  restoreSpin<L>(step, all, groups);
  if (!hold.driven) limitRates<L>(step, all, hold, bound);
  forPartners<L>(all, [&](const FastBody& b, Lane* lane, L& w) {
    findDeep(b, step, lane, w);
    store(b, lane, w);
    storePresses(b, lane, w);
  });
  for (int k = 0; k < all.contact_count; ++k) storePair(step, pairs[k], all.contacts[k]);
}

template <class L>
std::size_t roomForPartners(int bodies, int contacts) {
  return sizeof(Group) * static_cast<std::size_t>(bodies) +
         sizeof(PairRow<L>) * static_cast<std::size_t>(contacts);
}

template <class L>
constexpr PackMethod methodOf() {
  if constexpr (L::W == 1)
    return {1, &L::room, &predict<L>, &finish<L>, &roomForPartners<L>, &finishTogether<L>};
  else
    return {L::W, &L::room, &predict<L>, &finish<L>};
}

}  // namespace ragdoll::fast
