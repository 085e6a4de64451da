// Doubles in SIMD lanes, and functions of them compiled for several instruction sets. Private to
// the core.
#pragma once

/// What a kernel calls has to be part of it.
#define RAGDOLL_INLINE inline __attribute__((always_inline))

namespace ragdoll {

constexpr int kLane = 8;  ///< doubles per row block: the widest vector there is

namespace kernels {

/// W doubles.
template <int W>
struct Vector;
template <>
struct Vector<2> {
  typedef double Lanes __attribute__((vector_size(2 * sizeof(double))));
};
template <>
struct Vector<4> {
  typedef double Lanes __attribute__((vector_size(4 * sizeof(double))));
};
template <>
struct Vector<8> {
  typedef double Lanes __attribute__((vector_size(8 * sizeof(double))));
};

/// The same somewhere in memory, with the alignment of a double.
template <int W>
struct __attribute__((packed, may_alias)) Stored {
  typename Vector<W>::Lanes v;
};

template <int W>
RAGDOLL_INLINE const Stored<W>& lanes(const double* p) {
  return *reinterpret_cast<const Stored<W>*>(p);
}
template <int W>
RAGDOLL_INLINE Stored<W>& lanes(double* p) {
  return *reinterpret_cast<Stored<W>*>(p);
}

}  // namespace kernels
}  // namespace ragdoll

// RAGDOLL_KERNEL(result, name, parameters, arguments): a function that is body::name<W>, a template
// to be inlined, for vectors of W doubles. As wide as the processor has them, found at load: wider
// ones go through memory, at three times the cost, and narrower ones take more instructions.
#if defined(__x86_64__) && defined(__GNUC__)
namespace ragdoll::kernels {
inline const int kWidth = __builtin_cpu_supports("avx512f") ? 8
                          : __builtin_cpu_supports("avx2")  ? 4
                                                            : 2;
}
#define RAGDOLL_KERNEL(result, name, parameters, arguments)          \
  namespace {                                                        \
  __attribute__((target("avx512f"))) result name##Wide parameters {  \
    return body::name<8> arguments;                                  \
  }                                                                  \
  __attribute__((target("avx2"))) result name##Middle parameters {   \
    return body::name<4> arguments;                                  \
  }                                                                  \
  result name##Narrow parameters { return body::name<2> arguments; } \
  }                                                                  \
  result name parameters {                                           \
    if (kernels::kWidth == 8) return name##Wide arguments;           \
    if (kernels::kWidth == 4) return name##Middle arguments;         \
    return name##Narrow arguments;                                   \
  }
#else
#define RAGDOLL_KERNEL(result, name, parameters, arguments) \
  result name parameters { return body::name<2> arguments; }
#endif
