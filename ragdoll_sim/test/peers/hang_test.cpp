// The whole human hung by one hand, joints free, against MuJoCo with the same masses, centres of
// mass and inertias. Built where libmujoco-dev is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/mujoco_simulation.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kSeconds = 1;
constexpr int kMujocoRate = 4000;  ///< [Hz] of the finer of its two runs

Vec3& positionOf(SkeletonSpec& skeleton, const std::string& name) {
  return std::find_if(skeleton.particles.begin(), skeleton.particles.end(),
                      [&](const ParticleSpec& p) { return p.name == name; })
      ->position;
}

/// The shipped scene, in which the body lies in the air; or upright with its arms spread.
Scene hang(bool arms_spread) {
  Scene scene = loadScene("hang");
  auto skeleton = std::make_shared<SkeletonSpec>(*scene.ragdolls[0].skeleton);
  skeleton->joints.clear();
  if (arms_spread) {
    scene.ragdolls[0].pose.orientation = Quat::Identity();
    for (const std::string side : {"left", "right"}) {
      const Vec3 out = (side == "left" ? 1 : -1) * Vec3::UnitY();
      const Vec3 shoulder = positionOf(*skeleton, side + "_shoulder");
      Vec3 &elbow = positionOf(*skeleton, side + "_elbow"),
           &hand = positionOf(*skeleton, side + "_hand");
      const double forearm = (hand - elbow).norm();
      elbow = shoulder + (elbow - shoulder).norm() * out;
      hand = elbow + forearm * out;
    }
  }
  scene.ragdolls[0].skeleton = skeleton;
  return scene;
}

/// Particles after kSeconds; `spin` multiplies the bones' inertia about their own axes.
Points byMujoco(const Scene& scene, int rate, double spin = 1) {
  RigidScene rigid = rigidScene(scene, buildModel(scene), false);
  for (RigidBody& body : rigid.bodies)
    if (body.particles.size() == 2) body.moments.z() *= spin;
  MujocoSimulation mujoco(rigid, 1.0 / rate, "RK4");
  for (int i = 0; i < kSeconds * rate; ++i) mujoco.step();
  mujoco.settle();
  Points x(3, rigid.rest.cols());
  for (int i = 0; i < static_cast<int>(rigid.bodies.size()); ++i)
    for (const int p : rigid.bodies[i].particles) x.col(p) = rigid.particleOf(i, p, mujoco.pose(i));
  return x;
}

/// Its RK4 is of second order with ball joints: two runs give the limit.
Points limitOfMujoco(const Scene& scene) {
  const Points fine = byMujoco(scene, kMujocoRate), coarse = byMujoco(scene, kMujocoRate / 2);
  return fine + (fine - coarse) / 3;
}

Points byUs(Scene scene, Method method, int rate) {
  scene.solver.method = method;
  scene.solver.step = 1.0 / rate;
  World world(scene);
  world.steps(static_cast<int>(kSeconds * rate));
  return world.state.x.leftCols(world.model.skeletons[0].named);
}

/// [m] of the particle that is furthest off
double worst(const Points& a, const Points& b) { return (a - b).colwise().norm().maxCoeff(); }

class HangByAHand : public testing::TestWithParam<bool> {};

TEST_P(HangByAHand, MujocoHasTheWholeMassAndConvergesAtSecondOrder) {
  const Scene scene = hang(GetParam());
  const Model model = buildModel(scene);
  double mass = 0;
  for (const RigidBody& body : rigidScene(scene, model, false).bodies) mass += body.mass;
  EXPECT_NEAR(mass, model.skeletons[0].M.sum(), 1e-12);
  const Points limit = limitOfMujoco(scene);
  const double coarse = worst(byMujoco(scene, 500), limit);
  EXPECT_NEAR(std::log2(coarse / worst(byMujoco(scene, 1000), limit)), 2, 0.3);
  EXPECT_GT(worst(limit, startState(model).x.leftCols(limit.cols())), 0.5);  // it has moved
}

TEST_P(HangByAHand, InertiaOfABoneAboutItselfMakesNoDifference) {
  const Scene scene = hang(GetParam());
  const auto change = [&](int rate) {
    return worst(byMujoco(scene, rate, 0.1), byMujoco(scene, rate));
  };
  const double coarse = change(1000);  // only as much as MuJoCo's step errs
  EXPECT_LT(coarse, 1e-5);
  EXPECT_NEAR(std::log2(coarse / change(2000)), 2, 0.3);
}

TEST_P(HangByAHand, RungeKuttaEndsWhereMujocoDoes) {
  const Scene scene = hang(GetParam());
  const Points limit = limitOfMujoco(scene);
  EXPECT_LT(worst(byUs(scene, Method::kRk, 240), limit), 2e-4);
  EXPECT_LT(worst(byUs(scene, Method::kRk, 1000), limit), 2e-7);
}

TEST_P(HangByAHand, ShakeConvergesToMujocoAtSecondOrder) {
  const Scene scene = hang(GetParam());
  const Points limit = limitOfMujoco(scene);
  const double at_1000 = worst(byUs(scene, Method::kShake, 1000), limit);
  // Lying, the body falls further before the hand holds it: 5.5e-4 m.
  EXPECT_LT(at_1000, GetParam() ? 2e-4 : 8e-4);
  EXPECT_NEAR(std::log2(at_1000 / worst(byUs(scene, Method::kShake, 2000), limit)), 2, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Starts, HangByAHand, testing::Bool(),
                         [](const testing::TestParamInfo<bool>& info) {
                           return info.param ? "ArmsSpread" : "Lying";
                         });

}  // namespace
}  // namespace ragdoll
