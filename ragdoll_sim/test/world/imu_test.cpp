// What a sensor on a body says against what mechanics says that it must.
#include "ragdoll_sim/world/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/world.h"
#include "support/gravity.h"

namespace ragdoll {
namespace {

using test::kG;

/// A tetrahedron of 1 kg each, a bone beside it, and a sensor.
std::string bodyWith(const std::string& sensor, const std::string& rest = "") {
  return R"(
ragdolls:
  - model:
      particles:
        a: {position: [1, 0, 0], mass: 1, radius: 0.1}
        b: {position: [-1, 0, 0], mass: 1, radius: 0.1}
        c: {position: [0, 1, 0], mass: 1, radius: 0.1}
        d: {position: [0, -1, 1], mass: 1, radius: 0.1}
        e: {position: [2, 0, 0], mass: 0.1, radius: 0.1}
      sticks: [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d], [a, e]]
      segments:
        block: {particles: [a, b, c, d]}
        bone: {from: a, to: e}
)" + rest +
         "\nsensors: [{name: imu, type: imu, " + sensor + "}]\n";
}

/// Samples of a run of so many steps.
std::vector<ImuSample> run(const Model& model, int steps, State& state) {
  Inputs inputs = startInputs(model);
  Workspace workspace;
  Imus imus(model);
  imus.reset(state);
  std::vector<ImuSample> samples;
  for (int i = 0; i < steps; ++i) {
    step(model, inputs, workspace, state);
    imus.update(model, state, samples);
  }
  return samples;
}

std::vector<ImuSample> run(const std::string& text, int steps) {
  const Model model = buildModel(parseScene(text));
  State state = startState(model);
  return run(model, steps, state);
}

/// The block about its first particle at time t, turning evenly: an exact motion.
State spinning(const Model& model, const Vec3& omega, double t, int step) {
  State state = startState(model);
  const Quat q(Eigen::AngleAxisd(omega.norm() * t, omega.normalized()));
  for (int i = 0; i < state.x.cols(); ++i) {
    state.x.col(i) = q * model.start_position.col(i);
    state.v.col(i) = omega.cross(state.x.col(i));
  }
  state.step = step;
  state.time = t;
  return state;
}

TEST(Imu, AtRestSaysExactlyGUpwardsInItsFrame) {
  const std::string turned = "segment: block, rpy_deg: [90, 0, 0], rate: 40";
  for (const char* sensor : {"segment: block, rate: 40", turned.c_str()}) {
    const Model model = buildModel(parseScene(bodyWith(sensor)));
    Imus imus(model);
    State state = startState(model);
    imus.reset(state);
    std::vector<ImuSample> samples;
    for (int i = 0; i < 30; ++i) {
      ++state.step;
      imus.update(model, state, samples);
    }
    ASSERT_EQ(samples.size(), 10u);
    for (const ImuSample& sample : samples) {
      const Vec3 up = model.sensors[0].orientation.conjugate() * Vec3(0, 0, kG);
      if (sensor == turned.c_str())
        EXPECT_LT((sample.acceleration - up).norm(), 1e-14);
      else
        EXPECT_EQ(sample.acceleration, up);
      EXPECT_EQ(sample.angular_velocity, Vec3::Zero());
    }
  }
}

TEST(Imu, FreeFallIsNothing) {
  for (const char* method : {"shake", "rk"}) {
    const auto samples = run(bodyWith("segment: block, position: [0.3, 0.2, 0.1], rate: 120",
                                      "solver: {method: " + std::string(method) + "}"),
                             60);
    ASSERT_EQ(samples.size(), 60u);
    for (const ImuSample& sample : samples) {
      EXPECT_LT(sample.acceleration.norm(), 1e-9) << method;
      EXPECT_LT(sample.angular_velocity.norm(), 1e-9) << method;
    }
  }
}

TEST(Imu, SpinGivesCentripetalAccelerationAtItsRadius) {
  // The mean over a step of h of an even turn about z: omega^2 r sin(omega h / 2) / (omega h / 2).
  const Model model = buildModel(parseScene(
      bodyWith("segment: block, position: [0.7, 0, -0.25], rate: 60", "gravity: [0, 0, 0]")));
  const double h = model.solver.step, omega = 9;
  Imus imus(model);
  imus.reset(spinning(model, Vec3(0, 0, omega), 0, 0));
  std::vector<ImuSample> samples;
  for (int i = 1; i <= 40; ++i)
    imus.update(model, spinning(model, Vec3(0, 0, omega), i * h, i), samples);
  ASSERT_EQ(samples.size(), 20u);
  const double mean = omega * omega * 0.7 * std::sin(omega * h / 2) / (omega * h / 2);
  for (const ImuSample& sample : samples) {
    EXPECT_LT((sample.acceleration - Vec3(-mean, 0, 0)).norm(), 1e-10);
    EXPECT_LT((sample.angular_velocity - Vec3(0, 0, omega)).norm(), 1e-11);
  }
}

