#include "core/direct/mode_solve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/direct/mode_systems.h"

namespace ragdoll {
namespace {

using namespace test;

/// Forces at rest of one contact, from nothing.
struct Found {
  bool any;
  ModeBlock block;
  ModeVector p, w;

  Found(const ModeMatrix& A, const ModeVector& b, ModeBlock first) {
    std::vector<ModeBlock> blocks{first};
    p = ModeVector::Zero(b.size());
    any = solveComplementarity(A, b, kG, blocks, p);
    block = blocks[0];
    w = b + A * p;
  }
};

TEST(ModeSolve, ABlockOnASlopeStaysOrSlidesByItsFriction) {
  const double angle = 0.4, mass = 3, steep = std::sin(angle), flat = std::cos(angle);
  const ModeMatrix A = ModeMatrix::Identity(3, 3) / mass;
  const ModeVector b = Vec3(-kG * flat, 0, -kG * steep);  // second tangent: up the slope
  const Found stays(A, b, contactRows(0, 0.5)), slides(A, b, contactRows(0, 0.3));
  ASSERT_TRUE(stays.any && slides.any);
  EXPECT_TRUE(stays.block.sticks);
  EXPECT_LT((stays.p - mass * kG * Vec3(flat, 0, steep)).norm(), 1e-13);
  EXPECT_FALSE(slides.block.sticks);
  EXPECT_LT((slides.w - Vec3(0, 0, -kG * (steep - 0.3 * flat))).norm(), 1e-13);
}

TEST(ModeSolve, ARodTurnsAboutItsEndOrSlips) {
  const LeaningRod rod(0.7);
  const Found turns(rod.A, rod.b, contactRows(0, 1));
  ASSERT_TRUE(turns.any);
  EXPECT_NEAR(turns.p[0], kG * (1 - 0.75 * rod.cosine * rod.cosine), 1e-12);
  EXPECT_NEAR(turns.p[2], kG * 0.75 * rod.sine * rod.cosine, 1e-12);
  const double mu = 0.2;
  const Found slips(rod.A, rod.b, contactRows(0, mu));
  ASSERT_TRUE(slips.any);
  const double press = kG / (1 + 3 * rod.cosine * (rod.cosine - mu * rod.sine));
  EXPECT_NEAR(slips.p[0], press, 1e-12);
  EXPECT_NEAR(slips.p[2], mu * press, 1e-12);
}

/// Painleve's: friction that presses the end of a moving rod harder into the floor than it is held.
TEST(ModeSolve, ARodThatIsPushedIntoItsFrictionHasNoAnswer) {
  const LeaningRod rod(1.1);
  for (const double mu : {1.0, 3.0}) {
    ModeBlock moving = contactRows(0, mu);
    moving.slips = true;
    moving.slip = Eigen::Vector2d(0, -1);
    EXPECT_EQ(Found(rod.A, rod.b, moving).any,
              1 + 3 * rod.cosine * (rod.cosine - mu * rod.sine) > 0)
        << mu;
  }
}

/// A plank of mass 1 and length 1 on two edges, the far one 0.3 to the left of its middle, the near
/// one `near` to the right of it; answers of its moment of inertia, 1/12.
TEST(ModeSolve, APlankTipsOverAnEdgeThatItsMiddleIsBeyond) {
  for (const double near : {0.2, -0.1}) {
    const Eigen::Vector2d place(-0.3, near);
    const ModeMatrix A = ModeMatrix::Ones(2, 2) + 12 * place * place.transpose();
    std::vector<ModeBlock> blocks{contactRows(0, 0), contactRows(1, 0)};
    ModeVector p = ModeVector::Zero(2);
    ASSERT_TRUE(solveComplementarity(A, ModeVector::Constant(2, -kG), kG, blocks, p));
    const bool tips = near < 0;
    const double left = tips ? 0 : kG * near / (near + 0.3);
    EXPECT_EQ(blocks[0].presses, !tips);
    EXPECT_NEAR(p[0], left, 1e-12);
    EXPECT_NEAR(p[1], tips ? kG / (1 + 12 * near * near) : kG - left, 1e-12);
  }
}

/// One of nine contacts of a torso across a plank, as the others let it move, two of which slide:
/// it all but stands still, and no direction in which friction pulls holds it.
TEST(ModeSolve, WhatNoDirectionHoldsSlips) {
  ModeMatrix A(3, 3);
  A << 0.2309353709, -0.02870921352, -0.005279023523,   //
      -0.02870941364, 0.009132580435, 0.0002696597144,  //
      -0.005279009616, 0.0002696534107, 0.0001475412433;
  const ModeVector b = Vec3(-14.48124165, 1.573759654, 0.3467715086);
  const double mu = 0.6;
  std::vector<ModeBlock> blocks{contactRows(0, mu)};
  ModeVector p = ModeVector::Zero(3);
  ASSERT_TRUE(solveComplementarity(A, b, 318.557, blocks, p));
  const ModeVector w = b + A * p;
  EXPECT_NEAR(w[0], 0, 1e-12);
  EXPECT_GT(w.tail<2>().norm(), 1e-5);
  EXPECT_LT((p.tail<2>() + mu * p[0] * w.tail<2>().normalized()).norm(), 1e-6);
}

TEST(ModeSolve, RowsThatAreTheSameShareOrContradictEachOther) {
  ModeBlock presses;
  presses.presses = true;
  std::vector<ModeBlock> blocks{presses, presses};
  blocks[1].row = 1;
  const ModeMatrix A = ModeMatrix::Constant(2, 2, 0.5);
  ModeVector p;
  ASSERT_TRUE(solveEqualities(A, ModeVector::Constant(2, -3), blocks, p));
  EXPECT_NEAR(p[0], 3, 1e-12);
  EXPECT_NEAR(p[1], 3, 1e-12);
  EXPECT_FALSE(solveEqualities(A, Eigen::Vector2d(-3, -2), blocks, p));
}

/// A spring's force is known, and what slides on it has friction of it, or sticks with what holds
/// it.
TEST(ModeSolve, AGivenForceIsNoEquality) {
  const LeaningRod rod(0.7);
  ModeBlock spring = contactRows(0, 0.5);
  spring.presses = spring.given = true;
  spring.force = 6;
  spring.slip = Eigen::Vector2d(0.6, -0.8);
  ModeVector p;
  ASSERT_TRUE(solveEqualities(rod.A, rod.b, {spring}, p));
  EXPECT_LT((p - Vec3(6, -1.8, 2.4)).norm(), 1e-14);
  spring.sticks = true;
  ASSERT_TRUE(solveEqualities(rod.A, rod.b, {spring}, p));
  const double holds = 3 * rod.sine * rod.cosine * 6 / (1 + 3 * rod.sine * rod.sine);
  EXPECT_LT((p - Vec3(6, 0, holds)).norm(), 1e-13);
}

/// Two contacts at random: what is found obeys Newton's third law's signs and Coulomb's law.
TEST(ModeSolve, WhatIsFoundObeysCoulombsLaw) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const double mu = 0.4;
  int found = 0;
  for (int sample = 0; sample < 200; ++sample) {
    const Eigen::MatrixXd root =
        Eigen::MatrixXd::NullaryExpr(6, 12, [&] { return normal(random); });
    const ModeMatrix A = root * root.transpose() / 12;
    const ModeVector b = ModeVector::NullaryExpr(6, [&] { return normal(random); });
    std::vector<ModeBlock> blocks{contactRows(0, mu), contactRows(3, mu)};
    ModeVector p = ModeVector::Zero(6);
    if (!solveComplementarity(A, b, 1, blocks, p)) continue;
    ++found;
    const ModeVector w = b + A * p;
    for (const int i : {0, 3}) {
      const Eigen::Vector2d force = p.segment<2>(i + 1), rate = w.segment<2>(i + 1);
      EXPECT_GE(p[i], -1e-8) << sample;
      EXPECT_GE(w[i], -1e-8) << sample;
      EXPECT_NEAR(p[i] * w[i], 0, 1e-8) << sample;
      EXPECT_LE(force.norm(), mu * p[i] + 1e-8) << sample;
      EXPECT_NEAR(force.dot(rate), -mu * p[i] * rate.norm(), 1e-7) << sample;
    }
  }
  EXPECT_GT(found, 190);
}

TEST(ModeSolve, FeetThatShareALoadPressAsSpringsDo) {
  BlockOnFeet block({-0.3, -0.1, 0.1, 0.3}, {0.5, 0.5, 0.5, 0.5}, 0);
  ModeVector p = ModeVector::Zero(12);
  ASSERT_TRUE(solveComplementarity(block.A, block.b, block.mass * kG, block.blocks, p));
  EXPECT_NEAR(block.normals(p), block.mass * kG, 1e-12);
  // Springs under a stiff block: forces are linear along it, by feet as stiff as their rows.
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(p[3 * i] * block.A(3 * i, 3 * i), p[0] * block.A(0, 0), 1e-9);
}

TEST(ModeSolve, AFootWithoutFrictionEnoughIsHeldByAnother) {
  const double pull = 0.3 * kG;
  BlockOnFeet block({-0.1, 0.1}, {0.1, 1}, pull);
  ModeVector p = ModeVector::Zero(6);
  ASSERT_TRUE(solveComplementarity(block.A, block.b, block.mass * kG, block.blocks, p));
  EXPECT_LT((block.b + block.A * p).norm(), 1e-9);
  EXPECT_NEAR(block.normals(p), block.mass * kG, 1e-12);
  EXPECT_FALSE(block.blocks[0].sticks);
  EXPECT_TRUE(block.blocks[0].impending && block.blocks[1].sticks);
  EXPECT_NEAR(p[1], -0.1 * p[0], 1e-12);
  EXPECT_NEAR(p[1] + p[4], -block.mass * pull, 1e-9);
}

}  // namespace
}  // namespace ragdoll
