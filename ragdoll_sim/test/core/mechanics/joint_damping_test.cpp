#include "core/mechanics/joint_damping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "support/mass_matrix.h"

namespace ragdoll {
namespace {

/// Four particles that lie in no plane, with masses that a rod couples.
struct Body4 {
  Points x{3, 4};
  Eigen::MatrixXd M = Eigen::Vector4d(1, 2, 3, 4).asDiagonal();
  std::unique_ptr<test::LooseMasses> masses;

  Body4() {
    x << 0, 1, 0, 0.5, 0, 0, 2, 0.5, 0, 0, 0, 1;
    M(0, 1) = M(1, 0) = 0.3;
    masses = std::make_unique<test::LooseMasses>(M);
  }
  MassMatrix mass() const { return masses->matrix(); }
  const Eigen::VectorXd& sums() const { return masses->sums(); }
};

TEST(JointDamping, FindsTheRigidMotionOfARigidMotion) {
  const Body4 body;
  const Vec3 drift(1, -2, 3), spin(0.5, 0.7, -1.1);
  Points v = body.x;
  for (int i = 0; i < 4; ++i) v.col(i) = drift + spin.cross(Vec3(body.x.col(i)));
  const RigidMotion motion = rigidMotion(body.mass(), {}, body.x, v);
  EXPECT_LT((motion.spin - spin).norm(), 1e-7);
  EXPECT_LT((motion.centre - body.x * body.sums() / body.sums().sum()).norm(), 1e-14);
  for (int i = 0; i < 4; ++i) EXPECT_LT((motion.velocityAt(body.x.col(i)) - v.col(i)).norm(), 1e-7);
}

/// What lies in a line has no inertia about it: momentum about it is not its own.
TEST(JointDamping, GivesNoSpinAboutALine) {
  const Vec3 line = Vec3(1, 2, 3).normalized(), spin = Vec3(0.5, 0.7, -1.1).cross(line);
  const Eigen::Matrix3d inertia = 2 * (Eigen::Matrix3d::Identity() - line * line.transpose());
  EXPECT_LT((exactSpinOf(inertia, inertia * spin) - spin).norm(), 1e-14);
  EXPECT_LT((exactSpinOf(inertia, inertia * spin + 1e-3 * line) - spin).norm(), 1e-14);
  const Eigen::Matrix3d regular = inertia + 0.1 * line * line.transpose();
  const Vec3 any(1, -2, 0.3);
  EXPECT_LT((regular * exactSpinOf(regular, any) - any).norm(), 1e-14);
}

TEST(JointDamping, LeavesMomentumAndAngularMomentum) {
  const Body4 body;
  Points v(3, 4);
  v << 1, -2, 0.3, 0, 4, 1, -1, 2, 0, 0.5, 1, -3;
  const auto angular = [&](const Points& velocities) {
    Vec3 sum = Vec3::Zero();
    const Points p = velocities * body.M;
    for (int i = 0; i < 4; ++i) sum += Vec3(body.x.col(i)).cross(Vec3(p.col(i)));
    return sum;
  };
  const Points before = v;
  dampInnerMotion(body.mass(), {}, 0.2, body.x, v);
  EXPECT_LT((v * body.sums() - before * body.sums()).norm(), 1e-12);
  EXPECT_LT((angular(v) - angular(before)).norm(), 1e-6);
  EXPECT_GT((v - before).norm(), 1);
}

}  // namespace
}  // namespace ragdoll
