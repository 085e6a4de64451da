// Sensors of a scene, resolved: where they sit, and how many steps a sample has.
#include "core/loading/sensors.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

SensorSpec onStick(double rate) {
  SensorSpec spec;
  spec.name = "imu";
  spec.segment = "ab";
  spec.rate = rate;
  spec.where = "here";
  return spec;
}

Model model() {
  Scene scene = test::sceneOf(test::oneStick());
  scene.solver.step = 1.0 / 120;
  return buildModel(scene);
}

TEST(Sensors, RateIsAWholeNumberOfSteps) {
  Model m = model();
  addSensor(onStick(40), m);
  ASSERT_EQ(m.sensors.size(), 1u);
  EXPECT_EQ(m.sensors[0].every, 3u);
  EXPECT_EQ(m.sensors[0].name, "ragdoll/imu");
  EXPECT_FALSE(m.sensors[0].twists) << "a bone";
  EXPECT_EQ(m.notes.size(), 1u);
  for (const double rate : {50.0, 240.0, 0.0, -1.0})
    EXPECT_THROW(addSensor(onStick(rate), m), Error) << rate;
  EXPECT_EQ(m.sensors.size(), 1u) << "nothing half applied";
}

TEST(Sensors, NameAndSegmentAreKnownOnce) {
  Model m = model();
  addSensor(onStick(60), m);
  EXPECT_THROW(addSensor(onStick(60), m), Error) << "the same name again";
  SensorSpec other = onStick(60);
  other.name = "other";
  other.segment = "nobody/ab";
  EXPECT_THROW(addSensor(other, m), Error);
  other.segment = "a";
  EXPECT_THROW(addSensor(other, m), Error) << "a particle";
  other.segment = "ragdoll/ab";
  addSensor(other, m);
  EXPECT_EQ(m.sensors.size(), 2u);
}

}  // namespace
}  // namespace ragdoll
