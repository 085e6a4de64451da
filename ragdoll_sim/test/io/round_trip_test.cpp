// A scene written out stands alone and reads back to the same bits: that is what makes a bag
// replayable.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

// Every key of the format, with numbers that have no short decimal form.
const char kEverything[] = R"(
gravity: [0.1, -0.3, -9.80665]
ragdolls:
  - name: doll
    model: &doll
      name: odd one
      particles:
        a: {position: [0, 0, 0.333333333333333333], mass: 1.1, radius: 0.07}
        b: {position: [0, 0.1, 0.7], mass: 0.3}
        c: {position: [0.2, 0, 1.1], mass: 0.2}
        d: {position: [0.3, 0, 0.1], mass: 0.7}
      sticks: [[a, b], [b, c], [a, c], [a, d, 0.9]]
      segments:
        plate: {particles: [a, b, c], mass: 3.1, com: [0.1, 0.03, 0.7], inertia: [0.11, 0.12, 0.13, 0.001, 0.002, 0.003]}
        rod: {from: a, to: d, mass: 1.7, com: 0.457, gyration: 0.276, contact: {stiffness: 20000.3, damping: 33.1}}
        upper: {from: a, to: b}
      joints:
        one: {type: hinge, parent: upper, child: rod, axis: [0.3, -1, 0.2], range_deg: [-7, 145], twist_deg: 50, stiffness: 33.3, damping: 0.7}
        two: {type: cone, parent: plate, child: rod, axis: [1, 2, 3], half_angle_deg: 40}
        three: {type: planes, parent: plate, child: upper, xy_deg: [0, 120], xz_deg: [80, 225]}
    position: [0.1, 0.2, 1.3]
    rpy_deg: [10, 20, 30]
    velocity: [1, 0.1, 0]
    angular_velocity: [0.7, 0, 0.1]
    place: {b: [0.11, 0.22, 1.7]}
  - {name: crowd, model: *doll, contact: compliant, count: 3, spacing: [2, 2.1, 0], position: [5, 5, 5], rpy: [0.1, 0, 0]}
obstacles:
  - {name: ground, type: plane, point: [0, 0, 0.1], normal: [0.1, 0.2, 1], friction: 0.7, restitution: 0.1, stiffness: 75000.7}
  - {type: box, position: [1, 0, 0.2], rpy_deg: [0, 33, 0], size: [1, 2, 0.4]}
  - {type: sphere, position: [0, 3, 0.5], radius: 0.3, frame: "robot/gripper \"2\""}
  - {type: capsule, from: [0, -3, 0], to: [0, -3, 1], radius: 0.1, frame: robot/gripper}
pins: [doll/d, {particle: crowd_0/a, frame: robot/gripper}]
pokes:
  - {at: 0.1, body: rod, force: [200, 0, 0.1], point: [0, 0.01, 0], duration: 0.1}
  - {body: doll/a, force: [0, 0, 1], duration: -1}
sensors:
  - {name: back, type: imu, segment: plate, position: [-0.12, 0.1, 0.05], rpy_deg: [10, 20, 30], rate: 27.027027027027027, noise: {accelerometer: 0.02, gyroscope: 0.002}, range: {accelerometer: 157, gyroscope: 35}, seed: 7}
  - {name: wrist, type: imu, segment: crowd_1/rod, rate: 27.027027027027027, range: {gyroscope: 3.3}}
self_collision: true
ragdoll_collision: true
solver: {preset: precise, step: 0.0037, sweeps: 7, integrator: midpoint, damping: 0.03}
coat: skin
)";

