#include "core/linear/equal_springs.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace ragdoll {
namespace {

/// A square plate of unit inertia on its four corners, the first of which slides: a push up on two
/// opposite corners and down on the others does nothing.
struct Plate {
  std::vector<SchurBlock> blocks;
  Eigen::MatrixXd A;
  EqualSprings springs;

  Plate() {
    Eigen::MatrixXd J(12, 3);  // shift, two turns; friction moves nothing here
    J.setZero();
    const double x[] = {1, -1, -1, 1}, y[] = {1, 1, -1, -1};
    for (int k = 0; k < 4; ++k) {
      J.row(3 * k) << 1, y[k], -x[k];
      SchurBlock block;
      block.row = 3 * k;
      block.has_tangents = true;
      block.friction = 0.5;
      block.own[0] = 3;
      block.own[1] = block.own[2] = 1;
      block.answer = 1.0 / 3;
      block.tangent_answer = 1;
      blocks.push_back(block);
    }
    A = J * J.transpose();
    for (int k = 0; k < 4; ++k)  // each alone along the ground
      A(3 * k + 1, 3 * k + 1) = A(3 * k + 2, 3 * k + 2) = 1;
  }
  /// p <- shared; returns the largest change. idle: corners that touch without load.
  double share(Eigen::VectorXd& p, const std::vector<int>& idle = {}) {
    return springs.share(
        blocks, idle, [this](int i, int j) { return A(i, j); }, false, p.data());
  }
  static Eigen::VectorXd normals(double a, double b, double c, double d) {
    Eigen::VectorXd p = Eigen::VectorXd::Zero(12);
    p[0] = a, p[3] = b, p[6] = c, p[9] = d;
    return p;
  }
};

TEST(EqualSprings, TakeOutWhatDoesNothing) {
  Plate plate;
  Eigen::VectorXd p = Plate::normals(3, 1, 2, 2);
  p[1] = 0.9;  // slides
  p[2] = -1.2;
  p[4] = 0.3;  // sticks
  const Eigen::VectorXd before = plate.A * p;
  EXPECT_NEAR(plate.share(p), 0.5 * 0.5 / 2.5, 1e-12);  // friction times what its normal changes by
  EXPECT_TRUE(p.isApprox(
      (Eigen::VectorXd(12) << 2.5, 0.75, -1, 1.5, 0.3, 0, 1.5, 0, 0, 2.5, 0, 0).finished(), 1e-12))
      << p.transpose();
  const Eigen::VectorXd after = plate.A * p;
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(after[3 * k], before[3 * k], 1e-12);
}

TEST(EqualSprings, TellWhatFrictionIsBeyondItsCone) {
  Plate plate;
  plate.blocks[0].friction = 0.1;
  Eigen::VectorXd p = Plate::normals(1, 2, 2, 3);
  p[1] = 0.1;   // slides
  p[4] = 0.99;  // sticks where 1 holds it, and where 0.75 does from now on
  EXPECT_NEAR(plate.share(p), (0.99 - 0.75) / 2.5, 1e-12);
  EXPECT_NEAR(p[3], 1.5, 1e-12);
}

TEST(EqualSprings, PullNothing) {
  Plate plate;
  Eigen::VectorXd p = Plate::normals(4, 1, 0.01, 1);
  p[1] = 2;
  plate.share(p);
  EXPECT_TRUE(
      Plate::normals(3.99, 1.01, 0, 1.01)
          .isApprox(
              (Eigen::VectorXd(12) << p[0], 0, 0, p[3], 0, 0, p[6], 0, 0, p[9], 0, 0).finished(),
              1e-12))
      << p.transpose();
}

TEST(EqualSprings, GiveLoadToWhatTouches) {
  Plate plate;
  Eigen::VectorXd p = Plate::normals(2, 1, 2, 0);
  p[1] = 1;  // slides
  Eigen::VectorXd alone = p;
  EXPECT_GT(plate.share(p, {9}), 0.1);
  EXPECT_NEAR(p[0], 1.25, 1e-12);
  EXPECT_NEAR(p[3], 1.75, 1e-12);
  EXPECT_NEAR(p[9], 0.75, 1e-12);
  EXPECT_EQ(plate.share(alone), 0);  // of three corners each holds what it holds
  EXPECT_EQ(alone[9], 0);
  // What would pull lets go at once.
  Eigen::VectorXd middle = Plate::normals(1, 2, 1, 0);
  middle[1] = 0.5;
  plate.share(middle, {9});
  EXPECT_NEAR(middle[0], 1, 1e-12);
  EXPECT_EQ(middle[9], 0);
}

TEST(EqualSprings, LeaveAloneWhatIsTold) {
  Plate plate;
  plate.blocks.pop_back();  // three corners
  Eigen::VectorXd p = Plate::normals(3, 1, 2, 0);
  p[1] = 1.5;
  const Eigen::VectorXd before = p;
  EXPECT_EQ(plate.share(p), 0);
  EXPECT_EQ(p, before);
}

/// What sticks moves alike however it shares.
TEST(EqualSprings, AreForWhatSlides) {
  Plate plate;
  Eigen::VectorXd p = Plate::normals(3, 1, 2, 2);
  const Eigen::VectorXd before = p;
  EXPECT_EQ(plate.share(p), 0);
  EXPECT_EQ(p, before);
}

}  // namespace
}  // namespace ragdoll
