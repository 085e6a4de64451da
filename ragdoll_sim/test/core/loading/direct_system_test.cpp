// Rigid groups and the direct methods' constants: well conditioned whatever the geometry.
#include "core/loading/direct_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/linear/stick_solver.h"
#include "core/loading/rigid_groups.h"
#include "core/loading/skeleton.h"
#include "ragdoll_sim/core/measures.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A torso of five points as a complete graph, and a pelvis of four that shares its hips.
/// depth: how far the hips stand behind the shoulders; skew: how far one leg is from mirror
/// symmetry.
SkeletonSpec trunk(double depth, double skew) {
  SkeletonSpec s;
  s.name = "trunk";
  s.particles = {particle("neck", Vec3(0, 0, 0.5), 8),
                 particle("l_shoulder", Vec3(depth, 0.2, 0.45), 6),
                 particle("r_shoulder", Vec3(depth, -0.2, 0.45), 6),
                 particle("l_hip", Vec3(0, 0.1, 0), 7),
                 particle("r_hip", Vec3(0, -0.1, 0), 7),
                 particle("l_leg", Vec3(skew, 0.09, -0.1), 9),
                 particle("r_leg", Vec3(0, -0.09, -0.1), 9)};
  const auto join = [&s](int from, int to) {
    for (int i = from; i < to; ++i)
      for (int j = i + 1; j < to; ++j)
        if (!(from == 3 && i == 3 && j == 4))
          s.sticks.push_back(stick(s.particles[i].name, s.particles[j].name));
  };
  join(0, 5);
  join(3, 7);
  return s;
}

SegmentSpec group(const std::string& name, const std::vector<std::string>& particles, double mass,
                  const Vec3& com, const Vec3& inertia) {
  SegmentSpec s = bone(name, "", "");
  s.particles = particles;
  s.group = true;
  s.mass = mass;
  s.com_point = com;
  s.inertia = inertia.asDiagonal();
  return s;
}

SkeletonSpec withInertia(SkeletonSpec s) {
  for (ParticleSpec& p : s.particles) p.mass = 0;
  s.segments = {group("torso", {"neck", "l_shoulder", "r_shoulder", "l_hip", "r_hip"}, 30,
                      Vec3(0.01, 0, 0.25), Vec3(0.9, 0.7, 0.4)),
                group("pelvis", {"l_hip", "r_hip", "l_leg", "r_leg"}, 10, Vec3(0, 0, -0.05),
                      Vec3(0.08, 0.07, 0.09))};
  return s;
}

