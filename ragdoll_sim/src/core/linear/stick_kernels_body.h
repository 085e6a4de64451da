// What stick_kernels.h declares, for vectors of W doubles: compiled once for each instruction set
// (stick_kernels.cpp). Every lane does the same whatever W is, so that the bits are the same.
#pragma once

#include <type_traits>

#include "core/linear/stick_kernels.h"

namespace ragdoll::kernels::body {

/// Lanes that registers hold at once.
template <int W>
constexpr int kChunk = (W < kLane ? 2 : 4) * W;

/// act(count, b) for the chunk of `width` lanes that begins at b: count vectors, a constant.
template <int W, class Act>
RAGDOLL_INLINE void onChunk(int width, int b, const Act& act) {
  const int left = (width - b + W - 1) / W;
  if (left == 1) return act(std::integral_constant<int, 1>(), b);
  if (left == 2 || W < kLane) return act(std::integral_constant<int, 2>(), b);
  if (left == 3) return act(std::integral_constant<int, 3>(), b);
  return act(std::integral_constant<int, 4>(), b);
}

/// The same for all of them: what a row brings along is loaded once for a chunk.
template <int W, class Act>
RAGDOLL_INLINE void onChunks(int width, const Act& act) {
  for (int b = 0; b < width; b += kChunk<W>) onChunk<W>(width, b, act);
}

template <int W>
RAGDOLL_INLINE void multiplyPoints(const double* X, const double* rows, int n, int width,
                                   double* out) {
  onChunks<W>(
      width, [&](auto count, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(count)::value;
        typename Vector<W>::Lanes x[blocks] = {}, y[blocks] = {}, z[blocks] = {};
        for (int j = 0; j < n; ++j)
          for (int c = 0; c < blocks; ++c) {
            const typename Vector<W>::Lanes r = lanes<W>(rows + j * width + b + c * W).v;
            x[c] += X[3 * j] * r;
            y[c] += X[3 * j + 1] * r;
            z[c] += X[3 * j + 2] * r;
          }
        for (int c = 0; c < blocks; ++c) {
          lanes<W>(out + b + c * W).v = x[c];
          lanes<W>(out + width + b + c * W).v = y[c];
          lanes<W>(out + 2 * width + b + c * W).v = z[c];
        }
      });
}

template <int W>
RAGDOLL_INLINE void gram(const double* G, const double* D, int s, int width, double* S) {
  onChunks<W>(
      width, [&](auto count, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(count)::value;
        typename Vector<W>::Lanes x[blocks], y[blocks], z[blocks];
        for (int c = 0; c < blocks; ++c) {
          x[c] = lanes<W>(D + b + c * W).v;
          y[c] = lanes<W>(D + width + b + c * W).v;
          z[c] = lanes<W>(D + 2 * width + b + c * W).v;
        }
        for (int i = 0; i < s; ++i)
          for (int c = 0; c < blocks; ++c)
            lanes<W>(S + i * width + b + c * W).v =
                lanes<W>(G + i * width + b + c * W).v *
                (D[i] * x[c] + D[width + i] * y[c] + D[2 * width + i] * z[c]);
      });
}

/// Inverse of [[a, b], [b, d]]; a pivot below its floor is left out, its row and column become 0.
struct PivotPair {
  double aa = 0, ab = 0, bb = 0;
  int dependent = 0;

