#include "core/base/growing.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace ragdoll {
namespace {

/// 1, 2, ... (fixed sizes known to the compiler make it warn of memory that is not there)
Eigen::VectorXd counted(int size) { return Eigen::VectorXd::LinSpaced(size, 1, size); }

TEST(Growing, KeepsItsMemoryWhenItShrinks) {
  Growing<Eigen::MatrixXd> m;
  m.setZero(4, 5);
  const double* at = m.data();
  m.resize(2, 3);
  EXPECT_EQ(m.data(), at);
  m.resize(5, 4);
  EXPECT_EQ(m.data(), at);
  EXPECT_EQ(m.rows(), 5);
  EXPECT_EQ(m.cols(), 4);
}

TEST(Growing, IsAMatrixInExpressions) {
  RowValues a, b;
  a = counted(3);
  b = 2 * a + Eigen::VectorXd::Ones(3);
  EXPECT_EQ(b[2], 7);
  EXPECT_EQ(a.dot(b), 3 + 10 + 21);
  a = counted(2);
  EXPECT_EQ(a.size(), 2);
}

TEST(Growing, CopiesOwnTheirValuesAndMovesTakeThem) {
  RowValues a;
  a = counted(2);
  RowValues copy(a);
  a[0] = 5;
  EXPECT_EQ(copy[0], 1);
  const double* at = a.data();
  RowValues moved(std::move(a));
  EXPECT_EQ(moved.data(), at);
  EXPECT_EQ(moved[0], 5);
}

TEST(Growing, HasRoomBeforeItIsUsed) {
  Growing<Eigen::MatrixXd> m;
  m.resize(1, 1);
  const double* at = m.data();
  m.resize(kRoomForRows, kRoomForRows);
  EXPECT_EQ(m.data(), at);
}

TEST(Roomy, HasRoomBeforeItIsUsedAndWhereItIsCopied) {
  Roomy<int> list;
  EXPECT_GE(list.capacity(), std::size_t(kRoomForRows));
  list = std::vector<int>{1, 2};
  Roomy<int> copy(list);
  EXPECT_EQ(copy, list);
  for (Roomy<int>* each : {&list, &copy})
    EXPECT_GE(each->capacity(), std::size_t(kRoomForRows)) << each->size();
}

}  // namespace
}  // namespace ragdoll
