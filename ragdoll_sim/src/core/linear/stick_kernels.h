// The inner loops of the direct methods on padded rows: one body, its sticks in SIMD lanes.
//
// Rows are `width` doubles long, a multiple of kLane, aligned as doubles are, zero beyond the last
// stick. A D is three such rows: x, y, z of the stick vectors. Elementwise and in a fixed order:
// the result has the same bits on every instruction set. Sums stay in registers over a block of
// lanes, and the inverse is explicit: to apply factors takes longer, as each of their rows waits
// for the one before (docs/equations.md#dense-rows).
#pragma once

#include <Eigen/Core>

#include "core/linear/lanes.h"

namespace ragdoll {

/// Rows of doubles, padded and aligned.
using PaddedRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline int paddedWidth(int n) { return (n + kLane - 1) / kLane * kLane; }

namespace kernels {

constexpr int kMaxPushes = 8;  ///< particles that a limit moves, at most

/// out (3 rows of width) = X (3 x n, columns) times rows (n rows of width).
void multiplyPoints(const double* X, const double* rows, int n, int width, double* out);

/// S_ij = G_ij (d_i . d_j), s rows of width.
void gram(const double* G, const double* D, int s, int width, double* S);

/// S <- S^-1 in place for a symmetric positive definite S (s rows of width; one row more, zero, if
/// s is odd), by Gauss-Jordan elimination with pivots in pairs. A stick whose pivot falls below
/// floor x its diagonal depends on those before it in this pose: its row and column become 0, it
/// takes no impulse. work: width values. Returns how many such sticks there are.
int invert(double* S, int s, int width, double floor, double* work);

/// out (width) = A b, A: s symmetric rows of width.
void multiply(const double* A, const double* b, int s, int width, double* out);

/// out (s rows of columns) = A B, A: s symmetric rows of width, B: s rows of columns.
void multiplyRows(const double* A, const double* B, int s, int width, int columns, double* out);

/// out (3 rows of columns) += D diag(lambda) rows, rows: s rows of columns.
void addImpulses(const double* D, const double* lambda, int s, int width, const double* rows,
                 int columns, double* out);

/// out (3 rows of columns) += D rows, D: 3 rows of width, rows: s rows of columns.
void addRows(const double* D, int s, int width, const double* rows, int columns, double* out);

/// out (the first `wanted` of the columns) = the sum over `count` places of g . the three rows that
/// begin at 3 place; g: three values each.
void dotThrees(const double* rows, int columns, int wanted, const int* place, const double* g,
               int count, double* out);

/// K (s rows of columns) = rows (s rows of columns, a value for each coordinate xyzxyz...) times
/// the stick vectors: K_s,3p+c = rows_s,3p+c D_c,s.
void spreadSticks(const double* D, const double* rows, int s, int width, int columns, double* K);

/// out (width) = minus the rates of the sticks for motions of `count` particles that forces on them
/// (three values each) bring: - sum d_s . f_k WBT_k,s; WBT: rows of width.
void pullSticks(const double* D, const double* WBT, int width, const int* particle, const double* f,
                int count, double* out);

/// out (columns, xyzxyz...) = the sum of `count` rows (at most kMaxPushes), a value for each
/// coordinate as above, times the forces f on `particle` (three values each).
void spreadPushes(const double* rows, int columns, const int* particle, const double* f, int count,
                  double* out);

/// out (columns) = the sum of three rows of A for each of `count` particles, times f.
void gatherRows(const double* A, int columns, const int* particle, const double* f, int count,
                double* out);

/// out = base + f_i times the i-th of `count` terms, which lie one after the other; n values each
/// (a multiple of kLane).
void addWeighted(const double* base, const double* terms, const double* f, int count, int n,
                 double* out);

/// out (width) -= a . b, column by column of two times three rows.
void subtractDots(const double* a, const double* b, int width, double* out);

/// residual = (length2 - |d|^2) / 2; returns the largest |residual| / length2, NaN if there is one.
/// length2 and its inverses: width values, those beyond the last stick 0.
double lengthResiduals(const double* D, const double* length2, const double* inverse_length2,
                       int width, double* residual);

}  // namespace kernels
}  // namespace ragdoll