  RAGDOLL_INLINE PivotPair(double a, double b, double d, double floor_a, double floor_d) {
    const bool first = a > floor_a;
    const double rest = first ? d - b * b / a : d;
    const bool second = rest > floor_d;
    dependent = !first + !second;
    if (first && second) {
      const double f = 1 / (a * rest);
      aa = d * f, ab = -b * f, bb = a * f;
    } else if (first) {
      aa = 1 / a;
    } else if (second) {
      bb = 1 / d;
    }
  }
};

// Loaded from kLane - l on, a vector is 1 in lane l; is 0 in lanes l and l + 1 and else 1.
constexpr double kUnit[2 * kLane] = {0, 0, 0, 0, 0, 0, 0, 0, 1};
constexpr double kOthers[2 * kLane] = {1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1};

/// Eliminates the pivots k, k + 1 from `blocks` vectors of every row, from lane b on. Row by row,
/// so that a row's factors are loaded once; the rows of the next pivots first, so that these are
/// known while the others are still under way.
template <int W, int blocks>
RAGDOLL_INLINE void eliminate(double* S, int s, int width, int k, int b, const PivotPair& pivots) {
  using Lanes = typename Vector<W>::Lanes;
  const int lane = k % W, own = k >= b ? (k - b) / W : blocks;
  double *first = S + k * width, *second = first + width;
  const Lanes others = lanes<W>(kOthers + kLane - lane).v;
  Lanes x[blocks], y[blocks];
  for (int c = 0; c < blocks; ++c) {
    Lanes u = lanes<W>(first + b + c * W).v, v = lanes<W>(second + b + c * W).v;
    if (c == own) {
      u = u * others + lanes<W>(kUnit + kLane - lane).v;
      v = v * others + lanes<W>(kUnit + kLane - 1 - lane).v;
    }
    x[c] = pivots.aa * u + pivots.ab * v;
    y[c] = pivots.ab * u + pivots.bb * v;
  }
  const auto subtract = [&](double* row) __attribute__((always_inline)) {
    const double f = row[k], g = row[k + 1];
    for (int c = 0; c < blocks; ++c) {
      Lanes r = lanes<W>(row + b + c * W).v;
      if (c == own) r *= others;
      lanes<W>(row + b + c * W).v = r - f * x[c] - g * y[c];
    }
  };
  for (double* row = second + width; row < S + s * width; row += width) subtract(row);
  for (double* row = S; row < first; row += width) subtract(row);
  for (int c = 0; c < blocks; ++c) {
    lanes<W>(first + b + c * W).v = x[c];
    lanes<W>(second + b + c * W).v = y[c];
  }
}

template <int W>
RAGDOLL_INLINE int invert(double* S, int s, int width, double floor, double* floors) {
  const int chunks = (s + kChunk<W> - 1) / kChunk<W>;
  int dependent = 0;
  for (int k = 0; k < s; ++k) floors[k] = floor * S[k * width + k];
  for (int k = 0; k < s; k += 2) {
    const double *first = S + k * width, *second = first + width;
    const bool pair = k + 1 < s;  // else the second is the row of zeros
    const PivotPair pivots(first[k], first[k + 1], second[k + 1], floors[k],
                           pair ? floors[k + 1] : 0);
    dependent += pivots.dependent - !pair;
    // The chunk of k, k + 1 comes last, as it holds the factors for the others.
    for (int c = 1; c <= chunks; ++c)
      onChunk<W>(
          s, (k / kChunk<W> + c) % chunks * kChunk<W>,
          [&](auto count, int b) __attribute__((always_inline)) {
            eliminate<W, decltype(count)::value>(S, s, width, k, b, pivots);
          });
  }
  return dependent;
}

/// out (width) = sum of b_i times the i-th of the rows.
template <int W>
RAGDOLL_INLINE void combineRows(const double* rows, const double* b, int s, int width,
                                double* out) {
  onChunks<W>(
      width, [&](auto count, int from) __attribute__((always_inline)) {
        constexpr int blocks = decltype(count)::value;
        typename Vector<W>::Lanes sum[blocks] = {};
        for (int i = 0; i < s; ++i)
          for (int c = 0; c < blocks; ++c)
            sum[c] += b[i] * lanes<W>(rows + i * width + from + c * W).v;
        for (int c = 0; c < blocks; ++c) lanes<W>(out + from + c * W).v = sum[c];
      });
}

template <int W>
RAGDOLL_INLINE void multiply(const double* A, const double* b, int s, int width, double* out) {
  combineRows<W>(A, b, s, width, out);
}

template <int W>
RAGDOLL_INLINE void multiplyRows(const double* A, const double* B, int s, int width, int columns,
                                 double* out) {
  for (int i = 0; i < s; ++i) combineRows<W>(B, A + i * width, s, columns, out + i * columns);
}

template <int W>
RAGDOLL_INLINE void addImpulses(const double* D, const double* lambda, int s, int width,
                                const double* rows, int columns, double* out) {
  onChunks<W>(
      columns, [&](auto count, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(count)::value;
        typename Vector<W>::Lanes x[blocks], y[blocks], z[blocks];
        for (int c = 0; c < blocks; ++c) {
          x[c] = lanes<W>(out + b + c * W).v;
          y[c] = lanes<W>(out + columns + b + c * W).v;
          z[c] = lanes<W>(out + 2 * columns + b + c * W).v;
        }
        for (int i = 0; i < s; ++i)
          for (int c = 0; c < blocks; ++c) {
            const typename Vector<W>::Lanes pull =
                lambda[i] * lanes<W>(rows + i * columns + b + c * W).v;
            x[c] += D[i] * pull;
            y[c] += D[width + i] * pull;
            z[c] += D[2 * width + i] * pull;
          }
        for (int c = 0; c < blocks; ++c) {
          lanes<W>(out + b + c * W).v = x[c];
          lanes<W>(out + columns + b + c * W).v = y[c];
          lanes<W>(out + 2 * columns + b + c * W).v = z[c];
        }
      });
}

template <int W>
RAGDOLL_INLINE void addRows(const double* D, int s, int width, const double* rows, int columns,
                            double* out) {
  onChunks<W>(
      columns, [&](auto count, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(count)::value;
        typename Vector<W>::Lanes x[blocks], y[blocks], z[blocks];
        for (int c = 0; c < blocks; ++c) {
          x[c] = lanes<W>(out + b + c * W).v;
          y[c] = lanes<W>(out + columns + b + c * W).v;
          z[c] = lanes<W>(out + 2 * columns + b + c * W).v;
        }
        for (int i = 0; i < s; ++i)
          for (int c = 0; c < blocks; ++c) {
            const typename Vector<W>::Lanes row = lanes<W>(rows + i * columns + b + c * W).v;
            x[c] += D[i] * row;
            y[c] += D[width + i] * row;
            z[c] += D[2 * width + i] * row;
          }
        for (int c = 0; c < blocks; ++c) {
          lanes<W>(out + b + c * W).v = x[c];
          lanes<W>(out + columns + b + c * W).v = y[c];
          lanes<W>(out + 2 * columns + b + c * W).v = z[c];
        }
      });
}

template <int W>
RAGDOLL_INLINE void dotThrees(const double* rows, int columns, int wanted, const int* place,
                              const double* g, int count, double* out) {
  onChunks<W>(
      wanted, [&](auto vectors, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(vectors)::value;
        typename Vector<W>::Lanes sum[blocks] = {};
        for (int k = 0; k < count; ++k) {
          const double* x = rows + 3 * place[k] * columns + b;
          for (int c = 0; c < blocks; ++c)
            sum[c] += g[3 * k] * lanes<W>(x + c * W).v +
                      g[3 * k + 1] * lanes<W>(x + columns + c * W).v +
                      g[3 * k + 2] * lanes<W>(x + 2 * columns + c * W).v;
        }
        for (int c = 0; c < blocks; ++c) lanes<W>(out + b + c * W).v = sum[c];
      });
}

// Loaded from c on, a vector is all ones where a coordinate xyzxyz... is the one c before x.
constexpr long long kEveryThird[3 * kLane + 2] = {-1, 0, 0,  -1, 0, 0,  -1, 0, 0,  -1, 0, 0,  -1,
                                                  0,  0, -1, 0,  0, -1, 0,  0, -1, 0,  0, -1, 0};

/// x, y, z, x, y, z, ... in three vectors, after which it begins anew.
template <int W>
struct Coordinates {
  using Lanes = typename Vector<W>::Lanes;
  Lanes of[3];