void expectSame(const SkeletonSpec& a, const SkeletonSpec& b) {
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.particles.size(), b.particles.size());
  for (std::size_t i = 0; i < a.particles.size(); ++i) {
    EXPECT_EQ(a.particles[i].name, b.particles[i].name);
    EXPECT_EQ(a.particles[i].position, b.particles[i].position);
    EXPECT_EQ(a.particles[i].mass, b.particles[i].mass);
    EXPECT_EQ(a.particles[i].radius, b.particles[i].radius);
  }
  ASSERT_EQ(a.sticks.size(), b.sticks.size());
  for (std::size_t i = 0; i < a.sticks.size(); ++i) {
    EXPECT_EQ(a.sticks[i].a, b.sticks[i].a);
    EXPECT_EQ(a.sticks[i].b, b.sticks[i].b);
    EXPECT_EQ(a.sticks[i].length, b.sticks[i].length);
  }
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_EQ(a.segments[i].name, b.segments[i].name);
    EXPECT_EQ(a.segments[i].particles, b.segments[i].particles);
    EXPECT_EQ(a.segments[i].group, b.segments[i].group);
    EXPECT_EQ(a.segments[i].mass, b.segments[i].mass);
    EXPECT_EQ(a.segments[i].com, b.segments[i].com);
    EXPECT_EQ(a.segments[i].gyration, b.segments[i].gyration);
    EXPECT_EQ(a.segments[i].com_point, b.segments[i].com_point);
    EXPECT_EQ(a.segments[i].inertia, b.segments[i].inertia);
    EXPECT_EQ(a.segments[i].contact.stiffness, b.segments[i].contact.stiffness);
    EXPECT_EQ(a.segments[i].contact.damping, b.segments[i].contact.damping);
  }
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    EXPECT_EQ(a.joints[i].name, b.joints[i].name);
    EXPECT_EQ(a.joints[i].type, b.joints[i].type);
    EXPECT_EQ(a.joints[i].parent, b.joints[i].parent);
    EXPECT_EQ(a.joints[i].child, b.joints[i].child);
    EXPECT_EQ(a.joints[i].axis, b.joints[i].axis);
    EXPECT_EQ(a.joints[i].range.begin, b.joints[i].range.begin);
    EXPECT_EQ(a.joints[i].range.end, b.joints[i].range.end);
    EXPECT_EQ(a.joints[i].half_angle, b.joints[i].half_angle);
    EXPECT_EQ(a.joints[i].twist, b.joints[i].twist);
    EXPECT_EQ(a.joints[i].stiffness, b.joints[i].stiffness);
    EXPECT_EQ(a.joints[i].damping, b.joints[i].damping);
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(a.joints[i].planes[k].has_value(), b.joints[i].planes[k].has_value());
      if (!a.joints[i].planes[k]) continue;
      EXPECT_EQ(a.joints[i].planes[k]->begin, b.joints[i].planes[k]->begin);
      EXPECT_EQ(a.joints[i].planes[k]->end, b.joints[i].planes[k]->end);
    }
  }
}

void expectSameRagdolls(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.ragdolls.size(), b.ragdolls.size());
  for (std::size_t i = 0; i < a.ragdolls.size(); ++i) {
    const RagdollSpec &p = a.ragdolls[i], &q = b.ragdolls[i];
    EXPECT_EQ(p.name, q.name);
    expectSame(*p.skeleton, *q.skeleton);
    EXPECT_EQ(p.pose.position, q.pose.position);
    EXPECT_EQ(p.pose.orientation.coeffs(), q.pose.orientation.coeffs());
    EXPECT_EQ(p.velocity, q.velocity);
    EXPECT_EQ(p.angular_velocity, q.angular_velocity);
    EXPECT_EQ(p.place, q.place);
    EXPECT_EQ(p.count, q.count);
    EXPECT_EQ(p.compliant, q.compliant);
    EXPECT_EQ(p.spacing, q.spacing);
  }
}

