#include "ragdoll_sim/core/stick_kernels.h"

#include <cmath>

// One body of code, compiled for several instruction sets and chosen at load. Sanitizers run before
// the choice can be made, so they get the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RAGDOLL_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define RAGDOLL_CLONES
#endif

namespace ragdoll::kernels {

RAGDOLL_CLONES
void multiplyPoints(const double* X, const double* rows, int n, int width, double* out) {
  double* __restrict ox = out;
  double* __restrict oy = out + width;
  double* __restrict oz = out + 2 * width;
  for (int k = 0; k < width; ++k) ox[k] = oy[k] = oz[k] = 0;
  for (int j = 0; j < n; ++j) {
    const double x = X[3 * j], y = X[3 * j + 1], z = X[3 * j + 2];
    const double* __restrict r = rows + j * width;
    for (int k = 0; k < width; ++k) {
      ox[k] += x * r[k];
      oy[k] += y * r[k];
      oz[k] += z * r[k];
    }
  }
}

RAGDOLL_CLONES
void gram(const double* G, const double* D, int s, int width, double* S) {
  const double* __restrict dx = D;
  const double* __restrict dy = D + width;
  const double* __restrict dz = D + 2 * width;
  for (int i = 0; i < s; ++i) {
    const double x = dx[i], y = dy[i], z = dz[i];
    const double* __restrict g = G + i * width;
    double* __restrict o = S + i * width;
    for (int k = i / kLane * kLane; k < width; ++k)
      o[k] = g[k] * (x * dx[k] + y * dy[k] + z * dz[k]);
  }
}

RAGDOLL_CLONES
int factor(double* S, double* inverse, int s, int width, double floor) {
  int dependent = 0;
  double diagonal[1];
  for (int k = 0; k < s; ++k) inverse[k] = S[k * width + k];  // the diagonals, before they change
  for (int k = 0; k < s; ++k) {
    const double* __restrict row = S + k * width;
    diagonal[0] = row[k];
    if (!(diagonal[0] > floor * inverse[k])) {
      inverse[k] = 0;
      ++dependent;
      continue;
    }
    inverse[k] = 1 / diagonal[0];
    for (int i = k + 1; i < s; ++i) {
      const double f = row[i] * inverse[k];
      double* __restrict o = S + i * width;
      for (int j = i / kLane * kLane; j < width; ++j) o[j] -= f * row[j];
    }
  }
  for (int i = 1; i < s; ++i)  // mirror, for the backward substitution
    for (int k = 0; k < i; ++k) S[i * width + k] = S[k * width + i];
  return dependent;
}

RAGDOLL_CLONES
void solve(const double* U, const double* inverse, int s, int width, double* b) {
  // Forward: rows of U to the right of the diagonal; backward: rows of L to its left (mirrored by
  // factor). Both subtract a multiple of a row, which has no long chain of sums.
  for (int k = 0; k < s; ++k) {
    const double f = b[k] * inverse[k];
    const double* __restrict row = U + k * width;
    const int from = (k + kLane) / kLane * kLane;
    for (int j = k + 1; j < from; ++j) b[j] -= f * row[j];
    for (int j = from; j < width; ++j) b[j] -= f * row[j];
  }
  for (int k = s - 1; k >= 0; --k) {
    const double x = b[k] * inverse[k];
    const double* __restrict row = U + k * width;
    const int full = k / kLane * kLane;
    for (int j = 0; j < full; ++j) b[j] -= x * row[j];
    for (int j = full; j < k; ++j) b[j] -= x * row[j];
    b[k] = x;
  }
}

RAGDOLL_CLONES
void solveMany(const double* U, const double* inverse, int s, int width, double* b, int columns) {
  for (int k = 0; k < s; ++k)
    for (int i = k + 1; i < s; ++i) {
      const double f = U[k * width + i] * inverse[k];
      const double* __restrict from = b + k * columns;
      double* __restrict to = b + i * columns;
      for (int c = 0; c < columns; ++c) to[c] -= f * from[c];
    }
  for (int k = s - 1; k >= 0; --k) {
    double* __restrict to = b + k * columns;
    for (int i = k + 1; i < s; ++i) {
      const double f = U[k * width + i];
      const double* __restrict from = b + i * columns;
      for (int c = 0; c < columns; ++c) to[c] -= f * from[c];
    }
    for (int c = 0; c < columns; ++c) to[c] *= inverse[k];
  }
}

RAGDOLL_CLONES
void addImpulses(const double* D, const double* lambda, int s, int width, const double* rows,
                 int columns, double* out) {
  double* __restrict ox = out;
  double* __restrict oy = out + columns;
  double* __restrict oz = out + 2 * columns;
  for (int i = 0; i < s; ++i) {
    const double x = lambda[i] * D[i], y = lambda[i] * D[width + i],
                 z = lambda[i] * D[2 * width + i];
    const double* __restrict r = rows + i * columns;
    for (int k = 0; k < columns; ++k) {
      ox[k] += x * r[k];
      oy[k] += y * r[k];
      oz[k] += z * r[k];
    }
  }
}

RAGDOLL_CLONES
void subtractProducts(const double* K, const double* Z, int s, int m, int columns, double* A) {
  for (int i = 0; i < m; ++i) {
    double* __restrict to = A + i * columns;
    for (int k = 0; k < s; ++k) {
      const double f = K[k * columns + i];
      const double* __restrict z = Z + k * columns;
      for (int j = 0; j < columns; ++j) to[j] -= f * z[j];
    }
  }
}

RAGDOLL_CLONES
void addScaled(const double* x, double f, int n, double* y) {
  const double* __restrict from = x;
  double* __restrict to = y;
  for (int j = 0; j < n; ++j) to[j] += f * from[j];
}

RAGDOLL_CLONES
double lengthResiduals(const double* D, const double* length2, int width, double* residual) {
  const double* __restrict dx = D;
  const double* __restrict dy = D + width;
  const double* __restrict dz = D + 2 * width;
  double lanes[kLane] = {};
  for (int j = 0; j < width; j += kLane)
    for (int l = 0; l < kLane; ++l) {
      const int k = j + l;
      const double r = 0.5 * (length2[k] - (dx[k] * dx[k] + dy[k] * dy[k] + dz[k] * dz[k]));
      residual[k] = r;
      const double size = std::abs(r) / (length2[k] + 1e-300);
      lanes[l] = size > lanes[l] || size != size ? size : lanes[l];  // a NaN wins and stays
    }
  double worst = lanes[0];
  for (int l = 1; l < kLane; ++l)
    worst = lanes[l] > worst || lanes[l] != lanes[l] ? lanes[l] : worst;
  return worst;
}

}  // namespace ragdoll::kernels
