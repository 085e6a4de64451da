// Particles and sticks that come near one solid, of whichever lanes: as many at once as a pack has
// lanes. With a body a lane, two lanes of eight would have something near. docs/fast.md#search.
#pragma once

#include <utility>

#include "core/fast/lane_paths.h"
#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// A number of each pair: from(i) of the i-th.
template <class L, class From, std::size_t... I>
RAGDOLL_INLINE typename L::R ofPairs(const From& from, std::index_sequence<I...>) {
  if constexpr (L::W == 1)
    return from(0);
  else
    return {typename L::R::Vector{from(static_cast<int>(I))...}};
}

/// Up to W pairs with one solid.
template <class L>
struct PairBatch {
  using R = typename L::R;
  using N = typename L::N;

  const NearPair* pairs;
  int count;  ///< what is beyond repeats the first one
  typename L::Mask mask;
  R margin;
  V3<R> at1;  ///< [m] SolidPlace::at1

  template <class From>
  RAGDOLL_INLINE R number(const From& from) const {
    return ofPairs<L>([&](int i) { return from(pairs[i < count ? i : 0]); },
                      std::make_index_sequence<L::W>());
  }
  /// Of the lanes' three numbers.
  RAGDOLL_INLINE V3<R> ofLanes(const V3<R>& v) const {
    return {number([&v](const NearPair& p) { return lane(v.x, p.lane); }),
            number([&v](const NearPair& p) { return lane(v.y, p.lane); }),
            number([&v](const NearPair& p) { return lane(v.z, p.lane); })};
  }
  /// Of a particle of each pair.
  template <class Particle>
  RAGDOLL_INLINE V3<R> ofParticles(const R* of, const Particle& particle) const {
    const auto at = [&](int c) {
      return number([&](const NearPair& p) { return lane(of[3 * particle(p) + c], p.lane); });
    };
    return {at(0), at(1), at(2)};
  }
};

template <class L>
RAGDOLL_INLINE PairBatch<L> batchOf(const NearPair* pairs, int left, const typename L::R& margin,
                                    const SolidPlace<typename L::R>& s) {
  using N = typename L::N;
  PairBatch<L> batch;
  batch.pairs = pairs;
  batch.count = left < L::W ? left : L::W;
  const int count = batch.count;
  const auto counts =
      ofPairs<L>([count](int i) { return N(i < count ? 1 : 0); }, std::make_index_sequence<L::W>());
  batch.mask = less(typename L::R{}, counts);
  batch.margin = batch.number([&margin](const NearPair& p) { return lane(margin, p.lane); });
  batch.at1 = batch.ofLanes(s.at1);
  return batch;
}

template <class L>
RAGDOLL_INLINE ParticlePath<typename L::R> particlePath(const FastBody& b, const L& w,
                                                        const PairBatch<L>& batch) {
  using N = typename L::N;
  const auto a = [&b](const NearPair& p) { return b.features[p.feature].a; };
  return {batch.ofParticles(w.here, a), batch.ofParticles(w.there, a),
          batch.number([&b](const NearPair& p) { return N(b.features[p.feature].radius[0]); })};
}

template <class L>
RAGDOLL_INLINE StickPath<typename L::R> stickPath(const FastBody& b, const L& w,
                                                  const PairBatch<L>& batch) {
  using N = typename L::N;
  const auto a = [&b](const NearPair& p) { return b.features[p.feature].a; };
  const auto z = [&b](const NearPair& p) { return b.features[p.feature].b; };
  return {batch.ofParticles(w.here, a),
          batch.ofParticles(w.here, z),
          batch.ofParticles(w.there, a),
          batch.ofParticles(w.there, z),
          batch.number([&b](const NearPair& p) { return N(b.features[p.feature].radius[0]); }),
          batch.number([&b](const NearPair& p) { return N(b.features[p.feature].radius[1]); })};
}

}  // namespace ragdoll::fast
