// Bodies that touch bodies: momentum, rest at the sum of radii, no way through, arms stay outside.
#include "support/pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/contact/capsule_pairs.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/self_pairs.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double kPairRadius = 0.05;

class Pairs : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, Pairs, testing::Values(Method::kJakobsen, Method::kShake),
                         [](const auto& info) {
                           return info.param == Method::kShake ? "shake" : "jakobsen";
                         });

/// Two sticks of 1 m along x and y that meet head-on along z at `speed` each, their middles, or
/// `offset` from the upper one's.
Scene headOn(Method method, double speed, double offset = 0) {
  Scene scene = sceneOf(oneStick(1, 1, kPairRadius), Vec3(offset - 0.5, 0, 0.5));
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[0].velocity = Vec3(0, 0, -speed);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].pose.position = Vec3(0, -0.5, -0.5);
  scene.ragdolls[1].pose.orientation = Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()));
  scene.ragdolls[1].velocity = Vec3(0, 0, speed);
  scene.gravity.setZero();
  scene.ragdoll_collision = true;
  scene.solver.method = method;
  return scene;
}

Vec3 momentumOf(const World& world) {
  Vec3 sum = Vec3::Zero();
  for (const Ragdoll& r : world.model.ragdolls) {
    const Skeleton& s = world.model.skeletonOf(r);
    sum += (world.state.v.middleCols(r.first, s.size()) * s.M).rowwise().sum();
  }
  return sum;
}

double gapBetween(const World& world) {
  const auto axisOf = [&](int r) {
    const int first = world.model.ragdolls[r].first;
    return CapsuleAxis{world.x(first), world.x(first + 1), kPairRadius, kPairRadius};
  };
  const CapsuleAxis a = axisOf(0), b = axisOf(1);
  return gapAt(a, b, nearestPoints(a, b));
}

TEST_P(Pairs, HeadOnConservesMomentumAndDoesNotPassThrough) {
  for (const double speed : {1.0, 10.0, 100.0}) {
    World world(headOn(GetParam(), speed));
    const Vec3 before = momentumOf(world);
    for (int i = 0; i < 60; ++i) {
      world.steps(1);
      const double above = 0.5 * (world.x(0).z() + world.x(1).z());
      const double below = 0.5 * (world.x(2).z() + world.x(3).z());
      ASSERT_GT(above - below, 0) << speed << " m/s, step " << i;
      EXPECT_GT(gapBetween(world), -1e-4) << speed << " m/s, step " << i;
    }
    EXPECT_NEAR(world.v(0).z() - world.v(2).z(), 0, 1e-6 * speed) << "plastic, " << speed;
    EXPECT_LT((momentumOf(world) - before).norm(), 1e-12 * speed) << speed;
  }
}

TEST_P(Pairs, EccentricHitConservesMomentum) {
  for (const double speed : {1.0, 10.0, 100.0}) {
    Scene scene = headOn(GetParam(), speed, 0.3);
    scene.ragdolls[1].skeleton =
        std::make_shared<const SkeletonSpec>(oneStick(0.5, 3, kPairRadius));
    World world(scene);
    const Vec3 before = momentumOf(world);
    world.steps(60);
    EXPECT_GT(std::abs(world.v(0).z() - world.v(1).z()), 0.01 * speed);  // it turns
    EXPECT_LT((momentumOf(world) - before).norm(), 1e-12 * 10 * speed) << speed;
  }
}

TEST_P(Pairs, WithoutTheFlagBodiesPassThroughEachOther) {
  Scene scene = headOn(GetParam(), 1);
  scene.ragdoll_collision = false;
  World world(scene);
  world.steps(60);
  EXPECT_LT(world.x(0).z(), world.x(2).z());
}