void expectSameSurroundings(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.obstacles.size(), b.obstacles.size());
  for (std::size_t i = 0; i < a.obstacles.size(); ++i) {
    const ObstacleSpec &p = a.obstacles[i], &q = b.obstacles[i];
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.type, q.type);
    EXPECT_EQ(p.pose.position, q.pose.position);
    EXPECT_EQ(p.pose.orientation.coeffs(), q.pose.orientation.coeffs());
    EXPECT_EQ(p.normal, q.normal);
    EXPECT_EQ(p.size, q.size);
    EXPECT_EQ(p.radius, q.radius);
    EXPECT_EQ(p.from, q.from);
    EXPECT_EQ(p.to, q.to);
    EXPECT_EQ(p.friction, q.friction);
    EXPECT_EQ(p.restitution, q.restitution);
    EXPECT_EQ(p.contact.stiffness, q.contact.stiffness);
    EXPECT_EQ(p.contact.damping, q.contact.damping);
    EXPECT_EQ(p.frame, q.frame);
  }
  ASSERT_EQ(a.sensors.size(), b.sensors.size());
  for (std::size_t i = 0; i < a.sensors.size(); ++i) {
    const SensorSpec &p = a.sensors[i], &q = b.sensors[i];
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.segment, q.segment);
    EXPECT_EQ(p.position, q.position);
    EXPECT_EQ(p.orientation.coeffs(), q.orientation.coeffs());
    EXPECT_EQ(p.rate, q.rate);
    EXPECT_EQ(p.accelerometer_noise, q.accelerometer_noise);
    EXPECT_EQ(p.gyroscope_noise, q.gyroscope_noise);
    EXPECT_EQ(p.accelerometer_range, q.accelerometer_range);
    EXPECT_EQ(p.gyroscope_range, q.gyroscope_range);
    EXPECT_EQ(p.seed, q.seed);
  }
  ASSERT_EQ(a.pins.size(), b.pins.size());
  for (std::size_t i = 0; i < a.pins.size(); ++i) {
    EXPECT_EQ(a.pins[i].particle, b.pins[i].particle);
    EXPECT_EQ(a.pins[i].frame, b.pins[i].frame);
  }
  ASSERT_EQ(a.pokes.size(), b.pokes.size());
  for (std::size_t i = 0; i < a.pokes.size(); ++i) {
    EXPECT_EQ(a.pokes[i].at, b.pokes[i].at);
    EXPECT_EQ(a.pokes[i].body, b.pokes[i].body);
    EXPECT_EQ(a.pokes[i].force, b.pokes[i].force);
    EXPECT_EQ(a.pokes[i].point, b.pokes[i].point);
    EXPECT_EQ(a.pokes[i].duration, b.pokes[i].duration);
  }
}

void expectSame(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.gravity, b.gravity);
  EXPECT_EQ(a.self_collision, b.self_collision);
  EXPECT_EQ(a.ragdoll_collision, b.ragdoll_collision);
  EXPECT_EQ(a.coat, b.coat);
  EXPECT_EQ(a.solver.preset, b.solver.preset);
  EXPECT_EQ(a.solver.method, b.solver.method);
  EXPECT_EQ(a.solver.integrator, b.solver.integrator);
  EXPECT_EQ(a.solver.step, b.solver.step);
  EXPECT_EQ(a.solver.sweeps, b.solver.sweeps);
  EXPECT_EQ(a.solver.damping, b.solver.damping);
  expectSameRagdolls(a, b);
  expectSameSurroundings(a, b);
}

TEST(SceneYaml, EveryKeyIsRead) {
  const Scene scene = parseScene(kEverything);
  EXPECT_EQ(scene.where, "<text>");
  EXPECT_EQ(scene.gravity, Vec3(0.1, -0.3, -9.80665));
  ASSERT_EQ(scene.ragdolls.size(), 2u);
  const SkeletonSpec& model = *scene.ragdolls[0].skeleton;
  EXPECT_EQ(scene.ragdolls[1].skeleton.get(), &model) << "an alias shares the model";
  ASSERT_EQ(model.particles.size(), 4u);
  EXPECT_EQ(model.particles[0].name, "a");
  EXPECT_EQ(model.particles[0].radius, 0.07);
  EXPECT_EQ(model.sticks[3].length, 0.9);
  EXPECT_FALSE(model.sticks[0].length.has_value());
  EXPECT_TRUE(model.segments[0].group);
  EXPECT_EQ(model.segments[0].inertia(1, 2), 0.003);
  EXPECT_EQ(model.segments[0].inertia(2, 1), 0.003);
  EXPECT_EQ(model.segments[1].gyration, 0.276);
  EXPECT_EQ(model.segments[1].contact.stiffness, 20000.3);
  EXPECT_EQ(model.segments[1].contact.damping, 33.1);
  EXPECT_FALSE(scene.ragdolls[0].compliant);
  EXPECT_TRUE(scene.ragdolls[1].compliant);
  EXPECT_EQ(scene.obstacles[0].contact.stiffness, 75000.7);
  EXPECT_NEAR(model.joints[0].axis.norm(), 1, 1e-15);
  EXPECT_NEAR(model.joints[0].range.end, 145 * M_PI / 180, 1e-15);
  EXPECT_EQ(model.joints[0].stiffness, 33.3);
  EXPECT_NEAR(model.joints[1].half_angle, 40 * M_PI / 180, 1e-15);
  EXPECT_FALSE(model.joints[2].planes[1].has_value());
  EXPECT_NEAR(model.joints[2].planes[2]->begin, 80 * M_PI / 180, 1e-15);
  EXPECT_EQ(scene.ragdolls[1].count, 3);
  EXPECT_EQ(scene.pins[1].frame, "robot/gripper");
  EXPECT_EQ(scene.pokes[1].duration, -1);
  EXPECT_EQ(scene.solver.sweeps, 7);
  EXPECT_EQ(scene.solver.integrator, Integrator::kMidpoint);
  EXPECT_EQ(scene.solver.step, 0.0037);
}

