#include "ragdoll_sim/core/bounds.h"

#include <gtest/gtest.h>

#include <limits>

#include "ragdoll_sim/core/error.h"
#include "support/error_of.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Bounds, AToleranceIsNoneOrMoreThanRounding) {
  for (const double good : {0.0, 1e-12, 1e-4, 1.0}) EXPECT_NO_THROW(checkTolerance("t", good));
  for (const double bad : {-1e-3, 1e-13, 5e-324, kNone, std::numeric_limits<double>::infinity()}) {
    const std::string text = errorOf([&] { checkTolerance("solver.tolerance", bad); });
    EXPECT_EQ(text.rfind("solver.tolerance", 0), 0u) << text;
    EXPECT_NE(text.find("it must be 0 (a fixed step), or at least 1e-12 m"), text.npos) << text;
    if (bad == 1e-13) {
      EXPECT_NE(text.find("rounded"), text.npos) << text;
    }
  }
}

TEST(Bounds, RefuseWhatIsBeyondAndWhatIsNoNumber) {
  EXPECT_NO_THROW(checkPosition("p", Vec3(kFarthest, -kFarthest, 0)));
  EXPECT_THROW(checkPosition("p", Vec3(0, 1.001 * kFarthest, 0)), Error);
  EXPECT_THROW(checkPosition("p", Vec3(0, 0, kNone)), Error);
  EXPECT_FALSE(isWithinReach(Vec3(kNone, 0, 0)));
  EXPECT_NO_THROW(checkLength("l", 0));
  EXPECT_THROW(checkLength("l", -1e-9), Error);
  EXPECT_THROW(checkLength("l", kNone), Error);
  EXPECT_NO_THROW(checkSpeed("v", Vec3(0, 0, kFastest)));
  EXPECT_THROW(checkSpeed("v", Vec3(kFastest, 0, kFastest)), Error);
}

/// A force of F on m for h gives F h / m.
TEST(Bounds, AForceMayGiveNoMoreThanTheFastest) {
  Scene scene = sceneOf(oneParticle(4));
  scene.solver.step = 0.01;
  const World world(scene);
  Poke poke;
  poke.body = findBody(world.model, "p");
  poke.force.x() = 0.99 * kFastest * 4 / 0.01;
  EXPECT_NO_THROW(checkForce(world.model, poke));
  poke.force.x() = 1.01 * kFastest * 4 / 0.01;
  EXPECT_THROW(checkForce(world.model, poke), Error);
  EXPECT_NO_THROW(checkGravity("g", Vec3(0, 0, -0.99 * kFastest / 0.01), 0.01));
  EXPECT_THROW(checkGravity("g", Vec3(0, 0, -1.01 * kFastest / 0.01), 0.01), Error);
}

}  // namespace
}  // namespace ragdoll
