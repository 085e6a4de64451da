#include "ragdoll_sim/body/coat_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "body/rigid_coat.h"
#include "human_model.h"

namespace ragdoll::test {
namespace {

constexpr CoatKind kMeshes[] = {CoatKind::kBoxes, CoatKind::kCapsules, CoatKind::kSkin};

/// A body somewhere, turned, with a bent elbow.
struct Bent {
  Model model = modelOf(humanSkeleton());
  FrameTracker tracker{model};
  const Skeleton& skeleton = model.skeletons[0];
  const FrameTree& tree = tracker.tree(0);

  Bent() {
    Points x = skeleton.rest;
    const int elbow = skeleton.particle("left_elbow"), hand = skeleton.particle("left_hand");
    const Vec3 forearm = x.col(hand) - x.col(elbow);
    x.col(hand) = x.col(elbow) + turn({0, 1, 0}, -1.2) * forearm;
    tracker.reset(stateOf((turn({1, 2, 3}, 2).toRotationMatrix() * x).colwise() + Vec3(3, -2, 1)));
  }
  Mesh worn(CoatMesh coat) const {
    Mesh mesh = coat.rest();
    coat.pose(tracker.now().x, tracker.now().parts.data(), mesh);
    return mesh;
  }
};

double distanceTo(const Points& cloud, const Vec3& p) {
  return std::sqrt((cloud.colwise() - p).colwise().squaredNorm().minCoeff());
}

TEST(CoatMesh, InFullIsWhatCoatDraws) {
  const Bent body;
  for (const CoatKind kind : kMeshes) {
    const Coat coat(kind, body.model, body.tracker, 0);
    const Mesh& expected = coat.shapes()[0].mesh;
    const Mesh mesh = body.worn(CoatMesh(kind, body.skeleton, body.tree));
    EXPECT_EQ(mesh.vertices, expected.vertices);
    EXPECT_EQ(mesh.normals, expected.normals);
    EXPECT_EQ(mesh.triangles, expected.triangles);
    for (std::size_t i = 0; i < mesh.colors.size(); ++i)
      EXPECT_EQ(mesh.colors[i].g, expected.colors[i].g);
  }
}

TEST(CoatMesh, LosesNoMoreThanItsLoss) {
  const Bent body;
  for (const CoatKind kind : {CoatKind::kCapsules, CoatKind::kSkin}) {
    const Mesh full = body.worn(CoatMesh(kind, body.skeleton, body.tree));
    std::size_t before = full.triangles.size();
    for (const double loss : {0.05, 0.10, 0.20}) {
      const Mesh mesh = body.worn(CoatMesh(kind, body.skeleton, body.tree, loss));
      EXPECT_LT(mesh.triangles.size(), before);
      before = mesh.triangles.size();
      // Every vertex is one of the full mesh, and none of that is farther than the loss.
      for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
        EXPECT_LT(distanceTo(full.vertices, mesh.vertices.col(i)), 1e-12);
      for (Eigen::Index i = 0; i < full.vertices.cols(); ++i)
        EXPECT_LT(distanceTo(mesh.vertices, full.vertices.col(i)), loss);
    }
    // From afar: far fewer triangles, and limbs that are still there: a square in a circle, or more.
    EXPECT_LT(before, full.triangles.size() / 8);
    const Mesh mesh = body.worn(CoatMesh(kind, body.skeleton, body.tree, 0.10));
    EXPECT_GT(volume(mesh), 0.5 * volume(full));
    EXPECT_LT(volume(mesh), volume(full));
  }
}

TEST(CoatMesh, SticksAreDrawnFromEndToEnd) {
  const Bent body;
  for (const double loss : {0.0, 0.05}) {
    const CoatMesh coat(CoatKind::kSticks, body.skeleton, body.tree, loss);
    EXPECT_TRUE(isClosed(coat.rest()));
    EXPECT_GT(volume(coat.rest()), 0);
    const Mesh mesh = body.worn(CoatMesh(CoatKind::kSticks, body.skeleton, body.tree, loss));
    const auto& x = body.tracker.now().x;
    for (const Stick& s : body.skeleton.sticks)
      for (const int end : {s.a, s.b})
        EXPECT_LT(distanceTo(mesh.vertices, x.col(end)), sticks_look::kWidth / 2);
    for (int p = 0; p < body.skeleton.named; ++p)
      EXPECT_LE(distanceTo(mesh.vertices, x.col(p)), sticks_look::kParticleSize / 2 + 1e-12);
    // A ball's own vertices come last: all on its surface.
    const Vec3 last = x.col(body.skeleton.named - 1);
    EXPECT_NEAR((mesh.vertices.rightCols(1) - last).norm(), sticks_look::kParticleSize / 2, 1e-12);
  }
}

TEST(CoatMesh, NoneIsNothing) {
  const Bent body;
  EXPECT_TRUE(CoatMesh(CoatKind::kNone, body.skeleton, body.tree).rest().triangles.empty());
}

}  // namespace
}  // namespace ragdoll::test
