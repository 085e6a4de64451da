// Energies by the kernels' padded mass matrix are those of the mass matrix itself.
#include "core/mechanics/energy_gain.h"

#include <gtest/gtest.h>

#include "core/loading/direct_system.h"
#include "core/loading/skeleton.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(EnergyGain, IsTheKineticEnergyThatGravityDidNotGive) {
  // Bones with mass along them: neither diagonal nor a multiple of the kernels' lanes.
  SkeletonSpec spec;
  spec.name = "chain";
  spec.particles = {particle("a", Vec3(0, 0, 0), 0), particle("b", Vec3(1, 0, 0), 0),
                    particle("c", Vec3(1, 1, 0), 5)};
  spec.sticks = {stick("a", "b"), stick("b", "c")};
  spec.segments = {bone("upper", "a", "b"), bone("lower", "b", "c")};
  for (SegmentSpec& segment : spec.segments) segment.gyration = 0.3;
  spec.segments[0].mass = 3;
  spec.segments[1].mass = 2;
  const Skeleton skeleton = buildSkeleton(spec);
  std::vector<std::string> warnings;
  const DirectSystem system = buildDirectSystem(skeleton, {}, warnings);
  const Eigen::MatrixXd& M = skeleton.M;
  ASSERT_FALSE(skeleton.lumped);

  const Points v0 = Points::Random(3, 3), v1 = Points::Random(3, 3), moved = Points::Random(3, 3);
  const Vec3 gravity(1, 2, -9);
  EnergyScratch scratch;
  const auto dense = [&M](const Points& v) { return 0.5 * (v * M).cwiseProduct(v).sum(); };
  EXPECT_NEAR(kineticEnergy(*system.rows, v0, scratch), dense(v0), 1e-12);
  const double work = gravity.dot(Vec3((moved * M).rowwise().sum()));
  EXPECT_NEAR(energyGain(*system.rows, v0, v1, moved, gravity, scratch),
              dense(v1) - dense(v0) - work, 1e-12);
  EXPECT_NEAR(system.rows->mass.sum(), 10, 1e-12);  // [kg] of the whole chain
}

}  // namespace
}  // namespace ragdoll
