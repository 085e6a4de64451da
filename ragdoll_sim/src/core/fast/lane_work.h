// One pack of bodies during a step, and the memory of it. Private to the units that are compiled
// for an instruction set (pack_*.cpp).
#pragma once

#include <cstdint>

#include "core/fast/border.h"
#include "core/fast/constants.h"
#include "core/fast/pack.h"
#include "core/linear/tree_matrix.h"
#include "core/linear/tree_motion.h"

/// A part of a step: a call of its own, which costs nothing beside it and shows in profiles.
#define RAGDOLL_SECTION __attribute__((noinline))

namespace ragdoll::fast {

using tree::load3;
using tree::store3;
using tree::V3;

/// A contact, or a limit: what a sweep solves for at once. z: L^-T J^T (tree_solver.h); a contact's
/// are three, of its point's motions along the normal and two tangents.
template <class R>
struct ContactRow {
  const Feature* feature;
  R* z;           ///< 3 per coordinate of the feature's row; null: not worked out
  V3<R> axes[3];  ///< normal, tangents
  V3<R> motion;   ///< [m] of the surface
  R weight;       ///< of Feature::b
  R start;        ///< [m] gap at the pose's coordinates zero
  R allowed;      ///< [m] least gap that the step has to reach
  R friction, restitution, approach;
  R free;                             ///< [m] gap where the free motion leads
  R answer_normal, answer_tangent;    ///< [1/kg] the larger one of the tangents
  R couple[2];                        ///< [1/kg] along the tangents, to a push along the normal
  R grip[6];                          ///< [kg] inverse of all answers: nn, n1, n2, 11, 12, 22
  R waits;                            ///< 1 where there is a contact that takes no part
  R inverse_normal, inverse_tangent;  ///< 1 / answers; 0 where none takes part
  R press, last;                      ///< [kg m] along the normal, and in the last step
  R pull[2];                          ///< [kg m] of friction, along the tangents
  R gap;                              ///< [m] at the present coordinates, less what is allowed
  R slip[2];                          ///< [m] along the tangents, likewise
  R rate_press, rate_pull[2];         ///< [kg m] of the step and the velocity stage
  R impact;                           ///< [kg m] of them, what an impact pressed with in the step
};

template <class R>
struct LimitRow {
  const FastLimit* limit;
  R* z;           ///< null: not worked out
  R answer;       ///< [1/(kg m^2)]
  R waits;        ///< 1 where it is near and takes no part
  R inverse;      ///< 0 where it does not take part
  R value;        ///< [rad] at the present coordinates, less what is allowed
  R start, free;  ///< [rad] at the step's start, and where the free motion leads
  R allowed;
  R compliance;   ///< of a soft limit (LimitRow::eulerSoftness)
  R press, last;  ///< [kg m^2], and in the last step
};

/// A particle or stick of a lane that comes near a solid.
struct NearPair {
  int feature = 0, lane = 0;
};

/// Lanes in which a particle's bounds reach below the upper and above the lower faces of where
/// something may touch a solid: 16 bits each for x, y, z.
struct Reach {
  std::uint64_t below = 0, above = 0;
};

/// set: tells units of different instruction sets apart, which must not share functions.
template <class N_, int W_, int set = 0>
struct LaneWork {
  using N = N_;
  static constexpr int W = W_;
  using R = typename RealOf<N, W>::Type;
  using Mask = decltype(less(R{}, R{}));

