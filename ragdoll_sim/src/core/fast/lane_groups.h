// Bodies that press on each other, nothing outside on them: their angular momentum. Friction
// between two sticks acts on their axes, which are apart by both radii; what that takes comes back
// as a spin of all of them, and slip is measured against how they turn, as in
// direct/angular_momentum.h.
#pragma once

#include "core/fast/lane_pair.h"

namespace ragdoll::fast {

using D3 = V3<double>;

/// Sums over particles, about one place.
struct Moments {
  double mass = 0;
  D3 first{}, momentum{}, angular{};
  SecondMoments<double> second;
};

RAGDOLL_INLINE void addTo(Moments& sum, const Moments& part) {
  sum.mass += part.mass;
  sum.first = sum.first + part.first;
  sum.momentum = sum.momentum + part.momentum;
  sum.angular = sum.angular + part.angular;
  sum.second.xx += part.second.xx;
  sum.second.yy += part.second.yy;
  sum.second.zz += part.second.zz;
  sum.second.xy += part.second.xy;
  sum.second.xz += part.second.xz;
  sum.second.yz += part.second.yz;
}

RAGDOLL_INLINE D3 centreOf(const Moments& m) { return (1 / m.mass) * m.first; }

/// Angular momentum about the centre of mass.
RAGDOLL_INLINE D3 ownAngular(const Moments& m) {
  return m.angular - cross(centreOf(m), m.momentum);
}

/// What turns all as one with the same angular momentum.
RAGDOLL_INLINE D3 turnOf(const Moments& m, const D3& angular) {
  const D3 c = centreOf(m);
  SecondMoments<double> own = m.second;
  own.add(-m.mass * c, c);
  return spinOf(own, angular);
}

/// A body's part of a group, and where it is the group's first, the group.
struct Group {
  int first = 0;         ///< place of the group's first
  bool outside = false;  ///< something takes or gives momentum: it has no turn
  Moments start;         ///< of the body, before the step; pokes' impulses are in it
  Moments sum;           ///< of the group: sumGroups
  D3 turn{};             ///< [rad/s] of the group as one; 0: it has none
};

template <class R>
RAGDOLL_INLINE D3 inDoubles(const V3<R>& a) {
  return {double(a.x), double(a.y), double(a.z)};
}

/// From the first body's origin.
template <class L>
RAGDOLL_INLINE D3 originOf(const Partners& all, const L& w) {
  const L& base = workIn<L>(all.bodies[0].memory);
  return {w.origin[0][0] - base.origin[0][0], w.origin[0][1] - base.origin[0][1],
          w.origin[0][2] - base.origin[0][2]};
}

/// Of one body at w.x that moves by `v`: 3 numbers per particle.
template <class L>
RAGDOLL_SECTION Moments momentsOf(const Partners& all, const FastBody& b, const L& w,
                                  const typename L::R* v) {
  Moments out;
  const D3 origin = originOf(all, w);
  for (int i = 0; i < b.tree.particles; ++i) {
    D3 m{}, p{};
    for (int k = b.tree.mass_begin[i]; k < b.tree.mass_begin[i + 1]; ++k) {
      const Tree::Mass& mass = b.tree.masses[k];
      m = m + mass.value * (origin + inDoubles(load3(w.x + 3 * mass.column)));
      p = p + mass.value * inDoubles(load3(v + 3 * mass.column));
    }
    const D3 x = origin + inDoubles(load3(w.x + 3 * i));
    out.mass += b.tree.mass[i];
    out.first = out.first + m;
    out.momentum = out.momentum + p;
    out.angular = out.angular + cross(x, p);
    out.second.add(m, x);
  }
  return out;
}

RAGDOLL_INLINE int rootOf(const Group* groups, int i) {
  while (groups[i].first != i) i = groups[i].first;
  return i;
}

/// Who presses on whom now.
template <class L>
RAGDOLL_SECTION void findGroups(const Partners& all, const PairRow<L>* pairs, Group* groups) {
  for (int i = 0; i < all.count; ++i) {
    const Partner& p = all.bodies[i];
    groups[i].first = i;
    groups[i].turn = D3{};
    groups[i].outside = p.body->tree.roots[0].pinned || touchedOf(workIn<L>(p.memory)) > 0;
  }
  for (int k = 0; k < all.contact_count; ++k) {
    if (!(pairs[k].row.press > 0)) continue;
    const int a = all.contacts[k].body[0], b = all.contacts[k].body[1];
    if (a < 0 || b < 0) {
      groups[a < 0 ? b : a].outside = true;
      continue;
    }
    const int i = rootOf(groups, a), j = rootOf(groups, b);
    groups[i < j ? j : i].first = i < j ? i : j;
  }
  for (int i = 0; i < all.count; ++i) {
    groups[i].first = rootOf(groups, i);
    if (groups[i].outside) groups[groups[i].first].outside = true;
  }
}

/// Sums over each group of what of(i) is of its bodies.
template <class Of>
RAGDOLL_INLINE void sumGroups(int count, Group* groups, const Of& of) {
  for (int i = 0; i < count; ++i) groups[i].sum = Moments();
  for (int i = 0; i < count; ++i)
    if (Group& group = groups[groups[i].first]; !group.outside) addTo(group.sum, of(i));
}

/// Who presses on whom now, and how they turn.
template <class L>
RAGDOLL_SECTION void setTurns(const Partners& all, const PairRow<L>* pairs, Group* groups) {
  findGroups(all, pairs, groups);
  sumGroups(all.count, groups, [groups](int i) { return groups[i].start; });
  for (int i = 0; i < all.count; ++i)
    if (Group& group = groups[i]; group.first == i && !group.outside)
      group.turn = turnOf(group.sum, ownAngular(group.sum));
}

RAGDOLL_INLINE bool hasTurn(const PairContact& c, const Group* groups) {
  return c.body[0] >= 0 && c.body[1] >= 0 && !groups[groups[c.body[0]].first].outside;
}

/// [m] What of a contact's slip in a step is the turn of its bodies as one.
template <class L>
RAGDOLL_INLINE V3<typename L::R> turnedBy(double h, const PairContact& c, const Group* groups) {
  using R = typename L::R;
  if (!hasTurn(c, groups)) return V3<R>{};
  const D3 slip = cross(groups[groups[c.body[0]].first].turn,
                        h * c.reach * D3{c.normal[0], c.normal[1], c.normal[2]});
  return {R(slip.x), R(slip.y), R(slip.z)};
}

/// Before the step: sums that groups are to have again.
template <class L>
RAGDOLL_SECTION void startGroups(const PackStep& step, const Partners& all, Group* groups) {
  for (int i = 0; i < all.count; ++i) {
    const Partner& p = all.bodies[i];
    const L& w = workIn<L>(p.memory);
    Moments& start = groups[i].start;
    start = momentsOf(all, *p.body, w, w.v);
    if (!w.forced) continue;
    const D3 origin = originOf(all, w);
    for (int k = 0; k < 3 * p.body->tree.particles; k += 3) {
      const D3 push = (1 / step.h) * inDoubles(load3(w.force + k));
      start.momentum = start.momentum + push;
      start.angular = start.angular + cross(origin + inDoubles(load3(w.x + k)), push);
    }
  }
}

/// Velocities (w.dx, times h): a spin of each group gives back what friction has taken.
template <class L>
RAGDOLL_SECTION void restoreSpin(const PackStep& step, const Partners& all, Group* groups) {
  using R = typename L::R;
  for (int i = 0; i < all.count; ++i)
    if (Group& group = groups[i]; group.first == i && !group.outside)
      group.turn = step.h * ownAngular(group.sum);
  sumGroups(all.count, groups, [&all](int i) {
    const L& w = workIn<L>(all.bodies[i].memory);
    return momentsOf(all, *all.bodies[i].body, w, w.dx);
  });
  for (int i = 0; i < all.count; ++i)
    if (Group& group = groups[i]; group.first == i && !group.outside)
      group.turn = turnOf(group.sum, group.turn - ownAngular(group.sum));
  for (int i = 0; i < all.count; ++i) {
    const Group& group = groups[groups[i].first];
    if (group.outside) continue;
    const Partner& p = all.bodies[i];
    L& w = workIn<L>(p.memory);
    const D3 base = originOf(all, w) - centreOf(group.sum);
    for (int k = 0; k < 3 * p.body->tree.particles; k += 3) {
      const D3 spin = cross(group.turn, base + inDoubles(load3(w.x + k)));
      store3(load3(w.dx + k) + V3<R>{R(spin.x), R(spin.y), R(spin.z)}, w.dx + k);
    }
  }
}

}  // namespace ragdoll::fast
