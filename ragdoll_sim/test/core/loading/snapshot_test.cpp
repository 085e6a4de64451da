// Snapshots go on to the same bits; whatever is not one of this scene is refused with a reason.
#include "ragdoll_sim/core/snapshot.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/step.h"
#include "support/error_of.h"

namespace ragdoll {
namespace {

Scene scene() {
  auto skeleton = std::make_shared<SkeletonSpec>();
  skeleton->name = "chain";
  for (int i = 0; i < 4; ++i) {
    ParticleSpec p;
    p.name = "p" + std::to_string(i);
    p.position = Vec3(0.3 * i, 0.1 * (i % 2), 0);
    p.mass = 1 + 0.25 * i;
    p.radius = 0.05;
    skeleton->particles.push_back(p);
    if (i > 0) skeleton->sticks.push_back({"p" + std::to_string(i - 1), p.name, {}, ""});
  }
  Scene s;
  RagdollSpec r;
  r.skeleton = skeleton;
  r.pose.position = Vec3(0, 0, 0.4);
  r.angular_velocity = Vec3(1, 2, 3);
  s.ragdolls = {r};
  ObstacleSpec floor;
  s.obstacles = {floor};
  PinSpec pin;
  pin.particle = "p0";
  s.pins = {pin};
  PokeSpec poke;
  poke.at = 0.5;
  poke.body = "p3";
  poke.force = Vec3(3, 1, 4);
  poke.duration = 0.3;
  s.pokes = {poke};
  return s;
}

class Snapshot : public ::testing::Test {
 protected:
  void run(int steps, State& state) {
    const Inputs inputs = startInputs(model_);
    Workspace workspace;
    for (int i = 0; i < steps; ++i) step(model_, inputs, workspace, state);
  }
  Moment moment(const State& state) const {
    return {state, model_.pokes, model_.pins, model_.gravity, model_.solver};
  }
  /// The reason for which the bytes are refused.
  std::string refusal(const std::vector<std::uint8_t>& bytes) const {
    return test::errorOf([&] { fromBytes(model_, bytes); });
  }

  Model model_ = buildModel(scene());
};

TEST_F(Snapshot, goesOnToTheSameBits) {
  State straight = startState(model_);
  run(25, straight);  // in the middle of the poke at 0.5 s would be step 30; this one is before it
  const std::vector<std::uint8_t> bytes = toBytes(model_, moment(straight));
  run(100, straight);

  State restored = fromBytes(model_, bytes).state;
  EXPECT_EQ(restored.step, 25u);
  run(100, restored);
  EXPECT_EQ(hash(restored), hash(straight));
  EXPECT_EQ(restored.time, straight.time);
}

TEST_F(Snapshot, holdsPokesPinsGravityAndSolver) {
  Moment m = moment(startState(model_));
  m.gravity = Vec3(1, 2, 3);
  m.solver.sweeps = 77;
  m.pins[0].frame = "robot/gripper";
  const Moment back = fromBytes(model_, toBytes(model_, m));
  EXPECT_EQ(back.gravity, m.gravity);
  EXPECT_EQ(back.solver.sweeps, 77);
  EXPECT_EQ(back.solver.step, model_.solver.step);
  ASSERT_EQ(back.pins.size(), 1u);
  EXPECT_EQ(back.pins[0].frame, "robot/gripper");
  ASSERT_EQ(back.pokes.size(), 1u);
  EXPECT_EQ(back.pokes[0].force, Vec3(3, 1, 4));
  EXPECT_EQ(back.pokes[0].body.particles, model_.pokes[0].body.particles);
}

TEST_F(Snapshot, anyFlippedByteIsNoticed) {
  const std::vector<std::uint8_t> good = toBytes(model_, moment(startState(model_)));
  ASSERT_EQ(refusal(good), "");
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::vector<std::uint8_t> bad = good;
    bad[i] ^= 1;
    EXPECT_NE(refusal(bad), "") << "byte " << i;
  }
}

TEST_F(Snapshot, anyOtherLengthIsNoticed) {
  const std::vector<std::uint8_t> good = toBytes(model_, moment(startState(model_)));
  for (std::size_t n = 0; n < good.size(); ++n) {
    const auto length = static_cast<std::ptrdiff_t>(n);
    EXPECT_NE(refusal({good.begin(), good.begin() + length}), "") << n << " bytes";
  }
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  EXPECT_NE(refusal(longer), "");
}

TEST_F(Snapshot, ofABodyThatHasFlownOutIsTakenButNoneOfWhereNoRunComes) {
  Moment m = moment(startState(model_));
  m.state.x.row(0).array() += 1e15;
  m.state.v.setConstant(1e12);
  EXPECT_EQ(fromBytes(model_, toBytes(model_, m)).state.x, m.state.x);
  for (const double out : {1e160, std::numeric_limits<double>::quiet_NaN()})
    for (Points* numbers : {&m.state.x, &m.state.v}) {
      const double before = std::exchange((*numbers)(1, 2), out);
      EXPECT_NE(refusal(toBytes(model_, m)).find("that no run comes to"), std::string::npos) << out;
      (*numbers)(1, 2) = before;
    }
  m.pins[0].target.z() = -1e160;
  EXPECT_NE(refusal(toBytes(model_, m)).find("a pin holds"), std::string::npos);
}

TEST_F(Snapshot, saysWhatTheBytesAre) {
  EXPECT_NE(refusal({}).find("0 bytes"), std::string::npos);
  EXPECT_NE(refusal(std::vector<std::uint8_t>(100, 7)).find("get_state"), std::string::npos);
  Scene other = scene();
  other.obstacles[0].friction = 0.1;
  const Model other_model = buildModel(other);
  const Moment m{startState(other_model), {}, other_model.pins, Vec3::Zero(), other_model.solver};
  EXPECT_NE(refusal(toBytes(other_model, m)).find("another scene"), std::string::npos);
}

}  // namespace
}  // namespace ragdoll
