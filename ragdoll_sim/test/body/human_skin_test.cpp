// The skin as it is made: one sound surface of a human's measures, carried where it should be.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "human_model.h"
#include "ragdoll_sim/body/skin.h"
#include "slice.h"

namespace ragdoll::test {
namespace {

struct HumanAtRest {
  Skeleton skeleton;
  FrameTree tree;
  BoundMesh skin;

  explicit HumanAtRest(double scale = 1) : skeleton(humanSkeleton()) {
    skeleton.rest *= scale;
    tree = buildFrameTree(skeleton);
    skin = humanSkin(skeleton, tree);
  }

  Vec3 rest(const std::string& name) const { return skeleton.rest.col(skeleton.particle(name)); }
  /// What the part carries of the vertex.
  double weight(Eigen::Index vertex, const std::string& part) const {
    const Weights& w = skin.weights[static_cast<std::size_t>(vertex)];
    for (int n = 0; n < w.count; ++n)
      if (w.part[n] == tree.part(part)) return w.weight[n];
    return 0;
  }
};

/// How often the mesh goes around p: sum of the triangles' solid angles [VanOosterom1983] / 4 pi.
double winding(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices.col(t[0]) - p, b = mesh.vertices.col(t[1]) - p,
               c = mesh.vertices.col(t[2]) - p;
    sum += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                 b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return sum / (4 * M_PI);
}

TEST(HumanSkin, IsOneClosedSurfaceFacingOutward) {
  const HumanAtRest human;
  const Mesh& mesh = human.skin.mesh;
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_GT(smallestArea(mesh), 4e-6);
  // Euler's formula: one surface without handles.
  const int v = static_cast<int>(mesh.vertices.cols()), t = static_cast<int>(mesh.triangles.size());
  EXPECT_EQ(v - t / 2, 2);
  // Once around every point of the bones, not at all around points outside: no overlap, no fold.
  for (const Part& part : human.tree.parts) {
    if (part.group) continue;
    const Vec3 p = human.skeleton.rest.col(part.particles[0]);
    const Vec3 q = human.skeleton.rest.col(part.particles[1]);
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0})
      EXPECT_NEAR(winding(mesh, p + t * (q - p)), 1, 1e-9) << (p + t * (q - p)).transpose();
  }
  for (const Vec3& p : {Vec3(0, 0, 1), Vec3(0, 0, -0.4), Vec3(0, 0.22, 0.1), Vec3(0.2, 0, 0.2)})
    EXPECT_NEAR(winding(mesh, p), 0, 1e-9) << p.transpose();
}

TEST(HumanSkin, HasTheVolumeOfItsMass) {
  // 75 kg at 985 kg/m^3 [Durnin1974, mid-range]; within 15 %.
  const HumanAtRest human;
  EXPECT_NEAR(volume(human.skin.mesh), 0.075, 0.15 * 0.075);
}

TEST(HumanSkin, IsMirrorSymmetric) {
  const HumanAtRest human;
  const Points& v = human.skin.mesh.vertices;
  for (int i = 0; i < v.cols(); ++i) {
    const Vec3 mirrored = v.col(i).cwiseProduct(Vec3(1, -1, 1));
    EXPECT_LT((v.colwise() - mirrored).colwise().norm().minCoeff(), 1e-9);
  }
}

TEST(HumanSkin, StandsWhereTheFeetStand) {
  const HumanAtRest human;
  const Points& v = human.skin.mesh.vertices;
  const double floor = human.rest("left_foot").z() - 0.040;
  EXPECT_NEAR(v.row(2).minCoeff(), floor, 1e-9);
  EXPECT_NEAR(v.row(2).maxCoeff() - floor, 1.77, 0.03);
}

TEST(HumanSkin, WeightsSumToOne) {
  const HumanAtRest human;
  for (const Weights& w : human.skin.weights) {
    float sum = 0;
    for (int n = 0; n < w.count; ++n) {
      EXPECT_GT(w.weight[n], 0);
      sum += w.weight[n];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

TEST(HumanSkin, ScalesWithTheBody) {
  const HumanAtRest one, two(2);
  EXPECT_LT((two.skin.mesh.vertices - 2 * one.skin.mesh.vertices).cwiseAbs().maxCoeff(), 1e-12);
  for (std::size_t i = 0; i < one.skin.weights.size(); ++i)
    EXPECT_NEAR(two.skin.weights[i].weight[0], one.skin.weights[i].weight[0], 1e-6);
}

TEST(HumanSkin, IsCarriedByOnePartFarFromJoints) {
  const HumanAtRest human;
  for (const std::string side : {"left_", "right_"}) {
    for (const auto& [part, from, to] :
         {std::array<std::string, 3>{"forearm", "elbow", "hand"}, {"shank", "knee", "foot"}}) {
      const Vec3 a = human.rest(side + from), b = human.rest(side + to);
      const auto found = slice(human.skin.mesh, (a + b) / 2, b - a, 0.12, 0.06);
      EXPECT_GE(found.size(), 12u) << side << part;
      for (const int i : found) EXPECT_NEAR(human.weight(i, side + part), 1, 1e-6) << side << part;
    }
  }
  Eigen::Index crown = 0;
  human.skin.mesh.vertices.row(2).maxCoeff(&crown);
  EXPECT_NEAR(human.weight(crown, "head"), 1, 1e-6);
}

TEST(HumanSkin, IsCarriedHalfAndHalfAtAHinge) {
  const HumanAtRest human;
  for (const std::string side : {"left_", "right_"}) {
    for (const auto& [upper, lower, from, at] :
         {std::array<std::string, 4>{"upper_arm", "forearm", "shoulder", "elbow"},
          {"thigh", "shank", "leg", "knee"}}) {
      const Vec3 joint = human.rest(side + at), along = joint - human.rest(side + from);
      const auto ring = slice(human.skin.mesh, joint, along, 0.08, 1e-6);
      EXPECT_EQ(ring.size(), 12u) << side << at;
      for (const int i : ring) {
        EXPECT_NEAR(human.weight(i, side + upper), 0.5, 1e-6) << side << at;
        EXPECT_NEAR(human.weight(i, side + lower), 0.5, 1e-6) << side << at;
      }
    }
  }
}

}  // namespace
}  // namespace ragdoll::test
