#include "core/linear/body_response.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/linear/constants.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A stick of 1 m along x between equal masses, whose second end goes 0.6 m across.
struct Turned {
  World world{sceneOf(oneStick())};
  const DirectSystem& system = world.model.systems[0].direct;
  StickLengths lengths{system.rows->length2.data(), system.rows->inverse_length2.data(),
                       kLengthTolerance};
  BodyResponse response;
  Points dx = Points::Zero(3, 2);
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(system.rows->width);

  Turned() {
    response.bind(system);
    response.setStart(world.state.x.data());
    dx(1, 1) = 0.6;
  }
  Vec3 stick() const { return world.x(1) + dx.col(1) - world.x(0) - dx.col(0); }
};

TEST(BodyResponse, AlongStartEndsShortenTheStickAsItWas) {
  Turned t;
  ASSERT_TRUE(t.response.alongStart(t.lengths, t.dx, t.lambda));
  EXPECT_LT((t.stick() - Vec3(0.8, 0.6, 0)).norm(), 1e-9);
  EXPECT_NEAR(t.dx(0, 0), 0.1, 1e-9);    // half of it each
  EXPECT_NEAR(t.lambda[0], -0.1, 1e-9);  // [kg] tension: 1 kg by 0.1 m per m of the stick
}

TEST(BodyResponse, AlongEndEndsShortenItAsItIs) {
  Turned t;
  ASSERT_TRUE(t.response.alongEnd(t.lengths, t.world.state.x, t.dx, t.lambda));
  EXPECT_LT((t.stick() - Vec3(1, 0.6, 0).normalized()).norm(), 1e-9);
  EXPECT_LT((t.dx.rowwise().sum() - Vec3(0, 0.6, 0)).norm(), 1e-12);  // the centre stays
}

/// Two sticks that three equal masses have, at `cosine` to each other: by half of it the one's
/// length depends on the other's impulse.
SkeletonSpec bent(double cosine) {
  SkeletonSpec s = oneStick();
  const Vec3 along(cosine, std::sqrt(1 - cosine * cosine), 0);
  s.particles.push_back(particle("c", Vec3::UnitX() + along, 1));
  s.sticks.push_back(stick("b", "c"));
  s.segments.push_back(bone("bc", "b", "c"));
  return s;
}

TEST(BodyResponse, TellsHowNearItsSticksAreToDependingOnEachOther) {
  for (const double cosine : {0.0, 0.5, 1.0}) {
    const World world(sceneOf(bent(cosine)));
    BodyResponse response;
    response.bind(world.model.systems[0].direct);
    EXPECT_NEAR(response.condition(), (1 + cosine / 2) / (1 - cosine / 2), 1e-12);
  }
}

}  // namespace
}  // namespace ragdoll
