// What a drawn fall is made into: measures by hand, and that nothing begins inside anything else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "human.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/falls/fall.h"

namespace ragdoll::falls {
namespace {

constexpr double kSceneStep = 1.0 / 200;
constexpr double kRise = 0.17, kTread = 0.3;  ///< [m] of the stairs

FallScene madeOf(const Fall& fall) {
  return fallScene(fall, scaledModel(*human(), fall.scale), kSceneStep);
}

Fall fallOf(const std::string& kind, const std::string& start) {
  Fall fall;
  fall.kind = kind;
  fall.start = start;
  return fall;
}

/// [m] of the highest face of planes and upright boxes above or below x, y.
double heightAt(const Scene& scene, double x, double y) {
  double height = 0;
  for (const ObstacleSpec& o : scene.obstacles) {
    const Vec3 out = (Vec3(x, y, 0) - o.pose.position).cwiseAbs() - o.size / 2;
    if (o.type == ObstacleSpec::Type::kBox && out.x() < 0 && out.y() < 0)
      height = std::max(height, o.pose.position.z() + o.size.z() / 2);
  }
  return height;
}

TEST(ScaledModel, ScalesEachQuantityByItsPowerOfTheLength) {
  SkeletonSpec model;
  model.particles.resize(1);
  model.particles[0].position = Vec3(1, 2, 3);
  model.particles[0].radius = 0.1;
  model.particles[0].mass = 5;
  model.sticks.resize(2);
  model.sticks[0].length = 0.7;
  model.segments.resize(1);
  model.segments[0].mass = 3;
  model.segments[0].com = 0.4;
  model.segments[0].com_point = Vec3(0, 0, 0.3);
  model.segments[0].inertia = Eigen::Matrix3d::Identity();
  model.joints.resize(1);
  model.joints[0].stiffness = 2;
  model.joints[0].damping = 0.5;
  const auto big = scaledModel(model, 4);
  EXPECT_EQ(big->particles[0].position, Vec3(4, 8, 12));
  EXPECT_NEAR(big->particles[0].radius, 0.4, 1e-12);
  EXPECT_NEAR(big->particles[0].mass, 5 * 64, 1e-9);
  EXPECT_NEAR(*big->sticks[0].length, 2.8, 1e-12);
  EXPECT_FALSE(big->sticks[1].length);
  EXPECT_NEAR(big->segments[0].mass, 3 * 64, 1e-9);
  EXPECT_EQ(big->segments[0].com, 0.4);  // a share
  EXPECT_NEAR(big->segments[0].com_point.z(), 1.2, 1e-12);
  EXPECT_NEAR(big->segments[0].inertia(1, 1), 1024, 1e-9);
  EXPECT_NEAR(big->joints[0].stiffness, 2 * 256, 1e-9);  // weight times length
  EXPECT_NEAR(big->joints[0].damping, 0.5 * 512, 1e-9);  // and times of twice the length of time
}

TEST(FallScene, StairsGoDownSevenRisesFromUnderTheFeet) {
  Fall fall = fallOf("faint", "stairs");
  fall.scale = 0.9;
  const FallScene made = madeOf(fall);
  EXPECT_EQ(made.floors, 8);  // the floor, the landing, six boxes
  EXPECT_EQ(made.floors, static_cast<int>(made.scene.obstacles.size()));
  for (int i = 0; i <= 7; ++i)
    EXPECT_NEAR(heightAt(made.scene, (i - 0.5) * kTread, 0), (7 - i) * kRise, 1e-12) << i;
  const Vec3 hips = made.scene.ragdolls[0].pose.position;
  EXPECT_NEAR(heightAt(made.scene, hips.x(), hips.y()), 7 * kRise, 1e-12);
  // As high above the landing as above a floor.
  fall.start = "standing";
  const Vec3 standing = madeOf(fall).scene.ragdolls[0].pose.position;
  EXPECT_NEAR(hips.z() - standing.z(), 7 * kRise, 1e-12);
}

TEST(FallScene, WhoSitsHasThighsAheadAndShanksDown) {
  for (const char* start : {"sitting", "chair"}) {
    Fall fall = fallOf("faint", start);
    fall.scale = 1.1;
    fall.yaw = 30;
    fall.pitch = -20;
    fall.place = -1;
    const FallScene made = madeOf(fall);
    EXPECT_EQ(made.floors, 1);  // a seat is furniture
    const Model model = buildModel(made.scene);
    const State state = startState(model);
    const Skeleton& s = model.skeletons[0];
    const auto bone = [&](const std::string& from, const std::string& to) -> Vec3 {
      return state.x.col(s.particle(to)) - state.x.col(s.particle(from));
    };
    const Vec3 ahead(std::cos(M_PI / 6), std::sin(M_PI / 6), 0);
    for (const std::string side : {"left_", "right_"}) {
      const Vec3 thigh = bone(side + "leg", side + "knee"),
                 shank = bone(side + "knee", side + "foot");
      EXPECT_LT((thigh.normalized() - ahead).norm(), 1e-3) << start;
      EXPECT_LT((shank.normalized() + Vec3::UnitZ()).norm(), 1e-3) << start;
    }
    EXPECT_LT(maxStickError(model, state), 1e-6);
  }
}

TEST(FallScene, OnlyTheFootThatSlipsStandsOnWhatIsSmooth) {
  for (const char* foot : {"left_foot", "right_foot"}) {
    Fall fall = fallOf("slip", "standing");
    fall.foot = foot;
    fall.foot_friction = 0.05;
    const FallScene made = madeOf(fall);
    const ObstacleSpec& smooth = made.scene.obstacles.at(1);
    EXPECT_EQ(smooth.friction, 0.05);
    EXPECT_EQ(made.scene.obstacles[0].friction, fall.friction);
    EXPECT_EQ(made.floors, 2);
    const Model model = buildModel(made.scene);
    const State state = startState(model);
    for (const char* each : {"left_foot", "right_foot"}) {
      const Vec3 at = state.x.col(model.skeletons[0].particle(each));
      EXPECT_EQ(heightAt(made.scene, at.x(), at.y()) > 0, each == std::string(foot)) << each;
    }
  }
}

TEST(FallScene, HasTheSettingsOfADataSet) {
  const Scene scene = madeOf(fallOf("faint", "standing")).scene;
  EXPECT_EQ(scene.solver.preset, "balanced");
  EXPECT_EQ(scene.solver.step, kSceneStep);
  EXPECT_EQ(scene.solver.joint_damping, 2);
  EXPECT_TRUE(scene.self_collision);
  EXPECT_EQ(scene.gravity, Vec3(0, 0, -9.81));
}

TEST(FallScene, WalksWhereItLooks) {
  Fall fall = fallOf("trip", "standing");
  fall.foot = "left_foot";
  fall.yaw = 90;
  fall.pitch = 8;  // leans, but goes on level
  fall.speed = 1.5;
  const RagdollSpec body = madeOf(fall).scene.ragdolls[0];
  EXPECT_LT((body.velocity - Vec3(0, 1.5, 0)).norm(), 1e-12);
  const Vec3 up = body.pose.orientation * Vec3::UnitZ();
  EXPECT_LT((up - Vec3(0, std::sin(8 * M_PI / 180), std::cos(8 * M_PI / 180))).norm(), 1e-12);
}

TEST(FallScene, BeginsWithNothingInAnythingElse) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {  // every kind
    const Fall fall = drawFall(seed);
    const Model model = buildModel(madeOf(fall).scene);
    const bool seat = fall.start == "sitting" || fall.start == "chair";
    const double most = seat ? 5e-3 : 1e-3;  // [m] hands of small bodies hang at its sides
    EXPECT_LT(maxPenetration(model, startState(model)), most) << seed << fall.kind << fall.start;
  }
}

}  // namespace
}  // namespace ragdoll::falls