/// [m/s^2], [rad/s] largest differences from an even turn by 9 rad/s that is simulated.
std::pair<double, double> spinErrors(const std::string& method, int rate) {
  const double h = 1.0 / rate, omega = 9;
  Scene scene = parseScene(R"(
ragdolls:
  - angular_velocity: [0, 0, 9]
    model:
      particles:
        a: {position: [1, 0, 0], mass: 1, radius: 0.1}
        b: {position: [-1, 0, 0], mass: 1, radius: 0.1}
        c: {position: [0, 1, 0], mass: 1, radius: 0.1}
        d: {position: [0, -1, 0], mass: 1, radius: 0.1}
      sticks: [[a, c], [c, b], [b, d], [d, a], [a, b]]
      segments: {cross: {particles: [a, b, c, d]}}
gravity: [0, 0, 0]
sensors: [{name: imu, type: imu, segment: cross, position: [0.7, 0.2, 0.3], rate: 60}]
solver: {method: )" + method +
                           "}\n");
  scene.solver.step = h;
  const Model model = buildModel(scene);
  State state = startState(model);
  const Vec3 inwards =
      -omega * omega * Vec3(0.7, 0.2, 0) * std::sin(omega * h / 2) / (omega * h / 2);
  double acceleration = 0, turn = 0;
  const auto samples = run(model, 2 * rate, state);
  EXPECT_EQ(samples.size(), 120u);
  for (const ImuSample& sample : samples) {
    acceleration = std::max(acceleration, (sample.acceleration - inwards).norm());
    turn = std::max(turn, (sample.angular_velocity - Vec3(0, 0, omega)).norm());
  }
  return {acceleration, turn};
}

TEST(Imu, SimulatedSpinGivesTheSame) {
  // 59 m/s^2, 9 rad/s. What is left is the method's: none by rk, of second order by shake.
  const auto [acceleration, turn] = spinErrors("rk", 480);
  EXPECT_LT(acceleration, 1e-10);
  EXPECT_LT(turn, 1e-11);
  const auto coarse = spinErrors("shake", 240), fine = spinErrors("shake", 480);
  EXPECT_LT(fine.first, 1e-4 * 59);
  EXPECT_NEAR(coarse.first / fine.first, 4, 0.05);
  EXPECT_NEAR(coarse.second / fine.second, 4, 0.05);
}

TEST(Imu, ABoneHasNoTwistAndSaysSo) {
  const Model model = buildModel(parseScene(bodyWith("segment: bone, rate: 120")));
  ASSERT_EQ(model.notes.size(), 1u);
  EXPECT_NE(model.notes[0].find("'bone' has no twist"), std::string::npos) << model.notes[0];
  Imus imus(model);
  imus.reset(spinning(model, Vec3(7, 2, 1), 0, 0));
  std::vector<ImuSample> samples;
  for (int i = 1; i <= 20; ++i)
    imus.update(model, spinning(model, Vec3(7, 2, 1), i * model.solver.step, i), samples);
  for (const ImuSample& sample : samples) {
    EXPECT_LT(std::abs(sample.angular_velocity.x()), 2e-3) << "about the bone";
    EXPECT_GT(sample.angular_velocity.norm(), 1);
  }
  EXPECT_TRUE(buildModel(parseScene(bodyWith("segment: block, rate: 120"))).notes.empty());
}

/// [m/s] that the samples of a body that does not turn add up to.
Vec3 sumOfSamples(const std::vector<ImuSample>& samples, const Vec3& gravity, double interval) {
  Vec3 sum = Vec3::Zero();
  for (const ImuSample& sample : samples)
    sum += interval * (sample.pose.orientation * sample.acceleration + gravity);
  return sum;
}

TEST(Imu, MeanIsExactThroughAnImpact) {
  // A block on one foot would turn; a ball falls straight, and its mean is the change of velocity.
  const std::string scene = R"(
ragdolls:
  - position: [0, 0, 0.5]
    model:
      particles: {a: {position: [0, 0, 0], mass: 2, radius: 0.1}, b: {position: [0.5, 0, 0], mass: 1, radius: 0.1},
                  c: {position: [0, 0.5, 0], mass: 1, radius: 0.1}}
      sticks: [[a, b], [b, c], [a, c]]
      segments: {plate: {particles: [a, b, c]}}
obstacles: [{type: plane, restitution: 0.5}]
sensors: [{name: imu, type: imu, segment: plate, rate: 15}]
solver: {step: )";
  for (const char* step : {"0.008333333333333333", "0.0010416666666666667"}) {
    const Model model = buildModel(parseScene(scene + step + "}"));
    State state = startState(model);
    const int steps = static_cast<int>(std::lround(0.8 / model.solver.step));
    const auto samples = run(model, steps, state);
    ASSERT_EQ(samples.size(), 12u) << step;
    EXPECT_LT((sumOfSamples(samples, model.gravity, 1.0 / 15) - state.v.col(0)).norm(), 1e-9)
        << step;
  }
}

