// Lengths that a model file gives: the rest pose follows them, or the file is refused by name.
#include "core/loading/rest_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/loading/skeleton.h"
#include "support/error_of.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

StickSpec stickOf(const std::string& a, const std::string& b, double length) {
  StickSpec s = stick(a, b);
  s.length = length;
  return s;
}

/// A ring of particles p0, p1, ... at the points, joined by sticks of the lengths.
SkeletonSpec ring(const std::vector<Vec3>& points, const std::vector<double>& lengths) {
  SkeletonSpec s;
  s.name = "ring";
  s.where = "m.yaml:1: model";
  for (std::size_t i = 0; i < points.size(); ++i)
    s.particles.push_back(particle("p" + std::to_string(i), points[i]));
  for (std::size_t i = 0; i < points.size(); ++i)
    s.sticks.push_back(
        stickOf(s.particles[i].name, s.particles[(i + 1) % points.size()].name, lengths[i]));
  return s;
}

std::string refusal(const SkeletonSpec& spec) {
  return errorOf([&] { buildSkeleton(spec); });
}

double largestError(const Skeleton& s) {
  double worst = 0;
  for (const Stick& k : s.sticks)
    worst = std::max(worst, std::abs((s.rest.col(k.a) - s.rest.col(k.b)).norm() / k.length - 1));
  return worst;
}

const std::vector<Vec3> kTriangle = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}};
const std::vector<Vec3> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};

TEST(RestPose, PolygonsThatCannotCloseAreRefusedByName) {
  // The nearest to 1, 1.41 and 5 m in relative terms is straight.
  EXPECT_THAT(
      refusal(ring(kTriangle, {1, 1.41, 5})),
      AllOf(StartsWith("sticks p2-p0: no pose gives"), HasSubstr("'p0-p1' of 1 m would be 1."),
            HasSubstr("'p1-p2' of 1.41 m would be "), HasSubstr("'p2-p0' of 5 m would be ")));
  EXPECT_THAT(refusal(ring(kSquare, {1, 1, 1, 9})),
              AllOf(HasSubstr("'p3-p0' of 9 m"), HasSubstr("'p1-p2' of 1 m")));
}

TEST(RestPose, PolygonsThatCloseArePutIntoShape) {
  const std::vector<Vec3> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const std::vector<Vec3> place(4, Vec3(1, 2, 3));
  for (const auto& [points, lengths] :
       {std::pair(kTriangle, std::vector<double>{3, 4, 5}),
        std::pair(kTriangle, std::vector<double>{1, 1, 2}),  // straight, as far as it can go
        std::pair(kSquare, std::vector<double>{1, 2, 3, 5.9}),
        std::pair(line, std::vector<double>{1, 1, 1, 1}),  // folded: no way out along the line
        std::pair(place, std::vector<double>{1, 1, 1, 1})}) {
    const Skeleton s = buildSkeleton(ring(points, lengths));
    EXPECT_LT(largestError(s), 1e-6) << lengths[0] << " ... " << lengths.back();
    ASSERT_FALSE(s.warnings.empty());
    EXPECT_THAT(s.warnings[0], AllOf(StartsWith("m.yaml:1: model: the positions do not fit"),
                                     HasSubstr("p1 by "), HasSubstr(" mm")));
  }
}

TEST(RestPose, ThatFitsStaysToTheBit) {
  const Skeleton s = buildSkeleton(ring(kTriangle, {1, 1, std::sqrt(2)}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Vec3(s.rest.col(i)), kTriangle[i]);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(RestPose, LongerForearmMovesTheHandAlongIt) {
  SkeletonSpec spec = limbs();
  spec.particles.pop_back();  // the finger
  spec.sticks.pop_back();
  spec.segments.pop_back();
  spec.sticks.back().length = 0.35;  // elbow to hand, 0.25 by its positions
  for (ParticleSpec& p : spec.particles)
    if (p.name == "hand") p.mass = 1;
  SegmentSpec& trunk = spec.segments[0];  // with mass it stays, and the upper arm with it
  trunk.mass = 30;
  trunk.com_point = Vec3(0, 0, 0.25);
  trunk.inertia = Vec3(0.9, 0.7, 0.4).asDiagonal();
  const Skeleton s = buildSkeleton(spec);
  EXPECT_LT(largestError(s), 1e-9);
  for (const int i : s.segments[0].particles)
    EXPECT_EQ(Vec3(s.rest.col(i)), spec.particles[i].position);
  // Elbow at 0.3 m below the shoulder still, hand 0.35 m below it, all on one line.
  EXPECT_LT((s.rest.col(s.particle("hand")) - Vec3(0, -0.2, 0.2 - 0.35)).norm(), 1e-6);
  ASSERT_FALSE(s.warnings.empty());
  EXPECT_THAT(s.warnings[0], HasSubstr("hand by 100 mm"));
}

TEST(RestPose, SolidOfGivenLengths) {
  // A regular tetrahedron of 2 m from positions of another one.
  SkeletonSpec spec = ring({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {2, 2, 2, 2});
  spec.sticks.push_back(stickOf("p0", "p2", 2));
  spec.sticks.push_back(stickOf("p1", "p3", 2));
  const Skeleton s = buildSkeleton(spec);
  EXPECT_LT(largestError(s), 1e-9);
  ASSERT_EQ(s.groups.size(), 1u);
  EXPECT_EQ(s.groups[0].rank, 3);
}

TEST(RestPose, OfHundredsOfSticksTakesNoLongerThanItMay) {
  // A long ring whose last stick is too short for its positions: fits; and one too long: does not.
  for (const auto& [count, last] :
       {std::pair(300, 0.5), std::pair(300, 500.0), std::pair(1200, 0.5)}) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i)
      points.push_back(0.16 * count *
                       Vec3(std::cos(2 * M_PI * i / count), 0, std::sin(2 * M_PI * i / count)));
    std::vector<double> lengths(count, 1.0);
    lengths.back() = last;
    const std::string what = refusal(ring(points, lengths));
    if (count > 1000)
      EXPECT_THAT(what, HasSubstr("1000 sticks at most"));
    else if (last > 1)
      EXPECT_THAT(what, HasSubstr("of 500 m would be"));
    else
      EXPECT_EQ(what, "");
  }
}

}  // namespace
}  // namespace ragdoll
