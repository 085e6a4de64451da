// Joint angles as they are published against the limits of the model file, over random falls.
#include <gtest/gtest.h>

#include "ragdoll_sim/body/angles.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/start_state.h"
#include "support/falls.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(JointAngles, OfHingesStayInTheRangesThatTheLimitsKeep) {
  std::mt19937 random(7);
  double largest = 0;
  for (int fall = 0; fall < samples(40); ++fall) {
    World world(randomFall(fall % 2 ? "stairs" : "between_objects", random));
    FrameTracker tracker(world.model);
    tracker.reset(world.state);
    const JointAngles angles(world.model, tracker);
    std::vector<double> values;
    for (int i = 0; i < 500; ++i) {
      world.steps(1);
      tracker.update(world.state);
      angles.compute(tracker.now(), values);
      const double slack = 2 * maxLimitViolation(world.model, world.state) + 1e-6;
      for (const Joint& joint : world.model.skeletons[0].joints) {
        if (joint.type != JointSpec::Type::kHinge) continue;
        const auto& names = angles.names();
        const auto at = std::find(names.begin(), names.end(), joint.name + "_y");
        ASSERT_NE(at, names.end());
        const double value = values[at - names.begin()];
        ASSERT_GT(value, joint.range.begin - slack) << joint.name << " of fall " << fall;
        ASSERT_LT(value, joint.range.end + slack) << joint.name << " of fall " << fall;
        largest = std::max(largest, value - joint.range.end);
      }
    }
  }
  EXPECT_GT(largest, -1e-3) << "no limit was reached";
}

/// Turns the child of a joint about where it hangs; shared particles stay.
Points turnedChild(const Skeleton& s, const Joint& joint, const Vec3& axis, double angle) {
  const Segment &parent = s.segments[joint.parent], &child = s.segments[joint.child];
  const auto is_shared = [&](int i) {
    return std::count(parent.particles.begin(), parent.particles.end(), i) > 0;
  };
  const int at = *std::find_if(child.particles.begin(), child.particles.end(), is_shared);
  Points x = s.rest;
  for (const int i : child.particles)
    if (!is_shared(i))
      x.col(i) = x.col(at) + Eigen::AngleAxisd(angle, axis) * Vec3(x.col(i) - x.col(at));
  return x;
}

/// < 0 outside the joint's limit, > 0 inside.
double roomOf(const Skeleton& s, int joint, const Points& x) {
  double room = 10;
  for (const Limit& limit : s.limits)
    if (limit.joint == joint) room = std::min(room, limitValue(limit, x.data()));
  return room;
}

struct AtLimit {
  const char* model;
  const char* angle;  ///< as published
  Vec3 axis;          ///< to turn the child about
  double degrees;     ///< of the limit
  int direction = 1;  ///< of the turn
};

/// The child turned until its limit is reached: the published angle is then the file's number.
TEST(JointAngles, AtALimitAreTheLimitsOwnNumbers) {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  for (const AtLimit& c :
       std::vector<AtLimit>{{"human", "neck_swing", y, 45, 1},
                            {"human", "neck_swing", x, 45, 1},
                            {"human", "neck_swing", Vec3(1, 1, 0).normalized(), 45, -1},
                            {"human", "left_shoulder_swing", y, 100, 1},
                            {"human", "right_shoulder_swing", x, 100, -1},
                            {"human", "left_leg_swing", y, 65, -1},
                            {"human", "left_leg_swing", x, 65, 1},
                            {"human", "right_elbow_y", y, 145, -1},
                            {"human", "left_knee_y", y, 140, 1},
                            {"human", "hips_y", y, 60, -1},
                            {"human", "hips_y", y, -25, 1},
                            {"human_thesis", "left_elbow_yz", y, 130, -1},
                            {"human_thesis", "right_elbow_yz", y, 10, 1},
                            {"human_thesis", "right_knee_yz", y, -135, 1},
                            {"human_thesis", "right_knee_xz", z, 225, 1},
                            {"human_thesis", "left_knee_xz", z, 315, 1},
                            {"human_thesis", "left_elbow_xz", z, 150, 1},
                            {"human_thesis", "right_elbow_xz", z, 35, 1},
                            {"human_thesis", "right_shoulder_xy", y, 120, -1},
                            {"human_thesis", "left_shoulder_xz", y, 225, 1},
                            {"human_thesis", "neck_xy", x, 135, 1},
                            {"human_thesis", "neck_yz", y, 299, -1}}) {
    const Model model = buildModel(parseScene("ragdolls: [{model: " + std::string(c.model) + "}]"));
    const Skeleton& s = model.skeletons[0];
    const std::string name = c.angle;
    const int j = s.joint(name.substr(0, name.rfind('_')));
    ASSERT_GE(j, 0) << name;
    const auto pose = [&](double t) {
      return turnedChild(s, s.joints[j], c.axis, c.direction * t);
    };
    double inside = 0, outside = 0.01;
    while (outside < 3 && roomOf(s, j, pose(outside)) >= 0) outside += 0.01;
    ASSERT_LT(outside, 3) << c.model << " " << name;
    for (int i = 0; i < 60; ++i) {
      const double middle = (inside + outside) / 2;
      (roomOf(s, j, pose(middle)) >= 0 ? inside : outside) = middle;
    }
    FrameTracker tracker(model);
    State state = startState(model);
    state.x = pose(outside);
    tracker.reset(state);
    const JointAngles angles(model, tracker);
    std::vector<double> values;
    angles.compute(tracker.now(), values);
    const auto at = std::find(angles.names().begin(), angles.names().end(), name);
    ASSERT_NE(at, angles.names().end()) << c.model << " " << name;
    EXPECT_NEAR(values[at - angles.names().begin()] * 180 / M_PI, c.degrees, 1e-6)
        << c.model << " " << name << " about " << c.axis.transpose();
  }
}

TEST(JointAngles, NamesOfEveryKindOfJoint) {
  const auto names = [](const std::string& model) {
    const Model m = buildModel(parseScene("ragdolls: [{model: " + model + "}]"));
    return JointAngles(m, FrameTracker(m)).names();
  };
  const auto of = [](const std::vector<std::string>& all, const std::string& joint) {
    std::vector<std::string> out;
    for (const std::string& n : all)
      if (n.substr(0, n.rfind('_')) == joint) out.push_back(n.substr(n.rfind('_') + 1));
    return out;
  };
  using Names = std::vector<std::string>;
  const Names human = names("human"), thesis = names("human_thesis");
  EXPECT_EQ(of(human, "left_shoulder"), (Names{"x", "y", "z", "swing"}));
  EXPECT_EQ(of(human, "left_elbow"), (Names{"y"}));
  EXPECT_EQ(of(thesis, "left_shoulder"), (Names{"x", "y", "z", "xy", "yz", "xz"}));
  EXPECT_EQ(of(thesis, "left_leg"), (Names{"x", "y", "z", "xy", "yz", "xz"}));
  EXPECT_EQ(of(thesis, "left_elbow"), (Names{"yz", "xz"}));
  EXPECT_EQ(of(thesis, "right_knee"), (Names{"yz", "xz"}));
}

}  // namespace
}  // namespace ragdoll
