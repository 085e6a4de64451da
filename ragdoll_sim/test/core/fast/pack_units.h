// What passes between a test of packs and the units that are compiled for an instruction set.
#pragma once

namespace ragdoll::test {

enum Operation {
  kPlus,
  kMinus,
  kTimes,
  kOver,
  kPlusNumber,
  kNumberMinus,
  kNumberTimes,
  kOverNumber,
  kNegative,
  kAdded,
  kTaken,
  kSelected,
  kBoth,
  kEither,
  kRoot,
  kLarger,
  kAtLeast,
  kSign,
  kOperations
};

constexpr double kNumber = 0.3;  ///< what stands beside packs
constexpr int kMostLanes = 16;

/// Packs of one kind of number.
template <class N>
struct PackFunctions {
  int lanes;
  void (*operate)(const N* a, const N* b, int count, N* out);
  unsigned (*lanes_of)(const bool* lanes);  ///< a bit each
};

struct PackUnit {
  PackFunctions<double> doubles;
  PackFunctions<float> floats;
};

// As core/fast/methods.h.
extern const PackUnit kSingleUnit, kNarrowUnit, kMiddleUnit, kWideUnit;

}  // namespace ragdoll::test
