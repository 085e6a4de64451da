#include "ragdoll_sim/body/skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "human_model.h"
#include "ragdoll_sim/body/coat.h"

namespace ragdoll::test {
namespace {

struct HumanInASkin {
  Model model = modelOf(humanSkeleton());
  FrameTracker tracker{model};
  const Skeleton& skeleton = model.skeletons[0];
  const FrameTree& tree = tracker.tree(0);
  BoundMesh bound = humanSkin(skeleton, tree);
  Skin skin{bound, skeleton, tree};

  Vec3 rest(const std::string& name) const { return skeleton.rest.col(skeleton.particle(name)); }

  Mesh pose(const std::map<std::string, Quat>& turns, Blend blend) {
    Points x = skeleton.rest;
    if (!turns.empty()) x = posed(skeleton, turns);
    tracker.reset(stateOf(x));
    Mesh mesh = skin.rest();
    skin.deform(x, tracker.now().parts.data(), blend, mesh);
    return mesh;
  }

  /// Vertices of the rest pose within 1 mm of the plane through p across the direction, near p, in
  /// the order in which they were made, that is around the ring.
  std::vector<int> ring(const Vec3& p, const Vec3& across, double reach) const {
    std::vector<int> found;
    for (int i = 0; i < bound.mesh.vertices.cols(); ++i) {
      const Vec3 d = bound.mesh.vertices.col(i) - p;
      if (std::abs(d.dot(across.normalized())) < 1e-3 && d.norm() < reach) found.push_back(i);
    }
    return found;
  }
};

/// [m^2] enclosed by a ring of vertices, seen along its own mean normal.
double area(const Mesh& mesh, const std::vector<int>& ring) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t j = 0; j < ring.size(); ++j)
    sum += Vec3(mesh.vertices.col(ring[j]))
               .cross(Vec3(mesh.vertices.col(ring[(j + 1) % ring.size()])));
  return sum.norm() / 2;
}

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