/// A cross that spins about z and hits a smooth wall with the ball in its middle: the spin stays,
/// the velocity jumps by (1 + e) v at one instant, in the sensor's frame along where the wall is
/// then. [m/s^2] of the sample with the impact: by how much it is off.
double impactError(const char* method, double hz) {
  const double omega = 9, v = 2, e = 0.5, gap = 0.4137;
  Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdolls:
  - velocity: [2, 0, 0]
    angular_velocity: [0, 0, 9]
    model:
      particles: {m: {position: [0, 0, 0], mass: 1, radius: 0.3}, a: {position: [0.2, 0, 0], mass: 1},
                  b: {position: [-0.2, 0, 0], mass: 1}, c: {position: [0, 0.2, 0], mass: 1}, d: {position: [0, -0.2, 0], mass: 1}}
      sticks: [[a, c], [c, b], [b, d], [d, a], [a, b], [m, a], [m, b], [m, c], [m, d]]
      segments: {cross: {particles: [m, a, b, c, d]}}
obstacles: [{type: plane, point: [0.7137, 0, 0], normal: [-1, 0, 0], restitution: 0.5, friction: 0}]
sensors: [{name: imu, type: imu, segment: cross, rate: 10}]
)");
  applySetting(scene, "solver.method", method);
  scene.solver.step = 1 / hz;
  const Model model = buildModel(scene);
  State state = startState(model);
  const auto samples = run(model, static_cast<int>(std::lround(0.4 * hz)), state);
  EXPECT_EQ(samples.size(), 4u);
  EXPECT_NEAR(state.v(0, 0), -e * v, 1e-6) << "it was hit in its middle";
  const double turned = omega * gap / v, mean = (1 + e) * v / 0.1;
  const Vec3 exact(-mean * std::cos(turned), mean * std::sin(turned), 0);
  return (samples.at(2).acceleration - exact).norm();
}

TEST(Imu, MeanIsExactThroughAnImpactOfABodyThatTurns) {
  // Of 30 m/s^2: up to 1.1 off at 120 Hz, to first order, where an impact counted as in the middle
  // of its step.
  for (const double hz : {120, 250, 1000}) EXPECT_LT(impactError("rk", hz), 1e-5) << hz;
  EXPECT_LT(impactError("shake", 120), 0.06);
  EXPECT_NEAR(impactError("shake", 250) / impactError("shake", 1000), 16, 2);
}

TEST(Imu, IntegratedTwiceGivesItsPathBack) {
  // Dead reckoning from the samples alone over a fall onto the stairs: the drift that is left comes
  // of impacts, whose time a sample does not tell. It is that of the rate, whatever the step.
  Scene scene = loadScene("stairs");
  SensorSpec sensor;
  sensor.name = "low_back";
  sensor.segment = "torso";
  sensor.position = Vec3(-0.12, 0, -0.2);
  sensor.rate = 480;
  scene.sensors.push_back(sensor);
  scene.solver.step = 1.0 / 480;
  const Model model = buildModel(scene);
  Imus imus(model);
  State state = startState(model);
  imus.reset(state);
  Pose pose = imus.pose(0);
  const Vec3 start = pose.position;
  Vec3 v = imus.velocity(0);
  Inputs inputs = startInputs(model);
  Workspace workspace;
  std::vector<ImuSample> samples;
  const double h = model.solver.step;
  for (int i = 0; i < 480; ++i) {
    step(model, inputs, workspace, state);
    samples.clear();
    imus.update(model, state, samples);
    const auto turned = [&](double t) {
      const Vec3 angle = samples[0].angular_velocity * t;
      return Quat(Eigen::AngleAxisd(angle.norm(),
                                    angle.norm() > 0 ? angle.normalized() : Vec3(Vec3::UnitX())));
    };
    const Vec3 a = pose.orientation * turned(h / 2) * samples[0].acceleration + model.gravity;
    pose.position += h * v + 0.5 * h * h * a;
    v += h * a;
    pose.orientation = pose.orientation * turned(h);
  }
  EXPECT_GT((imus.pose(0).position - start).norm(), 0.5);
  EXPECT_LT((imus.pose(0).position - pose.position).norm(), 0.04);
  EXPECT_LT(imus.pose(0).orientation.angularDistance(pose.orientation), 1e-3);
}