  tree::Work<R> tree;
  R *x, *v, *dx;    ///< 3 per particle: [m] from origin, [m/s], [m]
  R* spare;         ///< scratch, 3 per particle
  R* force;         ///< [kg m] h^2 times pokes, per particle; only if forced
  R *q, *y;         ///< tangent coordinates, and L times what they still change by
  R* total;         ///< scratch: L times the coordinates
  R* goal;          ///< L^-T T^T times the momentum of the free motion and all impulses
  R* done;          ///< the same of the present coordinates
  R* row;           ///< scratch, per coordinate
  R *here, *there;  ///< [m] 3 per particle, in a solid's frame: at both ends of the step
  R* last_press;    ///< [kg m^2] per limit: of the last step
  R* offset;        ///< [m] per plane, from the lanes' origins
  ContactRow<R>* contacts;
  LimitRow<R>* limits;
  R* z;  ///< room for the rows'
  R* z_next;
  int* row_of;                             ///< per feature and slot: its contact row, -1
  int* obstacle_of;                        ///< per contact row and lane
  Reach* reach;                            ///< per particle, of the solid that is looked at
  NearPair* near;                          ///< likewise
  int near_particles = 0, near_count = 0;  ///< near_particles: they stand before sticks
  int* awake;                              ///< contact rows that take part in a lane
  int* pressing;                           ///< contact rows, then limit rows, of the velocity stage
  int pressing_contacts = 0, pressing_limits = 0;
  int contact_count = 0, awake_count = 0, limit_count = 0, slots = 0;
  V3<R> shift;              ///< [m] of the pin
  V3<R> whole;              ///< [kg m] h times the momentum of the free motion
  V3<R> angular;            ///< [kg m^2] h times the angular momentum at the start, damped
  R poked;                  ///< 1: by a poke
  R off;                    ///< largest squared sine; stretch at the start
  R h, rate, half;          ///< [s], [1/s], [s^2] half of h^2
  R bound;                  ///< [m] that a particle may be left deep
  R opens;                  ///< of an overlap, in the step
  R travel, margin;         ///< [m] of the fastest particle in the step; contacts nearer take part
  R change;                 ///< [m], [rad] the largest of a sweep's
  R settled;                ///< [m], [rad] sweeps that change less are the last
  Mask met;                 ///< who comes near an obstacle
  Mask unsettled;           ///< whose sweeps still change something
  Mask unsolved;            ///< whose Newton rounds still do
  R before;                 ///< [J] kinetic energy at the start, damped
  R square;                 ///< [m^2/s^2] of the speed that has as much
  R recovery;               ///< [m] by which it can lift the body
  double origin[W][W + 3];  ///< [m] of the pack's coordinates: x, y, z, x, y ...
  double settled_turns = 0;  ///< [rad^2] turns that leave less of second order are the last
  bool forced = false;

  static std::size_t room(const FastBody& b, int planes) {
    const std::size_t n = 3 * b.tree.particles, s = b.tree.size, f = b.features.size();
    const std::size_t slots = kSlots + planes, rows = f * slots;
    const std::size_t z = (3 * rows + b.limits.size()) * b.longest_row;
    const std::size_t numbers =
        tree::Work<R>::count(b.tree) + 7 * n + 6 * s + b.limits.size() + planes;
    return sizeof(LaneWork) + 64 + sizeof(R) * (numbers + z) + sizeof(ContactRow<R>) * rows +
           sizeof(LimitRow<R>) * b.limits.size() +
           sizeof(int) * (3 * rows + rows * W + b.limits.size()) + sizeof(NearPair) * f * W +
           sizeof(Reach) * b.tree.particles + 2048;
  }

  template <class T>
  static T* take(char*& at, std::size_t count) {
    const std::uintptr_t mask = 63;
    at = reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(at) + mask) & ~mask);
    T* out = reinterpret_cast<T*>(at);
    at += sizeof(T) * count;
    return out;
  }

  /// A pack in the memory given.
  static LaneWork* in(void* memory, const FastBody& b, int planes) {
    char* at = static_cast<char*>(memory);
    LaneWork* w = take<LaneWork>(at, 1);
    const std::size_t n = 3 * b.tree.particles, s = b.tree.size, f = b.features.size();
    w->slots = kSlots + planes;
    w->tree.take(b.tree, take<R>(at, tree::Work<R>::count(b.tree)));
    for (R** p : {&w->x, &w->v, &w->dx, &w->force, &w->spare, &w->here, &w->there})
      *p = take<R>(at, n);
    for (R** p : {&w->q, &w->y, &w->total, &w->goal, &w->done, &w->row}) *p = take<R>(at, s);
    w->last_press = take<R>(at, b.limits.size());
    w->offset = take<R>(at, planes);
    w->contacts = take<ContactRow<R>>(at, f * w->slots);
    w->limits = take<LimitRow<R>>(at, b.limits.size());
    w->row_of = take<int>(at, f * w->slots);
    w->obstacle_of = take<int>(at, f * w->slots * W);
    w->reach = take<Reach>(at, b.tree.particles);
    w->near = take<NearPair>(at, f * W);
    w->awake = take<int>(at, f * w->slots);
    w->pressing = take<int>(at, f * w->slots + b.limits.size());
    w->z = take<R>(at, 0);
    w->contact_count = w->awake_count = w->limit_count = 0;
    return w;
  }
};

/// What of a violation may stay, of a gap or a limit's value at the start. opens: the share of it
/// that goes; recovery: at most, in its units.
template <class R>
RAGDOLL_INLINE R allowedOf(const R& start, const R& opens, const R& recovery) {
  const R violated = select(less(start, R{}), start, R{}), undone = R{} - opens * violated;
  return violated + select(less(undone, recovery), undone, recovery);
}

