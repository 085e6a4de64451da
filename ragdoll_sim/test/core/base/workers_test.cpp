#include "core/base/workers.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Workers, DoEachPartOnce) {
  Workers workers;
  std::vector<int> done(1000, 0);
  std::vector<int> busy(3, 0);
  workers.run(3, 1000, [&](int part, int worker) {
    ++done[part];
    ++busy[worker];
  });
  EXPECT_EQ(done, std::vector<int>(1000, 1));
  EXPECT_EQ(busy[0] + busy[1] + busy[2], 1000);
  EXPECT_GE(Workers::count(0), 1);
  EXPECT_EQ(Workers::count(5), 5);
}

}  // namespace
}  // namespace ragdoll
