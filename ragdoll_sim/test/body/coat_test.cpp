#include "ragdoll_sim/body/coat.h"

#include <gtest/gtest.h>

#include "body/rigid_coat.h"
#include "human_model.h"
#include "support/error_of.h"

namespace ragdoll::test {
namespace {

struct HumanInACoat {
  Model model = modelOf(humanSkeleton());
  FrameTracker tracker{model};
  const Skeleton& skeleton = model.skeletons[0];
};

Skeleton tripod() {
  Skeleton s;
  s.name = "tripod";
  s.rest.resize(3, 4);
  s.rest << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  s.radius = Eigen::VectorXd::Constant(4, 0.1);
  for (int i = 0; i < 4; ++i) s.particles.push_back("p" + std::to_string(i));
  for (int i = 1; i < 4; ++i) s.sticks.push_back({0, i, 1});
  s.named = static_cast<int>(s.particles.size());
  return s;
}

TEST(Coat, KindsByName) {
  EXPECT_EQ(coatKind("boxes"), CoatKind::kBoxes);
  const std::string error = errorOf([] { coatKind("fur"); });
  EXPECT_NE(error.find("none, sticks, boxes, capsules, skin"), std::string::npos) << error;
}

TEST(Coat, NoneIsNothing) {
  HumanInACoat human;
  EXPECT_TRUE(Coat(CoatKind::kNone, human.model, human.tracker, 0).shapes().empty());
}

TEST(Coat, SticksAreTheParticleSystem) {
  HumanInACoat human;
  Coat coat(CoatKind::kSticks, human.model, human.tracker, 0);
  const Points x = human.skeleton.rest.colwise() + Vec3(1, 2, 3);
  human.tracker.update(stateOf(x));
  coat.update(human.tracker.now());
  ASSERT_EQ(coat.shapes().size(), 2u);
  EXPECT_EQ(coat.shapes()[0].points.cols(), 48);
  EXPECT_EQ(coat.shapes()[0].points.col(1), x.col(human.skeleton.sticks[0].b));
  EXPECT_EQ(coat.shapes()[1].points, x);
}

TEST(Coat, EveryPieceIsClosedAndNotDegenerate) {
  for (const Skeleton& s : {humanSkeleton(), tripod()}) {
    const FrameTree tree = buildFrameTree(s);
    for (const RigidPiece& piece : capsulePieces(s, tree)) {
      EXPECT_TRUE(isClosed(piece.mesh));
      EXPECT_GT(volume(piece.mesh), 0);
      EXPECT_GT(smallestArea(piece.mesh), 1e-7);
    }
    for (const RigidPiece& piece : boxPieces(s, tree)) EXPECT_GT(volume(piece.mesh), 0);
  }
}

TEST(Coat, RigidMotionMovesEveryVertexAlike) {
  for (const CoatKind kind : {CoatKind::kBoxes, CoatKind::kCapsules}) {
    HumanInACoat human;
    Coat coat(kind, human.model, human.tracker, 0);
    const Points rest = coat.shapes()[0].mesh.vertices;
    const Quat q = turn({1, -2, 0.5}, 2.5);
    human.tracker.reset(
        stateOf((q.toRotationMatrix() * human.skeleton.rest).colwise() + Vec3(3, 2, 1)));
    coat.update(human.tracker.now());
    const Points expected = (q.toRotationMatrix() * rest).colwise() + Vec3(3, 2, 1);
    EXPECT_LT((coat.shapes()[0].mesh.vertices - expected).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Coat, PiecesStretchWithTheirBone) {
  HumanInACoat human;
  const RigidCoat coat(capsulePieces(human.skeleton, human.tracker.tree(0)), human.skeleton,
                       human.tracker.tree(0));
  Points x = human.skeleton.rest;
  const int knee = human.skeleton.particle("left_knee"),
            foot = human.skeleton.particle("left_foot");
  const Vec3 longer = 0.1 * (x.col(foot) - x.col(knee));
  x.col(foot) += longer;
  human.tracker.reset(stateOf(x));
  Mesh mesh = coat.rest();
  coat.pose(x, human.tracker.now().parts.data(), mesh);
  EXPECT_NEAR(mesh.vertices.row(2).minCoeff(),
              coat.rest().vertices.row(2).minCoeff() - longer.norm(), 0.01);
  EXPECT_NEAR(mesh.vertices.row(2).maxCoeff(), coat.rest().vertices.row(2).maxCoeff(), 1e-9);
}

TEST(Coat, StandsOnItsFeetAndFacesForward) {
  HumanInACoat human;
  const Coat coat(CoatKind::kCapsules, human.model, human.tracker, 0);
  const Points& v = coat.shapes()[0].mesh.vertices;
  const double floor = human.skeleton.rest.row(2).minCoeff() - 0.040;
  EXPECT_NEAR(v.row(2).minCoeff(), floor, 0.005);        // where the foot's sphere stands
  EXPECT_NEAR(v.row(2).maxCoeff() - floor, 1.77, 0.04);  // as tall as its bones
  EXPECT_GT(v.row(0).maxCoeff(), 0.12);                  // toes
  EXPECT_GT(v.row(0).minCoeff(), -0.16);
}

TEST(Coat, AnySkeletonHasOne) {
  Skeleton alone;
  alone.name = "alone";
  alone.rest.setZero(3, 1);
  alone.radius.setConstant(1, 0.1);
  alone.particles = {"p"};
  alone.named = 1;
  for (const Skeleton& skeleton : {tripod(), alone}) {
    const Model model = modelOf(skeleton);
    FrameTracker tracker(model);
    tracker.reset(stateOf(skeleton.rest));
    tracker.update(stateOf(skeleton.rest));
    for (const CoatKind kind :
         {CoatKind::kSticks, CoatKind::kBoxes, CoatKind::kCapsules, CoatKind::kSkin})
      EXPECT_FALSE(Coat(kind, model, tracker, 0).shapes().empty());
  }
}

TEST(Coat, ObstaclesHaveTheirMeasures) {
  Obstacle capsule;
  capsule.type = ObstacleSpec::Type::kCapsule;
  capsule.half = Vec3(0, 0, 0.5);
  capsule.radius = 0.1;
  const Mesh mesh = obstacleShape(capsule).mesh;
  EXPECT_NEAR(mesh.vertices.row(2).maxCoeff(), 0.6, 1e-12);
  EXPECT_NEAR(mesh.vertices.row(0).maxCoeff(), 0.1, 1e-3);

  Obstacle plane;
  plane.type = ObstacleSpec::Type::kPlane;
  const CoatShape slab = obstacleShape(plane);
  EXPECT_NEAR(slab.pose.position.z() + slab.size.z() / 2, 0, 1e-12);

  Obstacle cube;
  cube.type = ObstacleSpec::Type::kBox;
  cube.half = Vec3(1, 2, 3);
  EXPECT_EQ(obstacleShape(cube).size, Vec3(2, 4, 6));
}

}  // namespace
}  // namespace ragdoll::test
