#include "ragdoll_sim/core/stick_kernels.h"

// One body of code, compiled for several instruction sets and chosen at load. Sanitizers run before
// the choice can be made, so they get the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RAGDOLL_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define RAGDOLL_CLONES
#endif

namespace ragdoll::kernels {
namespace {

/// kLane doubles that need no alignment; compilers lower it to what the instruction set has.
typedef double Lanes __attribute__((vector_size(8 * sizeof(double)), aligned(8), may_alias));
static_assert(sizeof(Lanes) == kLane * sizeof(double), "a block of lanes is one vector");

inline const Lanes& lanes(const double* p) { return *reinterpret_cast<const Lanes*>(p); }
inline Lanes& lanes(double* p) { return *reinterpret_cast<Lanes*>(p); }

/// Inverse of [[a, b], [b, d]]; a pivot below its floor is left out, its row and column become 0.
struct PivotPair {
  double aa = 0, ab = 0, bb = 0;
  int dependent = 0;

  PivotPair(double a, double b, double d, double floor_a, double floor_d) {
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

}  // namespace

RAGDOLL_CLONES
void multiplyPoints(const double* X, const double* rows, int n, int width, double* out) {
  for (int b = 0; b < width; b += kLane) {
    Lanes x{}, y{}, z{};
    const double* r = rows + b;
    for (int j = 0; j < n; ++j, r += width) {
      x += X[3 * j] * lanes(r);
      y += X[3 * j + 1] * lanes(r);
      z += X[3 * j + 2] * lanes(r);
    }
    lanes(out + b) = x;
    lanes(out + width + b) = y;
    lanes(out + 2 * width + b) = z;
  }
}

RAGDOLL_CLONES
void gram(const double* G, const double* D, int s, int width, double* S) {
  for (int b = 0; b < width; b += kLane) {
    const Lanes x = lanes(D + b), y = lanes(D + width + b), z = lanes(D + 2 * width + b);
    for (int i = 0; i < s; ++i)
      lanes(S + i * width + b) =
          lanes(G + i * width + b) * (D[i] * x + D[width + i] * y + D[2 * width + i] * z);
  }
}

RAGDOLL_CLONES
int invert(double* S, int s, int width, double floor, double* work) {
  double *f = work, *g = work + width, *floors = work + 2 * width;
  int dependent = 0;
  for (int k = 0; k < s; ++k) floors[k] = floor * S[k * width + k];
  for (int k = 0; k < s; k += 2) {
    double *first = S + k * width, *second = first + width;
    const bool pair = k + 1 < s;  // else the second is the row of zeros
    const PivotPair inverse(first[k], first[k + 1], second[k + 1], floors[k],
                            pair ? floors[k + 1] : 0);
    dependent += inverse.dependent - !pair;
    for (int i = 0; i < s; ++i) {
      f[i] = S[i * width + k];
      g[i] = S[i * width + k + 1];
      S[i * width + k] = S[i * width + k + 1] = 0;
    }
    first[k] = second[k + 1] = 1;
    first[k + 1] = second[k] = 0;
    for (int b = 0; b < width; b += kLane) {
      const Lanes u = lanes(first + b), v = lanes(second + b);
      const Lanes x = inverse.aa * u + inverse.ab * v, y = inverse.ab * u + inverse.bb * v;
      lanes(first + b) = x;
      lanes(second + b) = y;
      for (int i = 0; i < k; ++i)
        lanes(S + i * width + b) = lanes(S + i * width + b) - f[i] * x - g[i] * y;
      for (int i = k + 2; i < s; ++i)
        lanes(S + i * width + b) = lanes(S + i * width + b) - f[i] * x - g[i] * y;
    }
  }
  return dependent;
}

RAGDOLL_CLONES
void multiply(const double* A, const double* b, int s, int width, double* out) {
  for (int c = 0; c < width; c += kLane) {
    Lanes sum{};
    for (int i = 0; i < s; ++i) sum += b[i] * lanes(A + i * width + c);
    lanes(out + c) = sum;
  }
}

RAGDOLL_CLONES
void multiplyRows(const double* A, const double* B, int s, int width, int columns, double* out) {
  for (int i = 0; i < s; ++i)
    for (int c = 0; c < columns; c += kLane) {
      Lanes sum{};
      for (int k = 0; k < s; ++k) sum += A[i * width + k] * lanes(B + k * columns + c);
      lanes(out + i * columns + c) = sum;
    }
}

RAGDOLL_CLONES
void addImpulses(const double* D, const double* lambda, int s, int width, const double* rows,
                 int columns, double* out) {
  for (int b = 0; b < columns; b += kLane) {
    Lanes x = lanes(out + b), y = lanes(out + columns + b), z = lanes(out + 2 * columns + b);
    const double* r = rows + b;
    for (int i = 0; i < s; ++i, r += columns) {
      const Lanes pull = lambda[i] * lanes(r);
      x += D[i] * pull;
      y += D[width + i] * pull;
      z += D[2 * width + i] * pull;
    }
    lanes(out + b) = x;
    lanes(out + columns + b) = y;
    lanes(out + 2 * columns + b) = z;
  }
}

RAGDOLL_CLONES
void subtractProducts(const double* K, const double* Z, int s, int m, int columns, double* A) {
  for (int i = 0; i < m; ++i)
    for (int c = i / kLane * kLane; c < columns; c += kLane) {
      Lanes sum = lanes(A + i * columns + c);
      for (int k = 0; k < s; ++k) sum -= K[k * columns + i] * lanes(Z + k * columns + c);
      lanes(A + i * columns + c) = sum;
    }
}

RAGDOLL_CLONES
void addScaled(const double* x, double f, int n, double* y) {
  const double* __restrict from = x;
  double* __restrict to = y;
  for (int j = 0; j < n; ++j) to[j] += f * from[j];
}

RAGDOLL_CLONES
double lengthResiduals(const double* D, const double* length2, const double* inverse_length2,
                       int width, double* residual) {
  Lanes worst{}, sum{};
  for (int b = 0; b < width; b += kLane) {
    const Lanes x = lanes(D + b), y = lanes(D + width + b), z = lanes(D + 2 * width + b);
    const Lanes r = 0.5 * (lanes(length2 + b) - (x * x + y * y + z * z));
    lanes(residual + b) = r;
    const Lanes share = r * lanes(inverse_length2 + b);
    const Lanes size = share < 0 ? -share : share;
    worst = size > worst ? size : worst;
    sum += size;  // keeps a NaN, which no comparison does
  }
  double largest = 0, total = 0;
  for (int l = 0; l < kLane; ++l) {
    largest = worst[l] > largest ? worst[l] : largest;
    total += sum[l];
  }
  return total == total ? largest : total;
}

}  // namespace ragdoll::kernels
