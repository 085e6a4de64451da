#include "core/direct/exact_rows.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll::test {
namespace {

/// A weightless rod of 2 kg along x whose ends touch a floor that has friction; rows as for
/// velocities.
class RodOnAFloor {
 public:
  explicit RodOnAFloor(double friction) : rod_(weightless(oneStick())) {
    Body& body = rod_.body();
    Schur& schur = body.memory->schur;
    schur.start(body.first);
    for (const int end : {0, 1}) {
      Contact floor;
      floor.particle = {end};
      floor.weight = {1};
      floor.count = 1;
      floor.friction = friction;
      schur.addContact(floor, end);
    }
    body.memory->response.assemble(schur, false);
    joint().clear(true);
    joint().addBody(schur);
    p.setZero(joint().size());
    b.setZero(joint().size());
  }

  JointSchur& joint() { return rod_.island.s.joint; }
  bool solve() { return solveExactly(rod_.island, b, p); }
  /// Of row i, with impulses p.
  double rate(int i) {
    double sum = b[i];
    for (int j = 0; j < p.size(); ++j) sum += joint().entry(i, j) * p[j];
    return sum;
  }

  RowValues b, p;

 private:
  DirectIsland rod_;
};

TEST(ExactRows, FindWhatPressesAndWhatSlides) {
  RodOnAFloor rod(0.5);
  rod.b << -1, 2, 0, -1, 2, 3;  // faster than friction can stop
  ASSERT_TRUE(rod.solve());
  for (const int i : {0, 3}) {
    EXPECT_GT(rod.p[i], 0);
    EXPECT_NEAR(rod.rate(i), 0, 1e-12);
    const Eigen::Vector2d pull = rod.p.segment<2>(i + 1), slip(rod.rate(i + 1), rod.rate(i + 2));
    EXPECT_NEAR(pull.norm(), 0.5 * rod.p[i], 1e-12);
    EXPECT_NEAR(pull.dot(slip), -pull.norm() * slip.norm(), 1e-9);
  }
}

TEST(ExactRows, FindWhatSticks) {
  RodOnAFloor rod(0.5);
  for (int i = 0; i < 6; ++i)  // it falls and turns
    rod.b[i] = rod.joint().row(i).direction.dot(Vec3(0, i < 3 ? 0.1 : -0.1, -1));
  ASSERT_TRUE(rod.solve());
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(rod.rate(i), 0, 1e-12) << i;
}

TEST(ExactRows, LeaveWhatIsLockedAsItIs) {
  RodOnAFloor rod(0);
  rod.b << -1, -1;
  rod.joint().lock(1, true);
  rod.p << 0, 0.25;
  ASSERT_TRUE(rod.solve());
  EXPECT_EQ(rod.p[1], 0.25);
  EXPECT_NEAR(rod.rate(0), 0, 1e-12);
}

TEST(ExactRows, SaySoWhereThereIsNothingToSolve) {
  RodOnAFloor rod(0);
  rod.p << 1, 2;
  for (const int i : {0, 1}) rod.joint().lock(i, true);
  EXPECT_FALSE(rod.solve());
  EXPECT_EQ(rod.p[0], 1);
  EXPECT_EQ(rod.p[1], 2);
}

}  // namespace
}  // namespace ragdoll::test
