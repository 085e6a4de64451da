#include "ragdoll_sim/body/skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "human_model.h"
#include "ragdoll_sim/body/coat.h"
#include "slice.h"

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

  /// The ring of the skin at p, across the direction.
  std::vector<int> ring(const Vec3& p, const Vec3& across, double reach) const {
    return slice(bound.mesh, p, across, reach, 1e-3);
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