TEST_P(Pairs, CrosswiseRestAtTheSumOfRadii) {
  Scene scene = headOn(GetParam(), 0);
  scene.ragdolls[0].pose.position.z() = 0.3;
  scene.ragdolls[1].pose.position.z() = 0.1;
  scene.gravity = Vec3(0, 0, -9.81);
  scene.obstacles = {floorPlane(0.6)};
  scene.solver.step = 1.0 / 240;
  World world(scene);
  world.steps(3 * 240);
  EXPECT_NEAR(0.5 * (world.x(2).z() + world.x(3).z()), kPairRadius, 1e-4);
  EXPECT_NEAR(gapBetween(world), 0, 5e-4);
}

TEST_P(Pairs, ABodyThatLandsOnASleeperWakesIt) {
  Scene scene = headOn(GetParam(), 0);
  scene.ragdolls[0].pose.position.z() = 3;
  scene.ragdolls[1].pose.position.z() = kPairRadius;
  scene.gravity = Vec3(0, 0, -9.81);
  scene.obstacles = {floorPlane(0.6)};
  scene.solver.step = 1.0 / 240;
  World world(scene);
  world.steps(170);
  ASSERT_TRUE(world.state.asleep[1]);  // the upper one is on its way
  ASSERT_FALSE(world.state.asleep[0]);
  bool woke = false;
  for (int i = 0; i < 40; ++i) {
    world.steps(1);
    woke = woke || !world.state.asleep[1];
  }
  EXPECT_TRUE(woke);
  world.steps(5 * 240);
  EXPECT_TRUE(world.state.asleep[0] && world.state.asleep[1]);  // and both come to rest
  EXPECT_NEAR(gapBetween(world), 0, 1e-3);
}

/// Two sticks, one crosswise on the other on the floor.
Scene crosswise(Method method) {
  Scene scene = headOn(method, 0);
  scene.ragdolls[0].pose.position.z() = 3.05 * kPairRadius;
  scene.ragdolls[1].pose.position.z() = 1.05 * kPairRadius;
  scene.gravity = Vec3(0, 0, -9.81);
  scene.obstacles = {floorPlane(0.6)};
  scene.solver.step = 1.0 / 240;
  return scene;
}

TEST_P(Pairs, BodiesThatLieOnEachOtherFallAsleepTogether) {
  Scene scene = crosswise(GetParam());
  scene.ragdolls[0].velocity = Vec3(0, 1, 0);  // the upper one slides for a while
  World world(scene);
  for (int i = 0; i < 5 * 240; ++i) {
    world.steps(1);
    ASSERT_EQ(world.state.asleep[0], world.state.asleep[1]) << "step " << i;
  }
  EXPECT_TRUE(world.state.asleep[0]);
}

TEST_P(Pairs, AllOfAPileWakeWhenOneIsPoked) {
  for (const char* body : {"ragdoll/ab", "other/ab"}) {
    World world(crosswise(GetParam()));
    world.steps(3 * 240);
    ASSERT_TRUE(world.state.asleep[0] && world.state.asleep[1]);
    Poke poke;
    poke.body = findBody(world.model, body);
    poke.start = world.state.time;
    poke.force = Vec3(30, 30, 0);
    world.inputs.pokes = {poke};
    world.steps(1);
    EXPECT_FALSE(world.state.asleep[0] || world.state.asleep[1]) << body;
  }
}

Scene humanFall(Method method, double step, const std::string& more = "") {
  Scene scene = parseScene(
      "ragdolls: [{name: r, model: human, position: [0, 0, 1.3], rpy_deg: [15, 30, 10]}]\n"
      "obstacles: [{type: plane, friction: 0.6}]\n" +
          more,
      "test");
  scene.solver.method = method;
  scene.solver.step = step;
  return scene;
}

