#include "core/linear/stick_kernels.h"

#include "core/linear/stick_kernels_body.h"

namespace ragdoll::kernels {

RAGDOLL_KERNEL(void, multiplyPoints,
               (const double* X, const double* rows, int n, int width, double* out),
               (X, rows, n, width, out))

RAGDOLL_KERNEL(void, gram, (const double* G, const double* D, int s, int width, double* S),
               (G, D, s, width, S))

RAGDOLL_KERNEL(int, invert, (double* S, int s, int width, double floor, double* work),
               (S, s, width, floor, work))

RAGDOLL_KERNEL(void, multiply, (const double* A, const double* b, int s, int width, double* out),
               (A, b, s, width, out))

RAGDOLL_KERNEL(void, multiplyRows,
               (const double* A, const double* B, int s, int width, int columns, double* out),
               (A, B, s, width, columns, out))

RAGDOLL_KERNEL(void, addImpulses,
               (const double* D, const double* lambda, int s, int width, const double* rows,
                int columns, double* out),
               (D, lambda, s, width, rows, columns, out))

RAGDOLL_KERNEL(void, addRows,
               (const double* D, int s, int width, const double* rows, int columns, double* out),
               (D, s, width, rows, columns, out))

RAGDOLL_KERNEL(void, dotThrees,
               (const double* rows, int columns, int wanted, const int* place, const double* g,
                int count, double* out),
               (rows, columns, wanted, place, g, count, out))

RAGDOLL_KERNEL(void, spreadSticks,
               (const double* D, const double* rows, int s, int width, int columns, double* K),
               (D, rows, s, width, columns, K))

RAGDOLL_KERNEL(void, pullSticks,
               (const double* D, const double* WBT, int width, const int* particle, const double* f,
                int count, double* out),
               (D, WBT, width, particle, f, count, out))

RAGDOLL_KERNEL(void, spreadPushes,
               (const double* rows, int columns, const int* particle, const double* f, int count,
                double* out),
               (rows, columns, particle, f, count, out))

RAGDOLL_KERNEL(void, gatherRows,
               (const double* A, int columns, const int* particle, const double* f, int count,
                double* out),
               (A, columns, particle, f, count, out))

RAGDOLL_KERNEL(void, addWeighted,
               (const double* base, const double* terms, const double* f, int count, int n,
                double* out),
               (base, terms, f, count, n, out))

RAGDOLL_KERNEL(void, subtractDots, (const double* a, const double* b, int width, double* out),
               (a, b, width, out))

RAGDOLL_KERNEL(double, lengthResiduals,
               (const double* D, const double* length2, const double* inverse_length2, int width,
                double* residual),
               (D, length2, inverse_length2, width, residual))

}  // namespace ragdoll::kernels