TEST(RigidGroups, TorsoAndPelvisAreRecognised) {
  const Skeleton s = buildSkeleton(trunk(0.05, 0));
  ASSERT_EQ(s.groups.size(), 2u);
  EXPECT_EQ(s.groups[0].particles, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(s.groups[0].rank, 3);
  EXPECT_EQ(s.groups[1].particles, (std::vector<int>{3, 4, 5, 6}));
  EXPECT_EQ(s.groups[1].rank, 2);  // mirror symmetric: always flat
}

class Trunk : public testing::TestWithParam<std::tuple<double, double, bool>> {};

TEST_P(Trunk, IsWellConditionedAndItsConstantsAreConsistent) {
  const auto [depth, skew, inertia] = GetParam();
  const SkeletonSpec spec = inertia ? withInertia(trunk(depth, skew)) : trunk(depth, skew);
  const Skeleton s = buildSkeleton(spec);
  std::vector<std::string> warnings;
  const DirectSystem d = buildDirectSystem(s, {}, warnings);
  EXPECT_LE(d.condition, 100) << "depth " << depth << " skew " << skew;
  EXPECT_GT(d.condition, 1);
  // Sticks keep the lengths that the rest pose has.
  const Eigen::MatrixXd D = s.rest * d.B.transpose();
  EXPECT_LT((D.colwise().norm().transpose() - d.length).cwiseAbs().maxCoeff(), 1e-12);
  // The rest pose is affine in the frames, and a rigid motion's momentum goes through W unchanged.
  EXPECT_LT((s.rest * d.affine.transpose() - s.rest).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((s.rest * s.M * d.W - s.rest).cwiseAbs().maxCoeff(), 1e-10);
  // Freedoms: base points' three each, less the sticks; two bodies and a hinge have 7.
  const int base = static_cast<int>(std::lround(d.affine.trace()));
  EXPECT_EQ(3 * base - d.length.size(), s.groups.size() == 2 ? 7 : 6);
}

TEST_P(Trunk, MobilityIsWhatForcesDoWithTheSticksAnswering) {
  const auto [depth, skew, inertia] = GetParam();
  const SkeletonSpec spec = inertia ? withInertia(trunk(depth, skew)) : trunk(depth, skew);
  const Skeleton skeleton = buildSkeleton(spec);
  std::vector<std::string> warnings;
  const DirectSystem d = buildDirectSystem(skeleton, {}, warnings);
  const StickRows& rows = *d.rows;
  const int n = rows.n, s = rows.s;
  StickSolver sticks;
  sticks.resize(rows);
  Points x = skeleton.rest;
  for (const double bend : {0.0, 0.3}) {  // the second pose is not the first one's
    x.rightCols(2).colwise() += bend * Vec3(0.1, -0.2, 0.3);
    sticks.setPose(rows, x.data());
    const Points D = x * d.B.transpose();
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(3 * n, 3 * n), J = Eigen::MatrixXd::Zero(s, 3 * n);
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) W(3 * i + c, 3 * j + c) = d.W(i, j);
        for (int k = 0; k < s; ++k) J(k, 3 * i + c) = D(c, k) * d.B(k, i);
      }
    const Eigen::MatrixXd JW = J * W;
    const Eigen::MatrixXd expected = W - JW.transpose() * (JW * J.transpose()).inverse() * JW;
    Eigen::MatrixXd mobility(3 * n, 3 * n);
    for (int i = 0; i < n; ++i)
      mobility.middleRows(3 * i, 3) =
          Eigen::Map<const PaddedRows>(sticks.mobility(rows, &i, 1) + 3 * i * rows.coordinates, 3,
                                       rows.coordinates)
              .leftCols(3 * n);
    EXPECT_LT((mobility - expected).norm(), 1e-11 * W.norm());
    EXPECT_LT((mobility - mobility.transpose()).norm(), 1e-14 * W.norm());
    EXPECT_LT((J * mobility).norm(), 1e-11 * JW.norm());  // no stick is stretched
    const std::array<int, 3> particle{5, 0, 2};
    const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(9, -1, 2);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(3 * n), answer(rows.coordinates);
    for (int k = 0; k < 3; ++k) all.segment(3 * particle[k], 3) = force.segment(3 * k, 3);
    sticks.answer(rows, particle.data(), force.data(), 3, answer.data());
    EXPECT_LT((answer.head(3 * n) - expected * all).norm(), 1e-11 * W.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Trunk,
                         testing::Combine(testing::Values(0, 1e-4, 0.002, 0.01, 0.05, 0.2),
                                          testing::Values(0, 1e-4, 0.001, 0.01, 0.05),
                                          testing::Bool()));

TEST(GroupInertia, StandingTrunkHasTheSegmentsMassCentreAndInertia) {
  const SkeletonSpec spec = withInertia(trunk(0.05, 0.01));
  const Skeleton s = buildSkeleton(spec);
  EXPECT_NEAR(s.M.sum(), 40, 1e-12);
  const Vec3 com = (s.rest * s.M).rowwise().sum() / 40;
  EXPECT_LT((com - (30 * Vec3(0.01, 0, 0.25) + 10 * Vec3(0, 0, -0.05)) / 40).norm(), 1e-12);
  // Kinetic energy of a spin about the origin: omega^T I omega / 2 with Steiner's terms.
  for (const Vec3& w : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, -2, 0.5)}) {
    Points v(3, s.size());
    for (int i = 0; i < s.size(); ++i) v.col(i) = w.cross(Vec3(s.rest.col(i)));
    double expected = 0;
    for (const SegmentSpec& g : spec.segments) {
      const Vec3 c = g.com_point;
      expected += 0.5 * w.dot(g.inertia * w) + 0.5 * g.mass * w.cross(c).squaredNorm();
    }
    EXPECT_NEAR(0.5 * (v * s.M).cwiseProduct(v).sum(), expected, 1e-10 * expected);
  }
}

TEST(GroupInertia, FlatPelvisKeepsItsInertiaAcrossThePlane) {
  const Skeleton s = buildSkeleton(withInertia(trunk(0.05, 0)));
  EXPECT_EQ(s.named, 7);
  EXPECT_EQ(s.size(), 8);
  Points v(3, s.size());
  for (int i = 0; i < s.size(); ++i) v.col(i) = Vec3::UnitY().cross(Vec3(s.rest.col(i)));
  const double expected = 0.5 * (0.7 + 30 * (0.01 * 0.01 + 0.25 * 0.25) + 0.07 + 10 * 0.05 * 0.05);
  EXPECT_NEAR(0.5 * (v * s.M).cwiseProduct(v).sum(), expected, 1e-10);
}

TEST(Checks, RedundantStickIsFoundAndNamed) {
  // The complete bipartite graph of 5 and 5 points has 25 sticks; 10 points take 24 [Bolker1980].
  SkeletonSpec s;
  s.name = "bipartite";
  for (int i = 0; i < 10; ++i)
    s.particles.push_back(
        particle(std::string(1, static_cast<char>('a' + i)),
                 Vec3(std::sin(7.0 * i), std::sin(3.0 * i * i), std::cos(5.0 * i))));
  for (int i = 0; i < 5; ++i)
    for (int j = 5; j < 10; ++j)
      if (i + j < 13) s.sticks.push_back(stick(s.particles[i].name, s.particles[j].name));
  std::vector<std::string> warnings;
  EXPECT_EQ(buildDirectSystem(buildSkeleton(s), {}, warnings).length.size(), 24);
  EXPECT_TRUE(warnings.empty());
  s.sticks.push_back(stick("e", "j"));
  EXPECT_EQ(buildDirectSystem(buildSkeleton(s), {}, warnings).length.size(), 24);
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("model 'bipartite': stick 'e-j' is redundant: "), std::string::npos)
      << warnings[0];
}

