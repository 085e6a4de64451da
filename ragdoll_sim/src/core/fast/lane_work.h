// One pack of bodies during a step, and the memory of it. Private to the units that are compiled
// for an instruction set (pack_*.cpp).
#pragma once

#include <cstdint>

#include "core/fast/border.h"
#include "core/fast/pack.h"
#include "core/linear/tree_kernels.h"

/// A part of a step: a call of its own, which costs nothing beside it and shows in profiles.
#define RAGDOLL_SECTION __attribute__((noinline))

namespace ragdoll::fast {

using tree::load3;
using tree::store3;
using tree::V3;

/// A contact, or a limit: what a sweep solves for at once. z: L^-T J^T (tree_solver.h); a contact's
/// are three, of the particle's motion along x, y, z, whatever its normal.
template <class R>
struct ContactRow {
  const Feature* feature;
  R* z;  ///< 3 per coordinate of the feature's index
  V3<R> normal, motion;
  R weight;   ///< of Feature::b
  R start;    ///< [m] gap at the pose's coordinates zero
  R allowed;  ///< [m] least gap that the step has to reach
  R friction, restitution, approach;
  R inverse_normal, inverse_tangent;  ///< 1 / answers; 0 where there is no contact
  R press, last;                      ///< [kg m] along the normal, and in the last step
  V3<R> pull;                         ///< [kg m] of friction
  V3<R> base;                         ///< [m] displacement of the point at the present coordinates
};

template <class R>
struct LimitRow {
  const FastLimit* limit;
  R* z;
  R inverse;  ///< 0 where it does not take part
  R value;    ///< [rad] at the present coordinates, less what is allowed
  R allowed;
  R compliance;   ///< of a soft limit (LimitRow::eulerSoftness)
  R press, last;  ///< [kg m^2], and in the last step
};

template <class N_, int W_>
struct LaneWork {
  using N = N_;
  static constexpr int W = W_;
  using R = typename RealOf<N, W>::Type;

  tree::Work<R> tree;
  R *x, *v, *dx, *free;  ///< 3 per particle: [m] from origin, [m/s], [m], [m]
  R* spare;              ///< scratch, 3 per particle
  R* force;              ///< [kg m] h^2 times pokes, per particle; only if forced
  R *q, *y;              ///< tangent coordinates, and L times what they still change by
  R* total;              ///< L times the coordinates
  R* start_y;            ///< y of the free motion from coordinates zero
  R *row, *part;         ///< scratch, 3 and 1 per coordinate
  ContactRow<R>* contacts;
  LimitRow<R>* limits;
  R* z;  ///< room for the rows'
  R* z_next;
  int* row_of;       ///< per feature and slot: its contact row, -1
  int* obstacle_of;  ///< per contact row and lane
  int contact_count = 0, limit_count = 0, slots = 0;
  V3<R> shift;          ///< [m] of the pin
  R off;                ///< largest squared sine; stretch at the start
  R pull;               ///< Lane::pull
  R travel, margin;     ///< [m] of the fastest particle in the step; contacts nearer take part
  R before;             ///< [J] kinetic energy at the start, damped
  double origin[W][3];  ///< [m] of the pack's coordinates
  bool forced = false;

  static std::size_t room(const FastBody& b, int planes) {
    const std::size_t n = 3 * b.tree.particles, s = b.tree.size, f = b.features.size();
    const std::size_t slots = kSlots + planes, rows = f * slots;
    const std::size_t z = (3 * rows + b.limits.size()) * b.longest_row;
    return sizeof(LaneWork) + 64 + sizeof(R) * (tree::Work<R>::count(b.tree) + 6 * n + 8 * s + z) +
           sizeof(ContactRow<R>) * rows + sizeof(LimitRow<R>) * b.limits.size() +
           sizeof(int) * (rows + rows * W) + 1024;
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
    for (R** p : {&w->x, &w->v, &w->dx, &w->free, &w->force, &w->spare}) *p = take<R>(at, n);
    for (R** p : {&w->q, &w->y, &w->start_y, &w->part, &w->total}) *p = take<R>(at, s);
    w->row = take<R>(at, 3 * s);
    w->contacts = take<ContactRow<R>>(at, f * w->slots);
    w->limits = take<LimitRow<R>>(at, b.limits.size());
    w->row_of = take<int>(at, f * w->slots);
    w->obstacle_of = take<int>(at, f * w->slots * W);
    w->z = take<R>(at, 0);
    w->contact_count = w->limit_count = 0;
    return w;
  }
};

template <class L>
RAGDOLL_INLINE V3<typename L::R> spread3(const double* a) {
  using R = typename L::R;
  using N = typename L::N;
  return {R{} + N(a[0]), R{} + N(a[1]), R{} + N(a[2])};
}

/// z of `count` rows whose gradient stands in w.row, count per coordinate: elimination along the
/// row's own coordinates only.
template <int count, class L>
RAGDOLL_INLINE void eliminate(const FastBody& b, L& w, const int* index, int size,
                              typename L::R* z) {
  using R = typename L::R;
  const int* begin = b.tree.chain_begin.data();
  for (int i = size - 1; i >= 0; --i) {
    const int k = index[i];
    const R inverse = w.tree.inverse[k];
    R value[count];
    for (int c = 0; c < count; ++c) {
      value[c] = w.row[count * k + c] * inverse;
      z[count * i + c] = value[c];
    }
    const R* h = w.tree.H + begin[k];
    const int* chain = b.tree.chain.data() + begin[k];
    const int depth = begin[k + 1] - begin[k];
    for (int j = 0; j < depth; ++j) {
      R* to = w.row + count * chain[j];
      for (int c = 0; c < count; ++c) to[c] -= h[j] * value[c];
    }
  }
}

}  // namespace ragdoll::fast
