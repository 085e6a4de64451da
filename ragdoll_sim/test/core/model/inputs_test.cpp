#include "ragdoll_sim/core/inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "support/error_of.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

int activeSteps(double start, double duration, double h) {
  Poke poke;
  poke.start = start;
  poke.duration = duration;
  int n = 0;
  for (int i = 0; i < 1000; ++i) n += isActive(poke, i * h, h);
  return n;
}

TEST(Poke, LastsWholeStepsAtLeastOne) {
  EXPECT_EQ(activeSteps(0.5, 0, 0.01), 1);
  EXPECT_EQ(activeSteps(0.5, 0.001, 0.01), 1);
  EXPECT_EQ(activeSteps(0.5, 0.034, 0.01), 3);
  EXPECT_EQ(activeSteps(0.5, 0.036, 0.01), 4);
  EXPECT_EQ(activeSteps(0.5, -1, 0.01), 950);
  EXPECT_EQ(activeSteps(-3, 0, 0.01), 1);
}

SkeletonSpec triangle() {
  SkeletonSpec s;
  s.particles = {particle("a", Vec3::Zero()), particle("b", Vec3(1, 0, 0)),
                 particle("c", Vec3(0, 2, 0.5))};
  s.sticks = {stick("a", "b"), stick("b", "c"), stick("c", "a")};
  SegmentSpec group = bone("abc", "a", "b");
  group.particles.push_back("c");
  group.group = true;
  s.segments = {group, bone("ab", "a", "b")};
  return s;
}

TEST(Poke, OnPointsAllButInLineHasForcesOfItsSize) {
  World world(sceneOf(triangle()));
  Poke poke;
  poke.body = findBody(world.model, "abc");
  poke.force = Vec3(5, 20, -10);
  poke.point = Vec3(0.3, 0.2, 0.4);
  for (const double bent : {0.0, 1e-6, 1e-4, 1e-3}) {  // as the relaxation leaves them
    world.state.x.setZero();
    world.state.x.row(0) << 0, 1, 0.3;
    world.state.x(2, 2) = bent;
    Points forces = Points::Zero(3, 3);
    addForce(poke, world.state, forces);
    EXPECT_LT(forces.colwise().norm().maxCoeff(), 3 * poke.force.norm()) << bent;
  }
}

TEST(Poke, SaysWhatOfItsMomentHasNoEffect) {
  Scene scene = sceneOf(triangle());
  World world(scene);
  Poke poke;
  poke.force = Vec3(0, 0, 3);
  poke.point = Vec3(0.3, -0.2, 0);  // moment (-0.6, -0.9, 0)
  poke.body = findBody(world.model, "abc");
  EXPECT_EQ(lostMomentText(poke, world.state.x), "");
  poke.body = findBody(world.model, "ab");  // along x
  EXPECT_THAT(lostMomentText(poke, world.state.x), StartsWith("0.6 N m of its moment of 1.082"));
  poke.body = findBody(world.model, "a");
  EXPECT_THAT(lostMomentText(poke, world.state.x), HasSubstr("a particle takes none"));
  PokeSpec spec;
  spec.body = "ab";
  spec.force = poke.force;
  spec.point = poke.point;
  spec.where = "scene.yaml: pokes[0]";
  scene.pokes = {spec};
  EXPECT_THAT(buildModel(scene).warnings,
              ::testing::Contains(StartsWith("scene.yaml: pokes[0] on 'ab': 0.6 N m")));
}

TEST(Poke, OnAGroupHasTheForceAndTheMomentOfItsPoint) {
  World world(sceneOf(triangle()));
  Poke poke;
  poke.body = findBody(world.model, "abc");
  poke.force = Vec3(1, 2, 3);
  poke.point = Vec3(0.3, -0.2, 0.5);
  Points forces = Points::Zero(3, 3);
  addForce(poke, world.state, forces);
  const Vec3 centre = world.state.x.rowwise().mean();
  Vec3 moment = Vec3::Zero();
  for (int i = 0; i < 3; ++i) moment += (world.x(i) - centre).cross(Vec3(forces.col(i)));
  EXPECT_LT((forces.rowwise().sum() - poke.force).norm(), 1e-14);
  EXPECT_LT((moment - poke.point.cross(poke.force)).norm(), 1e-13);
}

