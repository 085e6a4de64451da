#include "ragdoll_sim/body/mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ragdoll::test {
namespace {

/// Normals point out of the surface that the triangles' winding describes.
void expectSound(const Mesh& mesh) {
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_GT(volume(mesh), 0);
  EXPECT_GT(smallestArea(mesh), 1e-9);
  ASSERT_EQ(mesh.normals.cols(), mesh.vertices.cols());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]),
               c = mesh.vertices.col(t[2]);
    for (const int i : t)
      EXPECT_GT((b - a).cross(c - a).normalized().dot(mesh.normals.col(i)), 0.2);
  }
}

double capsuleVolume(double r, double length) { return M_PI * r * r * (4.0 / 3 * r + length); }

TEST(Mesh, SphereHasItsVolume) {
  const Mesh mesh = roundCone(Vec3(1, 2, 3), 0.3, Vec3(1, 2, 3), 0.3, 64, 24);
  expectSound(mesh);
  EXPECT_NEAR(volume(mesh), capsuleVolume(0.3, 0), 0.005 * capsuleVolume(0.3, 0));
}

TEST(Mesh, CapsuleHasItsVolume) {
  const Mesh mesh = roundCone(Vec3(1, 0, 0), 0.1, Vec3(1, 0.4, 0.3), 0.1, 64, 24);
  expectSound(mesh);
  EXPECT_NEAR(volume(mesh), capsuleVolume(0.1, 0.5), 0.005 * capsuleVolume(0.1, 0.5));
}

TEST(Mesh, RoundConeTouchesBothSpheres) {
  const Vec3 a(0, 0, 0), b(0, 0, 0.5);
  const Mesh mesh = roundCone(a, 0.1, b, 0.04, 16, 4);
  expectSound(mesh);
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    const Vec3 p = mesh.vertices.col(i);
    EXPECT_NEAR(std::min((p - a).norm() - 0.1, (p - b).norm() - 0.04), 0, 1e-12);
  }
}

TEST(Mesh, SphereWithinASphereIsTheLargerOne) {
  const Mesh mesh = roundCone(Vec3(0, 0, 0.01), 0.05, Vec3::Zero(), 0.2, 48, 16);
  expectSound(mesh);
  EXPECT_NEAR(volume(mesh), capsuleVolume(0.2, 0), 0.01 * capsuleVolume(0.2, 0));
}

TEST(Mesh, CoarseRoundConeIsSound) {
  expectSound(roundCone(Vec3::Zero(), 0.1, Vec3::UnitX(), 0.2, 6, 1));
}

TEST(Mesh, EllipsoidHasItsVolume) {
  const Mesh mesh = ellipsoid(Vec3(0.1, 0.2, 0.3), 64, 48);
  expectSound(mesh);
  const double expected = 4.0 / 3 * M_PI * 0.006;
  EXPECT_NEAR(volume(mesh), expected, 0.005 * expected);
}

TEST(Mesh, BoxHasItsVolumeAndSharpEdges) {
  const Mesh mesh = box(Vec3(1, 2, 3));
  EXPECT_NEAR(volume(mesh), 6, 1e-12);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]),
               c = mesh.vertices.col(t[2]);
    EXPECT_NEAR((b - a).cross(c - a).normalized().dot(mesh.normals.col(t[0])), 1, 1e-12);
  }
}

TEST(Mesh, AppendMovesThePart) {
  Mesh mesh;
  append(box(Vec3::Ones()), {Vec3(5, 0, 0), Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ()))}, mesh);
  append(box(Vec3::Ones()), {Vec3(-5, 0, 0), Quat::Identity()}, mesh);
  EXPECT_NEAR(volume(mesh), 2, 1e-12);
  EXPECT_LT((mesh.vertices.leftCols(24).rowwise().mean() - Vec3(5, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(mesh.normals.leftCols(24).row(2).maxCoeff(), 1, 1e-12);
}

TEST(Mesh, AnOpenMeshIsSeenAsOpen) {
  Mesh mesh = roundCone(Vec3::Zero(), 0.1, Vec3::UnitX(), 0.1);
  mesh.triangles.pop_back();
  EXPECT_FALSE(isClosed(mesh));
}

TEST(Mesh, LightComesFromAbove) {
  EXPECT_GT(shade({0.5f, 0.5f, 0.5f, 1}, Vec3::UnitZ()).g,
            shade({0.5f, 0.5f, 0.5f, 1}, -Vec3::UnitZ()).g + 0.1f);
  EXPECT_LE(shade({1, 1, 1, 1}, Vec3(0.5, -0.3, 0.8).normalized()).r, 1);
}

}  // namespace
}  // namespace ragdoll::test
