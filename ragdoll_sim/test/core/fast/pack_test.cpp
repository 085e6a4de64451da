#include "core/fast/pack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "core/fast/pack_units.h"

namespace ragdoll {
namespace {

using namespace test;

/// Units that this processor runs.
std::vector<const PackUnit*> units() {
  std::vector<const PackUnit*> all{&kSingleUnit, &kNarrowUnit};
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2")) all.push_back(&kMiddleUnit);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
    all.push_back(&kWideUnit);
#endif
  return all;
}

const PackFunctions<double>& functionsOf(const PackUnit& unit, double) { return unit.doubles; }
const PackFunctions<float>& functionsOf(const PackUnit& unit, float) { return unit.floats; }

/// Pairs of all that is special, and of as many at random; a whole number of widest packs.
template <class N>
struct Pairs {
  std::vector<N> a, b;

  Pairs() {
    using Limits = std::numeric_limits<N>;
    const std::vector<N> special = {N(0),
                                    N(-0.0),
                                    N(1),
                                    N(-1.5),
                                    N(0.3),
                                    Limits::max(),
                                    Limits::min(),
                                    -Limits::denorm_min(),
                                    N(1) / N(3),
                                    Limits::infinity(),
                                    -Limits::infinity(),
                                    Limits::quiet_NaN()};
    for (const N x : special)
      for (const N y : special) add(x, y);
    std::mt19937 random(17);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 128 + 16; ++i)
      add(N(normal(random)), N(std::exp(9 * normal(random)) * normal(random)));
  }
  int size() const { return static_cast<int>(a.size()); }

 private:
  void add(N x, N y) {
    a.push_back(x);
    b.push_back(y);
  }
};

/// All results of one unit.
template <class N>
std::vector<N> resultsOf(const PackUnit& unit, const Pairs<N>& pairs) {
  std::vector<N> out(kOperations * pairs.size());
  functionsOf(unit, N()).operate(pairs.a.data(), pairs.b.data(), pairs.size(), out.data());
  return out;
}

/// The same bits, but for which NaN it is.
template <class N>
bool same(N a, N b) {
  return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof(N)) == 0;
}

template <class N>
class PackOf : public testing::Test {};
using NumberTypes = testing::Types<double, float>;
TYPED_TEST_SUITE(PackOf, NumberTypes);

TYPED_TEST(PackOf, GivesTheBitsOfSingleNumbers) {
  const Pairs<TypeParam> pairs;
  ASSERT_EQ(pairs.size() % kMostLanes, 0);
  const std::vector<TypeParam> single = resultsOf(kSingleUnit, pairs);
  for (const PackUnit* unit : units()) {
    const std::vector<TypeParam> out = resultsOf(*unit, pairs);
    for (std::size_t i = 0; i < out.size(); ++i)
      EXPECT_TRUE(same(out[i], single[i]))
          << functionsOf(*unit, TypeParam()).lanes << " lanes, operation " << i % kOperations
          << " of " << pairs.a[i / kOperations] << " and " << pairs.b[i / kOperations];
  }
}

/// What the single numbers' functions are defined as; NaN is neither less nor larger.
TYPED_TEST(PackOf, ChoosesAsItIsDefined) {
  using N = TypeParam;
  const Pairs<N> pairs;
  const std::vector<N> out = resultsOf(kSingleUnit, pairs);
  for (int i = 0; i < pairs.size(); ++i) {
    const N a = pairs.a[i], b = pairs.b[i], number = N(kNumber);
    const N* of = out.data() + kOperations * i;
    EXPECT_TRUE(same(of[kSelected], a < b ? a : b)) << a << ", " << b;
    EXPECT_TRUE(same(of[kBoth], a < b && 0 < b ? a : b)) << a << ", " << b;
    EXPECT_TRUE(same(of[kEither], a < b || 0 < b ? a : b)) << a << ", " << b;
    EXPECT_TRUE(same(of[kLarger], a > b ? a : b)) << a << ", " << b;
    EXPECT_TRUE(same(of[kAtLeast], a < number ? number : a)) << a;
    EXPECT_TRUE(same(of[kSign], a < 0 ? N(-1) : N(1))) << a;
    EXPECT_TRUE(same(of[kRoot], std::sqrt(a))) << a;
    EXPECT_TRUE(same(of[kAdded], a + b) && same(of[kTaken], a - b)) << a << ", " << b;
    EXPECT_TRUE(same(of[kNumberMinus], number - a) && same(of[kOverNumber], a / number)) << a;
  }
}

TYPED_TEST(PackOf, KnowsOfAnyLaneAndOfWhich) {
  for (const PackUnit* unit : units()) {
    const PackFunctions<TypeParam>& pack = functionsOf(*unit, TypeParam());
    bool lanes[kMostLanes] = {};
    EXPECT_EQ(pack.lanes_of(lanes), 0u) << pack.lanes;
    for (int l = 0; l < pack.lanes; ++l) {
      lanes[l] = true;
      EXPECT_EQ(pack.lanes_of(lanes), 1u << l) << pack.lanes;
      lanes[0] = true;
      EXPECT_EQ(pack.lanes_of(lanes), 1u << l | 1u) << pack.lanes;
      lanes[l] = lanes[0] = false;
    }
  }
}

}  // namespace
}  // namespace ragdoll