/// The side of the torso's plane (shoulders, hips) is what an arm that crosses it changes, within
/// the torso's outline.
bool armCrossesTorso(const World& world) {
  const Skeleton& s = world.model.skeletons[0];
  const auto at = [&](const char* name) { return world.x(s.particle(name)); };
  const auto crosses = [&](const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q,
                           const Vec3& r) {
    const Vec3 n = (q - p).cross(r - p);
    const double da = n.dot(a - p), db = n.dot(b - p);
    if (da * db >= 0) return false;
    const Vec3 x = a + da / (da - db) * (b - a);
    return n.dot((q - p).cross(x - p)) > 0 && n.dot((r - q).cross(x - q)) > 0 &&
           n.dot((p - r).cross(x - r)) > 0;
  };
  const Vec3 ls = at("left_shoulder"), rs = at("right_shoulder"), lh = at("left_hip"),
             rh = at("right_hip");
  for (const auto& [a, b] : {std::pair("left_elbow", "left_hand"), {"right_elbow", "right_hand"}})
    if (crosses(at(a), at(b), ls, rs, lh) || crosses(at(a), at(b), rs, rh, lh)) return true;
  return false;
}

struct Setting {
  Method method;
  int rate;           ///< [Hz]
  double self_mm;     ///< overlap that limbs of one body may reach for a moment,
  double between_mm;  ///< and of two that meet at 6 m/s
};

class HumanPairs : public testing::TestWithParam<Setting> {
 protected:
  Scene fall(const std::string& more = "") const {
    return humanFall(GetParam().method, 1.0 / GetParam().rate, more);
  }
};
INSTANTIATE_TEST_SUITE_P(Settings, HumanPairs,
                         testing::Values(Setting{Method::kShake, 60, 4, 4},
                                         Setting{Method::kShake, 120, 4, 4},
                                         Setting{Method::kShake, 240, 4, 4},
                                         Setting{Method::kJakobsen, 60, 20, 80},
                                         Setting{Method::kJakobsen, 240, 20, 20}),
                         [](const auto& info) {
                           const bool shake = info.param.method == Method::kShake;
                           return (shake ? "shake" : "jakobsen") + std::to_string(info.param.rate);
                         });

/// What a falling human's limbs do to it in 4 s.
struct LimbRecord {
  int crossings = 0;      ///< steps in which an arm is through the torso
  double overlap_mm = 0;  ///< worst of all steps
};

/// Falls from some poses, each as the scene says but for whether limbs touch.
LimbRecord watchLimbs(Scene scene, int rate, bool touch) {
  LimbRecord record;
  for (const Vec3& axis : {Vec3(1, 2, 0.5), Vec3(1, 0, 0), Vec3(-1, 1, 0), Vec3(0, -1, 0)}) {
    scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(0.6, axis.normalized()));
    World world(scene);
    world.model.self_collision = touch;
    for (int i = 0; i < 4 * rate; ++i) {
      world.steps(1);
      record.crossings += armCrossesTorso(world);
      record.overlap_mm = std::max(record.overlap_mm, 1e3 * deepestSelfPair(world));
    }
  }
  return record;
}

TEST_P(HumanPairs, AFallingHumanKeepsItsLimbsApart) {
  const LimbRecord record = watchLimbs(fall("self_collision: true\n"), GetParam().rate, true);
  EXPECT_EQ(record.crossings, 0);
  EXPECT_LT(record.overlap_mm, GetParam().self_mm);
}

TEST_P(HumanPairs, WithoutTheFlagItsArmGoesThroughItsTorso) {
  const LimbRecord record = watchLimbs(fall("self_collision: true\n"), GetParam().rate, false);
  EXPECT_GT(record.crossings, 0);
  EXPECT_GT(record.overlap_mm, 20);
}

TEST_P(HumanPairs, HumansThatFallOntoEachOtherStayApart) {
  Scene scene = fall("self_collision: true\nragdoll_collision: true\n");
  for (int i = 1; i < 3; ++i) {
    scene.ragdolls.push_back(scene.ragdolls[0]);
    scene.ragdolls[i].name = "r" + std::to_string(i);
    scene.ragdolls[i].pose.position += Vec3(0.1 * i, 0.15 * (i % 2), 2.1 * i);
  }
  World world(scene);
  double between = 0, self = 0;
  for (int i = 0; i < 4 * GetParam().rate; ++i) {
    world.steps(1);
    between = std::max(between, 1e3 * deepestBetween(world));
    self = std::max(self, 1e3 * deepestSelfPair(world));
  }
  ASSERT_TRUE(world.state.x.allFinite());
  EXPECT_LT(between, GetParam().between_mm);
  EXPECT_LT(self, GetParam().self_mm);
  // Undamped, an arm may swing for long; of the 5 kJ that fell no more is left than that.
  EXPECT_LT(kineticEnergy(world.model, world.state), 5);
}

