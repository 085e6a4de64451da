// The inner loops of the direct methods on padded rows: one body, its sticks in SIMD lanes.
//
// Rows are `width` doubles long, a multiple of kLane, 64-byte aligned, zero beyond the last stick.
// A D is three such rows: x, y, z of the stick vectors. Elementwise and in a fixed order: the
// result has the same bits on every instruction set. LDL^T keeps U = D L^T in the upper rows
// (docs/equations.md#dense-rows).
#pragma once

#include <Eigen/Core>

namespace ragdoll {

constexpr int kLane = 8;  ///< doubles per row block: the widest vector there is

/// Rows of doubles, padded and aligned.
using PaddedRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline int paddedWidth(int n) { return (n + kLane - 1) / kLane * kLane; }

namespace kernels {

/// out (3 rows of width) = X (3 x n, columns) times rows (n rows of width).
void multiplyPoints(const double* X, const double* rows, int n, int width, double* out);

/// S_ij = G_ij (d_i . d_j) for j >= i, s rows of width.
void gram(const double* G, const double* D, int s, int width, double* S);

/// LDL^T in place, U mirrored below the diagonal; inverse: 1 / d. A pivot below floor x its
/// diagonal gets inverse 0: its stick is dependent in this pose and takes no impulse. Returns how
/// many.
int factor(double* S, double* inverse, int s, int width, double floor);

/// b <- S^-1 b for one right-hand side (width).
void solve(const double* U, const double* inverse, int s, int width, double* b);

/// b <- S^-1 b for s rows of `columns` right-hand sides (a multiple of kLane).
void solveMany(const double* U, const double* inverse, int s, int width, double* b, int columns);

/// out (3 rows of columns) += D diag(lambda) rows, rows: s rows of columns.
void addImpulses(const double* D, const double* lambda, int s, int width, const double* rows,
                 int columns, double* out);

/// A (m rows of columns) -= K^T Z, K and Z: s rows of columns.
void subtractProducts(const double* K, const double* Z, int s, int m, int columns, double* A);

/// y += f x, n values (a multiple of kLane).
void addScaled(const double* x, double f, int n, double* y);

/// residual = (length2 - |d|^2) / 2; returns the largest |residual| / length2. length2: width
/// values, those beyond the last stick 0.
double lengthResiduals(const double* D, const double* length2, int width, double* residual);

}  // namespace kernels
}  // namespace ragdoll