TEST(Poke, ForcesHaveTheSameSumInWhateverOrderTheyCame) {
  World world(sceneOf(triangle()));
  const double h = 0.01;
  std::vector<Poke> pokes(4);
  const double forces[] = {1e16, 1, -1e16, 1};  // a sum that depends on the order
  for (std::size_t i = 0; i < pokes.size(); ++i) {
    pokes[i].body = findBody(world.model, "a");
    pokes[i].body_name = "a";
    pokes[i].force.x() = forces[i];
    pokes[i].start = i < 2 ? 0.3 : 0.1 + 0.2;  // the same step, not the same number
    pokes[i].point.z() = i == 3;
  }
  std::vector<std::size_t> order{0, 1, 2, 3};
  std::set<double> sums, sorted_sums;
  do {
    std::vector<Poke> given;
    for (const std::size_t i : order) given.push_back(pokes[i]);
    const auto sum = [&] {
      Points total = Points::Zero(3, 3);
      for (const Poke& poke : given) addForce(poke, world.state, total);
      return total(0, 0);
    };
    sums.insert(sum());
    std::sort(given.begin(), given.end(),
              [&](const Poke& a, const Poke& b) { return actsBefore(a, b, h); });
    sorted_sums.insert(sum());
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_GT(sums.size(), 1u);
  EXPECT_EQ(sorted_sums.size(), 1u);
}

TEST(Poke, OnABoneHasNoMomentAboutTheBone) {
  World world(sceneOf(triangle()));
  Poke poke;
  poke.body = findBody(world.model, "ab");
  poke.force = Vec3(0, 0, 1);
  poke.point = Vec3(0.2, 0.7, 0);
  Points forces = Points::Zero(3, 3);
  addForce(poke, world.state, forces);
  // Moment about y only: -0.2; 1 m long, so +-0.2 N on top of one half each.
  EXPECT_LT((forces.col(0) - Vec3(0, 0, 0.3)).norm(), 1e-14);
  EXPECT_LT((forces.col(1) - Vec3(0, 0, 0.7)).norm(), 1e-14);
}

TEST(Poke, ThatNumbersCannotFollowIsRefusedWithTheLargestAllowed) {
  Scene scene = sceneOf(oneStick(1, 3));
  PokeSpec spec;
  spec.body = "a";
  spec.where = "pokes[0]";
  spec.force = Vec3(0, 0, 1.1e10 * 4 / scene.solver.step);  // 4 kg at 1e10 m/s after a step
  scene.pokes = {spec};
  EXPECT_THAT(errorOf([&] { buildModel(scene); }),
              AllOf(StartsWith("pokes[0]: force: "), HasSubstr("at most")));
  scene.pokes[0].force *= 0.8;
  World world(scene);
  world.steps(1);
  EXPECT_NEAR(momentum(world.model, world.state).z(), 3.52e10, 1e3);
  scene.pokes[0].body = "ab";  // whose moment counts, too
  scene.pokes[0].point = Vec3(0, 1000, 0);
  EXPECT_THROW(buildModel(scene), Error);
}

TEST(Poke, WhoseSquareOverflowsIsRefusedWithTheLargestAllowed) {
  Scene scene = sceneOf(oneStick(1, 3));
  PokeSpec spec;
  spec.body = "a";
  spec.force = Vec3(0, 0, 1e308);
  scene.pokes = {spec};
  char most[40];  // 4 kg at 1e10 m/s after a step
  std::snprintf(most, sizeof most, "at most %.3g N", 1e10 * 4 / scene.solver.step);
  EXPECT_THAT(errorOf([&] { buildModel(scene); }), HasSubstr(most));
}

TEST(FindBody, ListsWhatThereIs) {
  World world(sceneOf(triangle()));
  EXPECT_EQ(findBody(world.model, "ragdoll/b").particles, std::vector<int>{1});
  for (const char* name : {"wing", "ragdoll/wing"}) {
    try {
      findBody(world.model, name);
      ADD_FAILURE() << "found " << name;
    } catch (const std::exception& e) {
      EXPECT_NE(std::string(e.what()).find("a, b, c, abc, ab"), std::string::npos) << e.what();
    }
  }
  EXPECT_THROW(findBody(world.model, "other/b"), std::exception);
}

}  // namespace
}  // namespace ragdoll
