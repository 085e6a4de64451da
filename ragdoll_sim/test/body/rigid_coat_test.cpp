// Pieces on one bone and one group, moved by hand.
#include "body/rigid_coat.h"

#include <gtest/gtest.h>

#include "human_model.h"

namespace ragdoll::test {
namespace {

/// A bone 0 - 1 of 1 m along x, and a group 1 - 2 - 3 at its end.
struct Flag {
  Skeleton skeleton;
  FrameTree tree;

  Flag() {
    skeleton.rest.resize(3, 4);
    skeleton.rest << 0, 1, 2, 1, 0, 0, 0, 3, 0, 0, 0, 0;
    tree.parts.resize(2);
    tree.parts[0].particles = {0, 1};
    tree.parts[0].rest_direction = Vec3::UnitX();
    tree.parts[1].particles = {1, 2, 3};
    tree.parts[1].group = true;
  }
};

RigidPiece cube(int part, const Rgba& color) {
  RigidPiece piece;
  append(box(Vec3(0.2, 0.4, 0.6)), {Vec3(0.5, 0, 0), Quat::Identity()}, piece.mesh);
  piece.part = part;
  piece.color = color;
  return piece;
}

TEST(RigidCoat, BonePiecesStretchAlongItWithinAFactorOfTwo) {
  const Flag flag;
  const RigidCoat coat({cube(0, palette::kBone)}, flag.skeleton, flag.tree);
  const Quat turns[] = {turn({0, 0, 1}, M_PI / 2), Quat::Identity()};  // x becomes y
  for (const auto& [length, factor] : {std::pair{1.0, 1.0}, {1.5, 1.5}, {3.0, 2.0}, {0.1, 0.5}}) {
    Points x = flag.skeleton.rest;
    x.col(0) = Vec3(1, 2, 3);
    x.col(1) = x.col(0) + Vec3(0, length, 0);
    Mesh mesh = coat.rest();
    coat.pose(x, turns, mesh);
    for (int i = 0; i < mesh.vertices.cols(); ++i) {
      const Vec3 v = coat.rest().vertices.col(i), n = coat.rest().normals.col(i);
      const Vec3 expected = Vec3(1, 2, 3) + Vec3(-v.y(), factor * v.x(), v.z());
      EXPECT_LT((mesh.vertices.col(i) - expected).norm(), 1e-12) << length;
      EXPECT_LT((mesh.normals.col(i) - Vec3(-n.y(), n.x(), n.z())).norm(), 1e-12) << length;
    }
  }
}

TEST(RigidCoat, GroupPiecesKeepTheirSizeAboutTheMiddle) {
  const Flag flag;
  const RigidCoat coat({cube(1, palette::kGroup)}, flag.skeleton, flag.tree);
  const Quat turns[] = {Quat::Identity(), turn({0, 0, 1}, M_PI)};
  Points x = 3 * flag.skeleton.rest;
  const Vec3 before(4.0 / 3, 1, 0), now(4, 3, 0);  // the means of its particles
  Mesh mesh = coat.rest();
  coat.pose(x, turns, mesh);
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    const Vec3 arm = coat.rest().vertices.col(i) - before;
    EXPECT_LT((mesh.vertices.col(i) - now - Vec3(-arm.x(), -arm.y(), arm.z())).norm(), 1e-12);
  }
}

TEST(RigidCoat, KnowsThePartOfEachVertexAndLightsItsColour) {
  const Flag flag;
  const RigidCoat coat({cube(1, palette::kGroup), cube(0, palette::kBone)}, flag.skeleton,
                       flag.tree);
  std::vector<int> parts(24, 1);  // a box has three vertices at each corner
  parts.resize(48, 0);
  EXPECT_EQ(coat.partOfVertex(), parts);
  const Quat turns[] = {Quat::Identity(), Quat::Identity()};
  Mesh mesh = coat.rest();
  coat.pose(flag.skeleton.rest, turns, mesh);
  for (int i = 0; i < 48; ++i)
    EXPECT_EQ(mesh.colors[i].r,
              shade(i < 24 ? palette::kGroup : palette::kBone, mesh.normals.col(i)).r);
}

}  // namespace
}  // namespace ragdoll::test