TEST(Skin, IsOneClosedSurfaceFacingOutward) {
  HumanInASkin human;
  const Mesh& mesh = human.bound.mesh;
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

TEST(Skin, HasTheVolumeOfItsMass) {
  // 75 kg at 985 kg/m^3 [Durnin1974, mid-range]; within 15 %.
  HumanInASkin human;
  EXPECT_NEAR(volume(human.bound.mesh), 0.075, 0.15 * 0.075);
}

TEST(Skin, IsMirrorSymmetric) {
  HumanInASkin human;
  const Points& v = human.bound.mesh.vertices;
  for (int i = 0; i < v.cols(); ++i) {
    const Vec3 mirrored = v.col(i).cwiseProduct(Vec3(1, -1, 1));
    EXPECT_LT((v.colwise() - mirrored).colwise().norm().minCoeff(), 1e-9);
  }
}

TEST(Skin, StandsWhereTheFeetStand) {
  HumanInASkin human;
  const Points& v = human.bound.mesh.vertices;
  const double floor = human.rest("left_foot").z() - 0.040;
  EXPECT_NEAR(v.row(2).minCoeff(), floor, 1e-9);
  EXPECT_NEAR(v.row(2).maxCoeff() - floor, 1.77, 0.03);
}

TEST(Skin, WeightsSumToOne) {
  HumanInASkin human;
  for (const Weights& w : human.bound.weights) {
    float sum = 0;
    for (int n = 0; n < w.count; ++n) {
      EXPECT_GT(w.weight[n], 0);
      sum += w.weight[n];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

TEST(Skin, RestAndRigidMotionsAreExact) {
  for (const Blend blend : {Blend::kLinear, Blend::kDualQuaternion}) {
    HumanInASkin human;
    EXPECT_LT((human.pose({}, blend).vertices - human.bound.mesh.vertices).cwiseAbs().maxCoeff(),
              1e-6);
    const Quat q = turn({1, 2, -0.5}, 3.0);
    const Points x = (q.toRotationMatrix() * human.skeleton.rest).colwise() + Vec3(3, -2, 1);
    human.tracker.reset(stateOf(x));
    Mesh mesh = human.skin.rest();
    human.skin.deform(x, human.tracker.now().parts.data(), blend, mesh);
    const Points expected =
        (q.toRotationMatrix() * human.bound.mesh.vertices).colwise() + Vec3(3, -2, 1);
    EXPECT_LT((mesh.vertices - expected).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(Skin, ElbowBentBy120DegreesKeepsItsCrossSection) {
  HumanInASkin human;
  const Vec3 elbow = human.rest("right_elbow");
  const auto ring = human.ring(elbow, elbow - human.rest("right_shoulder"), 0.08);
  ASSERT_EQ(ring.size(), 12u);
  const double rest = area(human.bound.mesh, ring);
  const std::map<std::string, Quat> bent = {{"right_elbow", turn({0, -1, 0}, 120 * M_PI / 180)}};
  const double dual = area(human.pose(bent, Blend::kDualQuaternion), ring) / rest;
  const double linear = area(human.pose(bent, Blend::kLinear), ring) / rest;
  EXPECT_NEAR(dual, 1.0, 0.02);
  EXPECT_NEAR(linear, std::cos(60 * M_PI / 180), 0.03);  // the collapsing elbow
}

/// Smallest cross-section, as a share of that at rest, of the rings of `points` vertices around a
/// joint when `part` alone is twisted about the axis. The orientations are given directly: the
/// tracker would not let a joint without a visible twist go that far.
double narrowest(HumanInASkin& human, const std::string& part, const Vec3& joint, const Vec3& axis,
                 std::size_t points, double angle, Blend blend) {
  std::vector<Quat> parts(human.tree.parts.size(), Quat::Identity());
  parts[human.tree.part(part)] = turn(axis, angle);
  Mesh mesh = human.skin.rest();
  human.skin.deform(human.skeleton.rest, parts.data(), blend, mesh);
  double least = 1;
  int rings = 0;
  for (double place = -0.1; place < 0.15; place += 0.001) {
    const auto ring = human.ring(joint + place * axis.normalized(), axis, 0.15);
    if (ring.size() != points) continue;
    ++rings;
    least = std::min(least, area(mesh, ring) / area(human.skin.rest(), ring));
  }
  EXPECT_GT(rings, 2);
  return least;
}

TEST(Skin, TwistedNeckKeepsItsCrossSection) {
  HumanInASkin human;
  const Vec3 neck = human.rest("neck"), up = Vec3::UnitZ();
  const double angle = 120 * M_PI / 180;
  EXPECT_GT(narrowest(human, "head", neck, up, 20, angle, Blend::kDualQuaternion), 0.95);
  EXPECT_LT(narrowest(human, "head", neck, up, 20, angle, Blend::kLinear), 0.5);
}

/// [m^2] of the cut by the plane through p across n, of what lies within reach of p.
double cut(const Mesh& mesh, const Vec3& p, const Vec3& n, double reach) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    Vec3 enter = Vec3::Zero(), leave = Vec3::Zero();
    int found = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = mesh.vertices.col(t[i]) - p, b = mesh.vertices.col(t[(i + 1) % 3]) - p;
      const double u = a.dot(n), v = b.dot(n);
      if ((u < 0) == (v < 0)) continue;
      (u < 0 ? enter : leave) = a + u / (u - v) * (b - a);
      ++found;
    }
    if (found == 2 && enter.norm() < reach) sum += n.normalized().dot(enter.cross(leave)) / 2;
  }
  return std::abs(sum);
}

TEST(Skin, TwistedShoulderIsNoCandyWrapper) {
  HumanInASkin human;
  const Vec3 shoulder = human.rest("left_shoulder"), arm = human.rest("left_elbow") - shoulder;
  std::vector<Quat> parts(human.tree.parts.size(), Quat::Identity());
  const Quat twist = turn(arm, 150 * M_PI / 180);
  parts[human.tree.part("left_upper_arm")] = parts[human.tree.part("left_forearm")] = twist;
  Mesh dual = human.skin.rest(), linear = human.skin.rest();
  human.skin.deform(human.skeleton.rest, parts.data(), Blend::kDualQuaternion, dual);
  human.skin.deform(human.skeleton.rest, parts.data(), Blend::kLinear, linear);
  const Vec3 below = shoulder + 0.105 * arm.normalized();  // just below the armpit
  constexpr double kReach = 0.066;                         // [m] the arm, not the trunk
  const double rest = cut(human.skin.rest(), below, arm, kReach);
  EXPECT_NEAR(rest, 0.007, 0.001);
  EXPECT_GT(cut(dual, below, arm, kReach) / rest, 0.9);
  EXPECT_LT(cut(linear, below, arm, kReach) / rest, 0.7);
}

TEST(Skin, VolumeHoldsInEveryPose) {
  HumanInASkin human;
  const double rest = volume(human.bound.mesh);
  const std::map<std::string, Quat> sitting = {
      {"left_leg", turn({0, -1, 0}, 1.5)},   {"right_leg", turn({0, -1, 0}, 1.5)},
      {"left_knee", turn({0, 1, 0}, 1.6)},   {"right_knee", turn({0, 1, 0}, 1.6)},
      {"left_elbow", turn({0, -1, 0}, 2.1)}, {"right_elbow", turn({0, -1, 0}, 2.1)}};
  EXPECT_NEAR(volume(human.pose(sitting, Blend::kDualQuaternion)) / rest, 1, 0.08);
}

TEST(Skin, CoatWearsIt) {
  HumanInASkin human;
  const Coat coat(CoatKind::kSkin, human.model, human.tracker, 0);
  EXPECT_EQ(coat.shapes()[0].mesh.triangles.size(), human.bound.mesh.triangles.size());
}

}  // namespace
}  // namespace ragdoll::test