TEST(SelfPairs, OfTheHumanAreAsExpected) {
  const Model model = buildModel(humanFall(Method::kShake, 1.0 / 120, "self_collision: true\n"));
  const Skeleton& s = model.skeletons[0];
  EXPECT_EQ(s.capsules.size(), 24u);
  EXPECT_EQ(s.self_pairs.size() + s.left_out_pairs.size(), 24u * 23 / 2);
  const auto has = [&](const std::string& a, const std::string& b) {
    return std::any_of(s.self_pairs.begin(), s.self_pairs.end(), [&](const CapsulePair& p) {
      const std::string x = capsuleName(s, p.first), y = capsuleName(s, p.second);
      return (x == a && y == b) || (x == b && y == a);
    });
  };
  EXPECT_TRUE(has("left_elbow-left_hand", "left_hip-right_hip"));
  EXPECT_TRUE(has("left_elbow-left_hand", "right_shoulder-right_hip"));
  EXPECT_TRUE(has("left_knee-left_foot", "right_knee-right_foot"));
  EXPECT_TRUE(has("left_leg-left_knee", "right_leg-right_knee"));
  EXPECT_FALSE(has("left_shoulder-left_elbow", "left_elbow-left_hand"));  // share the elbow
  EXPECT_FALSE(has("neck-left_hip", "left_shoulder-right_hip"));          // both the torso's
  ASSERT_EQ(model.notes.size(), 1u);
  std::vector<std::string> lines;
  std::istringstream note(model.notes[0]);
  for (std::string line; std::getline(note, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(
      lines[0],
      "self collision of 'human': 159 pairs of sticks; left out: 76 that share a particle, 18 "
      "that are in one rigid group, 23 that overlap in the rest pose");
  EXPECT_EQ(inShort(model.notes[0]), lines[0]);
  EXPECT_THAT(lines[1], StartsWith("  share a particle: "));
  EXPECT_THAT(lines[2], StartsWith("  are in one rigid group: "));
  EXPECT_THAT(lines[3], StartsWith("  overlap in the rest pose: "));
  // Each by name under its reason.
  const auto listed = [&](std::size_t line, const std::string& a, const std::string& b) {
    for (const auto& [x, y] : {std::pair(a, b), std::pair(b, a)}) {
      const std::size_t at = lines[line].find(x + " with ");
      if (at == std::string::npos) continue;
      const std::string seconds = lines[line].substr(at, lines[line].find(';', at) - at) + ",";
      if (seconds.find(" " + y + ",") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(listed(1, "left_shoulder-left_elbow", "left_elbow-left_hand"));
  EXPECT_TRUE(listed(2, "neck-left_hip", "left_shoulder-right_hip"));
  EXPECT_TRUE(listed(3, "left_shoulder-left_hip", "left_leg-left_knee"));
  EXPECT_TRUE(listed(3, "left_hip-right_hip", "left_leg-left_knee"));
  EXPECT_TRUE(listed(3, "left_hip-right_hip", "right_leg-right_knee"));
  EXPECT_TRUE(listed(3, "left_shoulder-right_shoulder", "neck-head"));
  EXPECT_FALSE(listed(3, "neck-left_hip", "left_shoulder-right_hip"));
  EXPECT_THAT(lines[3], Not(HasSubstr("elbow")));  // no arm overlaps anything
}

TEST(SelfPairs, AreNotEvenLookedForUnlessTheSceneSaysSo) {
  const Model model = buildModel(humanFall(Method::kShake, 1.0 / 120));
  EXPECT_TRUE(model.skeletons[0].capsules.empty());
  EXPECT_TRUE(model.notes.empty());
}

}  // namespace
}  // namespace ragdoll
