// Pieces whose measures are known by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "body/rigid_coat.h"
#include "human_model.h"

namespace ragdoll::test {
namespace {

Vec3 low(const Mesh& mesh) { return mesh.vertices.rowwise().minCoeff(); }
Vec3 high(const Mesh& mesh) { return mesh.vertices.rowwise().maxCoeff(); }
Vec3 size(const Mesh& mesh) { return high(mesh) - low(mesh); }
Vec3 middle(const Mesh& mesh) { return (low(mesh) + high(mesh)) / 2; }

bool isColor(const Rgba& a, const Rgba& b) { return a.r == b.r && a.g == b.g && a.b == b.b; }

/// A flat group a, b, c with the sticks between them, and a bone from c straight up to d.
Skeleton lamp(double radius) {
  Skeleton s;
  s.name = "lamp";
  s.particles = {"a", "b", "c", "d"};
  s.named = 4;
  s.rest.resize(3, 4);
  s.rest << 0, 1, 0, 0, 0, 0, 2, 2, 0, 0, 0, 1.5;
  s.radius = Eigen::VectorXd::Constant(4, radius);
  s.sticks = {{0, 1, 1}, {1, 2, std::sqrt(5)}, {0, 2, 2}, {2, 3, 1.5}};
  s.segments = {segment(s, "foot", {"a", "b", "c"}), segment(s, "post", {"c", "d"})};
  return s;
}

RigidPiece pieceOf(const std::vector<RigidPiece>& pieces, int part) {
  return *std::find_if(pieces.begin(), pieces.end(),
                       [part](const RigidPiece& p) { return p.part == part; });
}

TEST(BoxPieces, HoldAGroupsParticlesAndLieAlongABone) {
  const Skeleton s = lamp(0.1);
  const FrameTree tree = buildFrameTree(s);
  const std::vector<RigidPiece> pieces = boxPieces(s, tree);
  ASSERT_EQ(pieces.size(), 2u);
  const RigidPiece foot = pieceOf(pieces, tree.part("foot"));
  EXPECT_LT((size(foot.mesh) - Vec3(1, 2, 0.2)).norm(), 1e-12);  // as thick as its particles
  EXPECT_LT((middle(foot.mesh) - Vec3(0.5, 1, 0)).norm(), 1e-12);
  EXPECT_TRUE(isColor(foot.color, palette::kGroup));
  const RigidPiece post = pieceOf(pieces, tree.part("post"));
  EXPECT_LT((size(post.mesh) - Vec3(0.17, 0.17, 1.5)).norm(), 1e-12);  // 0.85 of the diameter
  EXPECT_LT((middle(post.mesh) - Vec3(0, 2, 0.75)).norm(), 1e-12);
  EXPECT_TRUE(isColor(post.color, palette::kBone));
}

TEST(BoxPieces, AreFourCentimetresThickWhereParticlesArePoints) {
  const Skeleton s = lamp(0);
  const FrameTree tree = buildFrameTree(s);
  const std::vector<RigidPiece> pieces = boxPieces(s, tree);
  EXPECT_NEAR(size(pieceOf(pieces, tree.part("foot")).mesh).z(), 0.04, 1e-12);
  EXPECT_NEAR(size(pieceOf(pieces, tree.part("post")).mesh).x(), 0.04, 1e-12);
}

TEST(CapsulePieces, AreOneAlongEveryStick) {
  for (const auto& [radius, drawn] : {std::pair{0.1, 0.1}, {0.0, 0.005}}) {
    const Skeleton s = lamp(radius);
    const FrameTree tree = buildFrameTree(s);
    const std::vector<RigidPiece> pieces = capsulePieces(s, tree);
    ASSERT_EQ(pieces.size(), s.sticks.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const bool post = i == 3;
      EXPECT_EQ(pieces[i].part, tree.part(post ? "post" : "foot"));
      EXPECT_TRUE(isColor(pieces[i].color, post ? palette::kBone : palette::kGroup));
      // As far as the balls at its ends, up to the sides of its rings.
      const Vec3 a = s.rest.col(s.sticks[i].a), b = s.rest.col(s.sticks[i].b);
      EXPECT_LT((low(pieces[i].mesh) - a.cwiseMin(b)).cwiseAbs().maxCoeff(), drawn + 1e-12);
      EXPECT_NEAR(high(pieces[i].mesh).maxCoeff(), a.cwiseMax(b).maxCoeff() + drawn, 0.1 * drawn);
    }
  }
}

TEST(HumanPieces, ClotheItWithoutConesAlongItsSticks) {
  const Skeleton s = humanSkeleton();
  const FrameTree tree = buildFrameTree(s);
  std::vector<int> pieces(tree.parts.size(), 0);
  for (const RigidPiece& piece : capsulePieces(s, tree)) {
    ++pieces[piece.part];
    EXPECT_FALSE(isColor(piece.color, palette::kBone) || isColor(piece.color, palette::kGroup));
  }
  for (std::size_t p = 0; p < pieces.size(); ++p) EXPECT_GT(pieces[p], 0) << tree.parts[p].name;
}

TEST(HumanPieces, ScaleWithTheBody) {
  const Skeleton one = humanSkeleton();
  Skeleton two = one;
  two.rest *= 2;
  two.radius *= 2;
  for (Stick& stick : two.sticks) stick.length *= 2;
  const FrameTree tree = buildFrameTree(one), tree_of_two = buildFrameTree(two);
  for (const auto make : {capsulePieces, boxPieces}) {
    const std::vector<RigidPiece> a = make(one, tree), b = make(two, tree_of_two);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].part, b[i].part);
      EXPECT_LT((b[i].mesh.vertices - 2 * a[i].mesh.vertices).cwiseAbs().maxCoeff(), 1e-12) << i;
    }
  }
}

TEST(HumanPieces, HaveBothSidesAlike) {
  const Skeleton s = humanSkeleton();
  const FrameTree tree = buildFrameTree(s);
  for (const auto make : {capsulePieces, boxPieces}) {
    const std::vector<RigidPiece> pieces = make(s, tree);
    double left = 0, right = 0;  // [m^3]
    Vec3 left_most = Vec3::Zero(), right_most = Vec3::Zero();
    for (const RigidPiece& piece : pieces) {
      const double y = middle(piece.mesh).y();
      if (std::abs(y) < 1e-3) continue;  // trunk and head
      (y > 0 ? left : right) += volume(piece.mesh);
      left_most = left_most.cwiseMax(high(piece.mesh));
      right_most = right_most.cwiseMin(low(piece.mesh));
    }
    EXPECT_GT(left, 0.01);
    EXPECT_NEAR(left, right, 1e-9);
    EXPECT_NEAR(left_most.y(), -right_most.y(), 1e-3);  // rings have no corner at the other side
  }
}

}  // namespace
}  // namespace ragdoll::test
