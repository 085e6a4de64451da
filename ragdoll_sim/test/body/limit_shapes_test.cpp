#include "ragdoll_sim/body/limit_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "human_model.h"
#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll::test {
namespace {

struct HumanWithLimits {
  Model model = modelOf(humanSkeleton());
  FrameTracker tracker{model};

  CoatShape shape(const Points& x, const std::string& name) {
    tracker.reset(stateOf(x));
    for (const CoatShape& s : limitShapes(model, tracker, tracker.now(), 0))
      if (s.name == name) return s;
    ADD_FAILURE() << "no shape " << name;
    return CoatShape();
  }
  Vec3 ray(const Points& x, const std::string& name) {
    const CoatShape s = shape(x, name);
    return (s.points.col(1) - s.points.col(0)).normalized();
  }
  const Skeleton& skeleton() const { return model.skeletons[0]; }
};

TEST(LimitShapes, KneeBeginsStraightAndEndsBent) {
  HumanWithLimits human;
  const Points& rest = human.skeleton().rest;
  const double end = 2.5;  // of the fixture's hinges
  EXPECT_LT((human.ray(rest, "left_knee/begin") - Vec3(0, 0, -1)).norm(), 1e-9);
  EXPECT_LT((human.ray(rest, "left_knee/end") - Vec3(-std::sin(end), 0, -std::cos(end))).norm(),
            1e-9);
  const CoatShape region = human.shape(rest, "left_knee/region");
  EXPECT_LT((region.mesh.vertices.col(0) - rest.col(human.skeleton().particle("left_knee"))).norm(),
            1e-12);
}

TEST(LimitShapes, BoneLiesInItsFan) {
  HumanWithLimits human;
  const Points x =
      posed(human.skeleton(), {{"pelvis", turn({1, 1, 1}, 2)},
                               {"right_shoulder", turn({0, -1, 0}, 1) * turn({0, 0, 1}, 0.5)},
                               {"right_elbow", turn({0, -1, 0}, 1.25)}});
  const CoatShape fan = human.shape(x, "right_elbow/region");
  const Vec3 elbow = x.col(human.skeleton().particle("right_elbow"));
  const Vec3 bone = (Vec3(x.col(human.skeleton().particle("right_hand"))) - elbow).normalized();
  double nearest =
      10;  // the arm hangs 15 degrees off the hinge's plane, so the fan is off by as much
  for (int i = 1; i < fan.mesh.vertices.cols(); ++i)
    nearest =
        std::min(nearest, angleBetween(bone, (fan.mesh.vertices.col(i) - elbow).normalized()));
  EXPECT_LT(nearest, 2.5 / 32);  // one blade of the fan
}

TEST(LimitShapes, ConeHasItsHalfAngle) {
  HumanWithLimits human;
  const Quat q = turn({1, -1, 0.3}, 1.4);
  const Points x = posed(human.skeleton(), {{"pelvis", q}});
  const CoatShape rim = human.shape(x, "neck/rim");
  const Vec3 neck = x.col(human.skeleton().particle("neck"));
  for (int i = 0; i < rim.points.cols(); ++i)
    EXPECT_NEAR(angleBetween(q * Vec3::UnitZ(), (rim.points.col(i) - neck).normalized()), 0.7,
                1e-9);
  EXPECT_TRUE(isClosed(human.shape(x, "neck/region").mesh));
  EXPECT_GT(volume(human.shape(x, "neck/region").mesh), 0);
}

TEST(LimitShapes, ThesisShoulderIsMirrored) {
  HumanWithLimits human;
  const Points& rest = human.skeleton().rest;
  // xy begins hanging down; the right arm's region ends to the right, the left one's to the left.
  EXPECT_LT((human.ray(rest, "right_shoulder/xy/begin") - Vec3(0, 0, -1)).norm(), 1e-9);
  EXPECT_LT(human.ray(rest, "right_shoulder/xy/end").y(), -0.8);
  EXPECT_GT(human.ray(rest, "left_shoulder/xy/end").y(), 0.8);
}

TEST(LimitShapes, HipsHaveAFan) {
  HumanWithLimits human;
  const CoatShape fan = human.shape(human.skeleton().rest, "hips/region");
  EXPECT_LT(Vec3(fan.mesh.vertices.col(0)).norm(), 1e-12);
}

}  // namespace
}  // namespace ragdoll::test