TEST(Imu, NoiseHasTheStatedSpreadAndIsSeeded) {
  const auto noisy = [](const std::string& more) {
    return run(
        bodyWith("segment: block, rate: 120, noise: {accelerometer: 0.02, gyroscope: 0.5}" + more,
                 "gravity: [0, 0, 0]"),
        8000);
  };
  const auto samples = noisy("");
  double mean = 0, square = 0, fourth = 0, gyroscope = 0;
  for (const ImuSample& sample : samples)
    for (int axis = 0; axis < 3; ++axis) {
      const double a = sample.acceleration[axis] / 0.02,
                   n = 3.0 * static_cast<double>(samples.size());
      mean += a / n;
      square += a * a / n;
      fourth += a * a * a * a / n;
      gyroscope += std::pow(sample.angular_velocity[axis] / 0.5, 2) / n;
    }
  EXPECT_NEAR(mean, 0, 0.02);    // 3 / sqrt(24000)
  EXPECT_NEAR(square, 1, 0.03);  // 3 sqrt(2 / 24000)
  EXPECT_NEAR(gyroscope, 1, 0.03);
  EXPECT_NEAR(fourth, 3, 0.2);  // 3 sqrt(96 / 24000): a normal distribution
  const auto again = noisy(""), other = noisy(", seed: 2");
  EXPECT_EQ(samples[77].acceleration, again[77].acceleration);
  EXPECT_NE(samples[77].acceleration, other[77].acceleration);
}

TEST(Imu, NoiseBitsAreSpecified) {
  // SplitMix64 and the polar method, computed apart with 60 digits.
  double numbers[3];
  normalNumbers(42, 7, 3, numbers);
  EXPECT_DOUBLE_EQ(numbers[0], 0.9651734000898664);
  EXPECT_DOUBLE_EQ(numbers[1], 0.08108728049603739);
  EXPECT_DOUBLE_EQ(numbers[2], -1.0490283858988039);
  const std::uint64_t bits[3] = {0x3feee2b3538b5cfbu, 0x3fb4c222d1da208eu, 0xbff0c8d1fd202d2du};
  for (int i = 0; i < 3; ++i) {
    double expected;
    std::memcpy(&expected, &bits[i], sizeof expected);
    EXPECT_EQ(numbers[i], expected) << i;
  }
}

TEST(Imu, Saturates) {
  for (const ImuSample& sample :
       run(bodyWith("segment: block, rate: 120, noise: {accelerometer: 30, gyroscope: 3}, "
                    "range: {accelerometer: 5, gyroscope: 0.5}"),
           200)) {
    EXPECT_LE(sample.acceleration.cwiseAbs().maxCoeff(), 5);
    EXPECT_LE(sample.angular_velocity.cwiseAbs().maxCoeff(), 0.5);
  }
}

TEST(Imu, SamplesAreWholeWhereverTheStateBegins) {
  const Model model = buildModel(parseScene(bodyWith("segment: block, rate: 30")));
  State state = startState(model);
  state.step = 6;
  Imus imus(model);
  imus.reset(state);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 10; ++i) {
    ++state.step;
    imus.update(model, state, samples);
  }
  ASSERT_EQ(samples.size(), 2u);  // 8 ... 12 and 12 ... 16, not 6 ... 8
  EXPECT_EQ(samples[0].step, 12u);
  EXPECT_EQ(samples[1].step, 16u);
}

TEST(Imu, WorldTellsTheSameWhoeverAsksAndAfterAReset) {
  const std::string text = bodyWith("segment: block, rate: 60, noise: {accelerometer: 0.1}",
                                    "obstacles: [{type: plane}]");
  World often(parseScene(text)), once(parseScene(text));
  std::vector<ImuSample> collected;
  for (int i = 0; i < 100; ++i) {
    often.advance();
    once.advance();
    for (const ImuSample& sample : often.takeImuSamples()) collected.push_back(sample);
  }
  const auto all = once.takeImuSamples();
  ASSERT_EQ(all.size(), 50u);
  ASSERT_EQ(collected.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(all[i].acceleration, collected[i].acceleration);
  once.reset();
  for (int i = 0; i < 100; ++i) once.advance();
  EXPECT_EQ(once.takeImuSamples()[30].acceleration, all[30].acceleration);
}

TEST(Imu, ANameThatIsAFrameIsRefused) {
  const Scene scene =
      parseScene("ragdolls: [{model: human}]\nsensors: [{name: head, type: imu, segment: head}]\n");
  try {
    World world(scene);
    FAIL();
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find("'ragdoll/head' is a frame of the body already"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace ragdoll