TEST(SceneYaml, RollPitchYawTurnAboutFixedAxes) {
  const Scene scene = parseScene("ragdolls: [{model: human, rpy_deg: [90, 0, 90]}]");
  const Quat q = scene.ragdolls[0].pose.orientation;
  EXPECT_LT((q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);  // roll keeps x, yaw takes it to y
  EXPECT_LT((q * Vec3::UnitY() - Vec3::UnitZ()).norm(), 1e-15);  // roll takes y to z, yaw keeps it
}

TEST(SceneYaml, RoundTripIsExact) {
  const Scene scene = parseScene(kEverything);
  const Scene again = parseScene(scene.text);
  expectSame(scene, again);
  EXPECT_EQ(again.ragdolls[0].skeleton, again.ragdolls[1].skeleton);
  EXPECT_EQ(again.text, scene.text);
  EXPECT_EQ(toYaml(again), scene.text);
}

TEST(SceneYaml, TextStandsAloneAndRunsToTheSameBits) {
  const auto run = [](const Scene& scene) {
    const Model model = buildModel(scene);
    State state = startState(model);
    Inputs inputs;
    inputs.pokes = model.pokes;
    Workspace workspace;
    for (int i = 0; i < 200; ++i) step(model, inputs, workspace, state);
    return hash(state);
  };
  for (const char* name :
       {"fall", "stairs", "between_objects", "hang", "weightless", "two", "crowd"}) {
    const Scene scene = loadScene(name);
    const Scene again = parseScene(scene.text);
    expectSame(scene, again);
    EXPECT_EQ(run(scene), run(again)) << name;
  }
}

TEST(SceneYaml, PathOfAModelIsRelativeToTheScene) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "ragdoll_scene_yaml_test";
  fs::create_directories(folder / "parts");
  std::ofstream(folder / "parts" / "dot.yaml")
      << "particles: {p: {position: [0, 0, 0], mass: 2}}\n";
  std::ofstream(folder / "scene.yaml") << "ragdolls: [{model: parts/dot.yaml}]\n";
  const Scene scene = loadScene((folder / "scene.yaml").string());
  EXPECT_EQ(scene.ragdolls[0].skeleton->name, "dot");
  EXPECT_EQ(scene.ragdolls[0].skeleton->particles[0].mass, 2);
  EXPECT_EQ(scene.ragdolls[0].skeleton->particles[0].where,
            (folder / "parts/dot.yaml").string() + ":1: particles.p");
  fs::remove_all(folder);
}

TEST(SceneYaml, ShareDirectoryOfTheEnvironmentComesFirst) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "ragdoll_share_test";
  fs::create_directories(folder / "models");
  std::ofstream(folder / "models" / "human.yaml")
      << "particles: {p: {position: [0, 0, 0], mass: 3}}\n";
  setenv("RAGDOLL_SHARE_DIR", folder.c_str(), 1);
  const Scene scene = parseScene("ragdolls: [{model: human}]");
  unsetenv("RAGDOLL_SHARE_DIR");
  EXPECT_EQ(scene.ragdolls[0].skeleton->particles.size(), 1u);
  EXPECT_EQ(parseScene("ragdolls: [{model: human}]").ragdolls[0].skeleton->particles.size(), 16u);
  fs::remove_all(folder);
}

TEST(SceneYaml, TextFollowsASetting) {
  Scene scene = loadScene("fall");
  applySetting(scene, "solver.step", "0.001");
  applySetting(scene, "gravity", "[0, 0, -1.62]");
  applySetting(scene, "self_collision", "true");
  applySetting(scene, "coat", "boxes");
  expectSame(scene, parseScene(scene.text));
}

}  // namespace
}  // namespace ragdoll