  RAGDOLL_INLINE Coordinates() {}
  RAGDOLL_INLINE Coordinates(double x, double y, double z) {
    const Lanes all_x = x - Lanes{}, all_y = y - Lanes{}, all_z = z - Lanes{};
    for (int k = 0; k < 3; ++k) of[k] = where(k * W).v ? all_x : where(k * W + 2).v ? all_y : all_z;
  }

 private:
  typedef long long Mask __attribute__((vector_size(W * sizeof(double))));
  struct __attribute__((packed, may_alias)) StoredMask {
    Mask v;
  };
  static RAGDOLL_INLINE const StoredMask& where(int c) {
    return *reinterpret_cast<const StoredMask*>(kEveryThird + c);
  }
};

/// act(count, b) for three vectors of `columns` lanes after the other: count of them, a constant.
template <int W, class Act>
RAGDOLL_INLINE void onThrees(int columns, const Act& act) {
  int b = 0;
  for (; b + 3 * W <= columns; b += 3 * W) act(std::integral_constant<int, 3>(), b);
  const int left = (columns - b) / W;
  if (left == 1) act(std::integral_constant<int, 1>(), b);
  if (left == 2) act(std::integral_constant<int, 2>(), b);
}

template <int W>
RAGDOLL_INLINE void spreadSticks(const double* D, const double* rows, int s, int width, int columns,
                                 double* K) {
  for (int i = 0; i < s; ++i) {
    const Coordinates<W> d(D[i], D[width + i], D[2 * width + i]);
    onThrees<W>(
        columns, [&](auto count, int b) __attribute__((always_inline)) {
          for (int k = 0; k < decltype(count)::value; ++k) {
            const int at = i * columns + b + k * W;
            lanes<W>(K + at).v = lanes<W>(rows + at).v * d.of[k];
          }
        });
  }
}

template <int W>
RAGDOLL_INLINE void spreadPushes(const double* rows, int columns, const int* particle,
                                 const double* f, int count, double* out) {
  Coordinates<W> push[kMaxPushes];
  for (int i = 0; i < count; ++i) push[i] = Coordinates<W>(f[3 * i], f[3 * i + 1], f[3 * i + 2]);
  onThrees<W>(
      columns, [&](auto vectors, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(vectors)::value;
        typename Vector<W>::Lanes sum[blocks] = {};
        for (int i = 0; i < count; ++i)
          for (int k = 0; k < blocks; ++k)
            sum[k] += lanes<W>(rows + particle[i] * columns + b + k * W).v * push[i].of[k];
        for (int k = 0; k < blocks; ++k) lanes<W>(out + b + k * W).v = sum[k];
      });
}

template <int W>
RAGDOLL_INLINE void pullSticks(const double* D, const double* WBT, int width, const int* particle,
                               const double* f, int count, double* out) {
  for (int b = 0; b < width; b += W) {
    typename Vector<W>::Lanes sum = {};
    for (int k = 0; k < count; ++k)
      sum -= lanes<W>(WBT + particle[k] * width + b).v *
             (f[3 * k] * lanes<W>(D + b).v + f[3 * k + 1] * lanes<W>(D + width + b).v +
              f[3 * k + 2] * lanes<W>(D + 2 * width + b).v);
    lanes<W>(out + b).v = sum;
  }
}

template <int W>
RAGDOLL_INLINE void gatherRows(const double* A, int columns, const int* particle, const double* f,
                               int particles, double* out) {
  onChunks<W>(
      columns, [&](auto count, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(count)::value;
        typename Vector<W>::Lanes sum[blocks] = {};
        for (int k = 0; k < 3 * particles; ++k)
          for (int c = 0; c < blocks; ++c)
            sum[c] += f[k] * lanes<W>(A + (3 * particle[k / 3] + k % 3) * columns + b + c * W).v;
        for (int c = 0; c < blocks; ++c) lanes<W>(out + b + c * W).v = sum[c];
      });
}

template <int W>
RAGDOLL_INLINE void addWeighted(const double* base, const double* terms, const double* f, int count,
                                int n, double* out) {
  onChunks<W>(
      n, [&](auto vectors, int b) __attribute__((always_inline)) {
        constexpr int blocks = decltype(vectors)::value;
        typename Vector<W>::Lanes sum[blocks];
        for (int c = 0; c < blocks; ++c) sum[c] = lanes<W>(base + b + c * W).v;
        for (int i = 0; i < count; ++i)
          for (int c = 0; c < blocks; ++c) sum[c] += f[i] * lanes<W>(terms + i * n + b + c * W).v;
        for (int c = 0; c < blocks; ++c) lanes<W>(out + b + c * W).v = sum[c];
      });
}

template <int W>
RAGDOLL_INLINE void subtractDots(const double* a, const double* b, int width, double* out) {
  for (int c = 0; c < width; c += W)
    lanes<W>(out + c).v -= lanes<W>(a + c).v * lanes<W>(b + c).v +
                           lanes<W>(a + width + c).v * lanes<W>(b + width + c).v +
                           lanes<W>(a + 2 * width + c).v * lanes<W>(b + 2 * width + c).v;
}

template <int W>
RAGDOLL_INLINE double lengthResiduals(const double* D, const double* length2,
                                      const double* inverse_length2, int width, double* residual) {
  using Lanes = typename Vector<W>::Lanes;
  Lanes worst{}, sum{};
  for (int b = 0; b < width; b += W) {
    const Lanes x = lanes<W>(D + b).v, y = lanes<W>(D + width + b).v,
                z = lanes<W>(D + 2 * width + b).v;
    const Lanes r = 0.5 * (lanes<W>(length2 + b).v - (x * x + y * y + z * z));
    lanes<W>(residual + b).v = r;
    const Lanes share = r * lanes<W>(inverse_length2 + b).v;
    const Lanes size = share < 0 ? -share : share;
    worst = size > worst ? size : worst;
    sum += size;  // keeps a NaN, which no comparison does
  }
  double largest = 0, total = 0;
  for (int l = 0; l < W; ++l) {
    largest = worst[l] > largest ? worst[l] : largest;
    total += sum[l];
  }
  return total == total ? largest : total;
}

}  // namespace ragdoll::kernels::body