TEST(Checks, RedundantStickNamesTheSticksThatHoldItAndNoOthers) {
  // A double pyramid over the triangle a, b, c is rigid; of the rope c-g nothing depends on it.
  SkeletonSpec s;
  s.name = "pyramids";
  const std::vector<std::string> ring = {"a", "b", "c"};
  s.particles = {particle("a", Vec3(1, 0, 0)),        particle("b", Vec3(-0.5, 0.9, 0)),
                 particle("c", Vec3(-0.5, -0.8, 0)),  particle("top", Vec3(0, 0.1, 1)),
                 particle("low", Vec3(0.1, 0, -1.2)), particle("g", Vec3(-2, -2, 0))};
  for (const char* tip : {"top", "low"})
    for (const std::string& p : ring) s.sticks.push_back(stick(tip, p));
  for (const auto& [p, q] : {std::pair("a", "b"), std::pair("b", "c"), std::pair("c", "g"),
                             std::pair("top", "low"), std::pair("c", "a")})
    s.sticks.push_back(stick(p, q));
  // As sticks: merged into rigid groups they would be frames.
  Skeleton built = buildSkeleton(s);
  built.groups.clear();
  std::vector<std::string> warnings;
  buildDirectSystem(built, {}, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].substr(0, 44), "model 'pyramids': stick 'c-a' is redundant: ");
  for (const char* name : {"'top-a'", "'low-c'", "'a-b'", "'top-low'"})
    EXPECT_NE(warnings[0].find(name), std::string::npos) << warnings[0];
  EXPECT_EQ(warnings[0].find("'c-g'"), std::string::npos) << warnings[0];
}

TEST(Checks, PoseInWhichSticksAreDependentNamesThem) {
  // Four sticks of a rope that closes only straight: 1 + 1 + 1 = 3 m. A fifth hangs from it.
  SkeletonSpec s;
  s.name = "straight";
  for (int i = 0; i < 4; ++i)
    s.particles.push_back(particle(std::string(1, static_cast<char>('a' + i)), Vec3(i, 0, 0)));
  s.particles.push_back(particle("weight", Vec3(3, 0, -1)));
  for (const auto& [p, q] : {std::pair("a", "b"), std::pair("b", "c"), std::pair("c", "d"),
                             std::pair("d", "a"), std::pair("d", "weight")})
    s.sticks.push_back(stick(p, q));
  std::vector<std::string> warnings;
  buildDirectSystem(buildSkeleton(s), {}, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  for (const char* name : {"model 'straight'", "'a-b'", "'b-c'", "'c-d'", "'d-a'"})
    EXPECT_NE(warnings[0].find(name), std::string::npos) << warnings[0];
  EXPECT_EQ(warnings[0].find("weight"), std::string::npos) << warnings[0];
}

TEST(Checks, MotionWithoutInertiaNamesItsParticles) {
  // A disc's inertia, but points off its plane; a stick hangs from it.
  SkeletonSpec spec = withInertia(trunk(0.05, 0.01));
  spec.segments.pop_back();
  spec.segments[0].inertia = Vec3(1, 1, 2).asDiagonal();
  spec.particles.pop_back();
  spec.particles.back().mass = 1;
  spec.sticks.resize(10);
  spec.sticks.push_back(stick("l_hip", "l_leg"));
  try {
    std::vector<std::string> warnings;
    buildDirectSystem(buildSkeleton(spec), {}, warnings);
    ADD_FAILURE();
  } catch (const std::exception& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("model 'trunk'"), std::string::npos) << what;
    EXPECT_NE(what.find("a motion of neck"), std::string::npos) << what;
    EXPECT_EQ(what.find("l_leg"), std::string::npos) << what;
  }
}

TEST(Checks, InertiaOfNoBodyIsRefused) {
  SkeletonSpec spec = withInertia(trunk(0.05, 0.01));
  spec.segments[0].inertia = Vec3(1, 1, 3).asDiagonal();
  spec.segments[0].where = "m.yaml:7: segments.torso";
  try {
    buildSkeleton(spec);
    ADD_FAILURE();
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("m.yaml:7: segments.torso.inertia"), std::string::npos);
  }
}

TEST(Checks, LengthInsideARigidGroupMustAgree) {
  SkeletonSpec spec = trunk(0.05, 0.01);
  spec.sticks[0].length = 0.7;
  EXPECT_THROW(buildSkeleton(spec), std::exception);
}

}  // namespace
}  // namespace ragdoll