/// w.dx of the pose at w.q.
template <class L>
RAGDOLL_SECTION void setPose(const FastBody& b, L& w) {
  tree::retract(b.tree, w.q, w.shift, w.tree, w.dx, w.off);
}

/// Directions, H and its factors at the start.
template <class L>
RAGDOLL_SECTION void setTree(const FastBody& b, L& w) {
  tree::setFrames(b.tree, w.x, w.tree);
  tree::setMatrix(b.tree, b.depth.data(), w.tree);
  tree::factorise(b.tree, 0, w.tree);
}

/// [m] of a plane's offset from an origin.
RAGDOLL_INLINE double offsetFrom(const double* origin, const double* normal, double offset) {
  return offset - (normal[0] * origin[0] + normal[1] * origin[1] + normal[2] * origin[2]);
}

template <class L>
RAGDOLL_INLINE V3<typename L::R> spread3(const double* a) {
  using R = typename L::R;
  using N = typename L::N;
  return {R{} + N(a[0]), R{} + N(a[1]), R{} + N(a[2])};
}

/// As `eliminate`, of a row whose coordinates are one's ancestors: two of them at once.
template <int count, class L>
RAGDOLL_INLINE void eliminateChain(const L& w, const RowShape& row, typename L::R* z) {
  using R = typename L::R;
  int i = row.size() - 1;
  for (; i > 0; i -= 2) {
    const R *below = w.tree.H + row.chain[i], *next = w.tree.H + row.chain[i - 1];
    const R inverse = w.tree.inverse[row.index[i]], inverse2 = w.tree.inverse[row.index[i - 1]];
    const R shared = below[i - 1];
    R a[count], b[count];
    for (int c = 0; c < count; ++c) {
      z[count * i + c] = a[c] = z[count * i + c] * inverse;
      z[count * (i - 1) + c] = b[c] = (z[count * (i - 1) + c] - shared * a[c]) * inverse2;
    }
    for (int k = 0; k < i - 1; ++k)
      for (int c = 0; c < count; ++c) z[count * k + c] -= below[k] * a[c] + next[k] * b[c];
  }
  if (i == 0)
    for (int c = 0; c < count; ++c) z[c] = z[c] * w.tree.inverse[row.index[0]];
}

/// z of `count` rows from their gradients, in place: elimination along the row's own coordinates
/// only.
template <int count, class L>
RAGDOLL_INLINE void eliminate(const L& w, const RowShape& row, typename L::R* z) {
  using R = typename L::R;
  if (!row.chain.empty()) return eliminateChain<count>(w, row, z);
  const R* h = w.tree.H;
  for (int i = row.size() - 1; i >= 0; --i) {
    R sum[count];
    for (int c = 0; c < count; ++c) sum[c] = z[count * i + c];
    for (int k = row.terms_begin[i]; k < row.terms_begin[i + 1]; ++k) {
      const RowShape::Term term = row.terms[k];
      const R factor = h[term.at];
      for (int c = 0; c < count; ++c) sum[c] -= factor * z[count * term.below + c];
    }
    const R inverse = w.tree.inverse[row.index[i]];
    for (int c = 0; c < count; ++c) z[count * i + c] = sum[c] * inverse;
  }
}

/// y += z p, for `count` rows at once.
template <int count, class L>
RAGDOLL_INLINE void pushAlong(const RowShape& row, const typename L::R* z, const typename L::R* p,
                              L& w) {
  using R = typename L::R;
  const int* index = row.index.data();
  const int size = row.size();
  R* y = w.y;
  for (int k = 0; k < size; ++k, z += count) {
    R sum = z[0] * p[0];
    for (int c = 1; c < count; ++c) sum += z[c] * p[c];
    y[index[k]] += sum;
  }
}

/// out += z . y, likewise. Sums over even and odd entries: half as long to wait for.
template <int count, class L>
RAGDOLL_INLINE void addAlong(const L& w, const RowShape& row, const typename L::R* z,
                             typename L::R* out) {
  using R = typename L::R;
  const int* index = row.index.data();
  const int size = row.size();
  const R* y = w.y;
  R odd[count];
  for (int c = 0; c < count; ++c) odd[c] = R{};
  int k = 0;
  for (; k + 1 < size; k += 2, z += 2 * count) {
    const R a = y[index[k]], b = y[index[k + 1]];
    for (int c = 0; c < count; ++c) {
      out[c] += z[c] * a;
      odd[c] += z[count + c] * b;
    }
  }
  if (k < size)
    for (int c = 0; c < count; ++c) out[c] += z[c] * y[index[k]];
  for (int c = 0; c < count; ++c) out[c] += odd[c];
}

}  // namespace ragdoll::fast
