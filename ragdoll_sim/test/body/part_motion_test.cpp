// Turns of one part whose answers are known by hand.
#include "ragdoll_sim/body/part_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame_law.h"
#include "human_model.h"

namespace ragdoll::test {
namespace {

constexpr double kExact = 1e-12;  ///< [rad], [m]

Part group(int particles) {
  Part part;
  part.group = true;
  for (int i = 0; i < particles; ++i) part.particles.push_back(i);
  return part;
}

/// Hangs down from the particle 0 to 1; may point anywhere but up.
Part limb() {
  Part part;
  part.particles = {0, 1};
  part.rest_direction = part.centre_direction = -Vec3::UnitZ();
  part.bend_axis = -Vec3::UnitY();
  return part;
}

TEST(SmallestRotation, TurnsAboutTheAxisAcrossBoth) {
  const Vec3 from(1, 0, 0), to(std::cos(0.7), std::sin(0.7), 0);
  EXPECT_LT(angle(smallestRotation(from, to, Vec3::UnitX()), turn({0, 0, 1}, 0.7)), kExact);
  EXPECT_LT(angle(smallestRotation(from, from, Vec3::UnitX()), Quat::Identity()), kExact);
}

TEST(SmallestRotation, OfOppositesIsHalfATurnAboutTheFallbackMadeSquare) {
  const Vec3 x = Vec3::UnitX();
  EXPECT_LT(angle(smallestRotation(x, -x, Vec3(5, 0, 2)), turn({0, 0, 1}, M_PI)), kExact);
  const Quat q = smallestRotation(x, -x, x);  // along both: any axis across
  EXPECT_LT((q * x + x).norm(), kExact);
}

TEST(Angles, AreExactWhereTheyAreSmall) {
  for (const double small : {1e-12, 1e-6, 1.0, 3.0}) {
    EXPECT_NEAR(angleOf(turn({1, 2, 3}, small)), small, 1e-15 + 1e-12 * small);
    const Vec3 b(std::cos(small), 0, std::sin(small));
    EXPECT_NEAR(angleBetween(Vec3::UnitX(), b), small, 1e-15 + 1e-12 * small);
  }
  Quat minus = turn({0, 0, 1}, 0.5);
  minus.coeffs() = -minus.coeffs();  // the same turn
  EXPECT_NEAR(angleOf(minus), 0.5, kExact);
}

TEST(GroupOrientation, IsTheTurnOfItsPoints) {
  Points solid(3, 4), flat(3, 3);
  solid << 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3;
  flat << 0, 1, 0, 0, 0, 2, 0, 0, 0;
  const Quat q = turn({1, -2, 0.5}, 2.5);
  for (const Points& rest : {solid, flat}) {
    const Part part = group(static_cast<int>(rest.cols()));
    // Twice as large: the fit of a rotation does not see it.
    const Points x = (2 * (q.toRotationMatrix() * rest)).colwise() + Vec3(3, 2, 1);
    EXPECT_LT(angle(groupOrientation(part, rest, x, q), q), kExact);
    Quat last = q;
    last.coeffs() = -last.coeffs();
    EXPECT_GT(groupOrientation(part, rest, x, last).dot(last), 1 - kExact);  // keeps its sign
  }
}

TEST(GroupOrientation, IsARotationWherePointsAreMirrored) {
  // A cross with arms of 3, 2, 1 along the axes: least is lost where the shortest is mirrored
  // alone.
  Points rest(3, 6);
  rest << 3, -3, 0, 0, 0, 0, 0, 0, 2, -2, 0, 0, 0, 0, 0, 0, 1, -1;
  Points x = rest;
  x.row(2) = -x.row(2);
  EXPECT_LT(angle(groupOrientation(group(6), rest, x, Quat::Identity()), Quat::Identity()), kExact);
}

TEST(GroupOrientation, StaysAsItWasWherePointsDoNotSay) {
  Points rest(3, 3);
  rest << 0, 1, 2, 0, 0, 1, 0, 0, 0;
  const Quat last = turn({1, 1, 0}, 1);
  const auto of = [&](const Points& x) {
    return groupOrientation(group(3), rest, x, last).coeffs();
  };
  Points line = rest, broken = rest;
  line.row(1).setZero();
  broken(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(of(line), last.coeffs());
  EXPECT_EQ(of(Points::Zero(3, 3)), last.coeffs());
  EXPECT_EQ(of(broken), last.coeffs());
}

TEST(BoneDirection, IsAlongTheBoneOrAsItWas) {
  const Vec3 last = Vec3::UnitY();
  Points x(3, 2);
  x << 1, 1, 2, 2, 3, 0.5;
  EXPECT_LT((boneDirection(limb(), x, last) + Vec3::UnitZ()).norm(), kExact);
  x.col(1) = x.col(0);
  EXPECT_EQ(boneDirection(limb(), x, last), last);
  x(2, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(boneDirection(limb(), x, last), last);
}

TEST(PartAnchor, IsTheBonesBeginningOrTheGroupsMiddle) {
  Points x(3, 3);
  x << 1, 4, 7, 2, 5, 8, 3, 6, 0;
  EXPECT_EQ(partAnchor(limb(), x), Vec3(1, 2, 3));
  EXPECT_LT((partAnchor(group(3), x) - Vec3(4, 5, 3)).norm(), kExact);
}

TEST(ReferenceOrientation, OfAHingeIsItsTurnThenTheLeastOneAside) {
  Part part = limb();
  part.hinged = true;
  part.hinge_axis = Vec3::UnitY();
  part.straight = -Vec3::UnitZ();
  const Quat bent = turn({0, 1, 0}, 1.1);
  EXPECT_LT(angle(referenceOrientation(part, bent * part.rest_direction), bent), kExact);
  // Aside by 0.3 in the plane of the bone and the axis.
  const Vec3 d = bent * part.rest_direction;
  const Quat aside = turn(d.cross(part.hinge_axis), 0.3);
  EXPECT_LT(angle(referenceOrientation(part, aside * d), aside * bent), kExact);
}

TEST(ReferenceOrientation, OfAnyOtherGoesByWayOfTheMiddle) {
  Part part = limb();
  part.centre_direction = Vec3::UnitX();
  const Quat to_middle = turn({0, 1, 0}, -M_PI / 2);  // from down to ahead
  EXPECT_LT(angle(referenceOrientation(part, Vec3::UnitX()), to_middle), kExact);
  const Quat beyond = turn({0, 0, 1}, 0.8);
  EXPECT_LT(angle(referenceOrientation(part, beyond * Vec3::UnitX()), beyond * to_middle), kExact);
}

/// The limb at rest, twisted: what it does next.
BoneMotion twisted(double twist) {
  BoneMotion m;
  m.parent_before = m.parent_now = Quat::Identity();
  m.before = turn(-Vec3::UnitZ(), twist);
  m.direction = -Vec3::UnitZ();
  return m;
}

TEST(FollowBone, GoesWithARigidMotionOfAll) {
  const Quat q = turn({1, 2, 3}, 1.2);
  BoneMotion m = twisted(0.5);
  m.parent_now = q * m.parent_before;
  m.direction = q * m.direction;
  m.bends = true;
  m.beyond_before = Vec3(1, 0, -1).normalized();
  m.beyond_now = q * m.beyond_before;
  EXPECT_LT(angle(followBone(limb(), m, false), q * m.before), 1e-9);
}

TEST(FollowBone, OfAStillBodyDoesNotTurn) {
  const BoneMotion m = twisted(0.5);
  EXPECT_LT(angle(followBone(limb(), m, false), m.before), kExact);
}

TEST(FollowBone, LosesTwistByOneAndAHalfTimesItsSwing) {
  const Quat swing = turn({1, 0, 0}, 0.1);
  BoneMotion m = twisted(0.5);
  m.direction = swing * m.direction;
  const Quat left = turn(-Vec3::UnitZ(), 0.5 - kPull * 0.1);
  EXPECT_LT(angle(followBone(limb(), m, false), swing * left), 1e-9);
  EXPECT_LT(angle(followBone(limb(), m, true), swing), 1e-9);  // a start: all at once
  m = twisted(0.1);                                            // less than that: all of it
  m.direction = swing * m.direction;
  EXPECT_LT(angle(followBone(limb(), m, false), swing), 1e-9);
}

/// The limb's orientation at a start, with a hinge beyond bent by `bend`, all twisted by `twist`.
Quat started(double twist, double bend) {
  const Part part = limb();
  BoneMotion m = twisted(0);
  m.bends = true;
  m.beyond_before = m.direction;
  m.beyond_now = turn(part.rest_direction, twist) * turn(part.bend_axis, bend) * m.direction;
  return followBone(part, m, true);
}

TEST(FollowBone, TakesItsTwistFromTheBendBeyond) {
  const Vec3 d = limb().rest_direction;
  for (const double twist : {-1.5, 0.0, 1.0})
    EXPECT_LT(angle(started(twist, 1.2), turn(d, twist)), 1e-9) << twist;
  EXPECT_LT(angle(started(1, 0.1), Quat::Identity()), 1e-9);  // too straight to show it
  // Farther from the reference than a joint twists: bent to the wrong side.
  EXPECT_LT(angle(started(2.5, 1.2), turn(d, 2.5 - M_PI)), 1e-9);
}

TEST(FollowBone, KeepsItsSignWhateverThatOfItsParent) {
  BoneMotion m = twisted(0.5);
  m.parent_now.coeffs() = -m.parent_now.coeffs();  // the same turn
  EXPECT_GT(followBone(limb(), m, false).dot(m.before), 0);
  m.before.coeffs() = -m.before.coeffs();
  EXPECT_GT(followBone(limb(), m, false).dot(m.before), 0);
}

}  // namespace
}  // namespace ragdoll::test
