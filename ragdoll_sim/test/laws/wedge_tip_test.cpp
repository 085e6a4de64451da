// A child that points along the axis of a region of more than a half turn: it is at the tip of the
// wedge that the region leaves out (limit.h), where both borders meet.
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/rod_on_group.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kMiddle = 110, kHalf = 130;  // [deg] of its region, from x to z
constexpr double kLength = 0.4;               // [m]
constexpr int kEnd = 4;                       // its particle e

/// In the plane across the axis, `degrees` from the region's middle.
Vec3 towards(double degrees) {
  const double angle = (kMiddle + degrees) * M_PI / 180;
  return {std::cos(angle), 0, std::sin(angle)};
}

/// The rod along `rod`, thrown at 1 rad/s about its end that pins hold: its other end goes `ahead`.
Scene thrown(const Vec3& rod, const Vec3& ahead, const Vec3& gravity, const std::string& method) {
  const auto list = [](const Vec3& v) {
    std::ostringstream out;
    out << std::setprecision(17) << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]";
    return out.str();
  };
  Scene scene =
      parseScene("gravity: " + list(gravity) + rodOnGroup(list(kLength * rod), "[-200, 60]") +
                 "solver: {method: " + method + "}\n");
  const World still(scene);
  RagdollSpec& body = scene.ragdolls[0];
  body.angular_velocity = rod.cross(ahead);
  body.velocity = body.angular_velocity.cross(centreOfMass(still.model, still.state, 0));
  return scene;
}

/// The rod starts and moves on in one plane: `degrees` from the middle, at `speed` [rad/s].
void expectSwings(double thrown_to, double degrees, double speed) {
  const Vec3 axis = Vec3::UnitY(), ahead = towards(degrees);
  for (const std::string method : {"shake", "rk", "rk, events: true"})
    for (const int rate : {60, 1000}) {
      Scene scene = thrown(axis, towards(thrown_to), Vec3::Zero(), method);
      scene.solver.step = 1.0 / rate;
      World world(scene);
      const auto what = method + " " + std::to_string(rate) + " " + std::to_string(thrown_to);
      EXPECT_LT((world.v(kEnd) - kLength * speed * ahead).norm(), 1e-9) << what;
      world.steps(rate / 10);
      const double angle = 0.1 * speed;
      const Vec3 end = kLength * (std::sin(angle) * ahead + std::cos(angle) * axis);
      EXPECT_LT((world.x(kEnd) - end).norm(), scene.solver.events ? 1e-9 : 0.01 / (rate * rate))
          << what;
    }
}

TEST(WedgeTip, LetsGoWhatMovesIntoTheRegion) {
  for (int degrees = -125; degrees <= 125; degrees += 10) expectSwings(degrees, degrees, 1);
}

/// Into the wedge it does not start: along the nearer border, with what of its speed goes there.
TEST(WedgeTip, TurnsWhatMovesIntoTheWedge) {
  for (const double degrees : {140.0, 150.0, 165.0, -140.0, -150.0, -165.0})
    expectSwings(degrees, std::copysign(kHalf, degrees),
                 std::cos((std::abs(degrees) - kHalf) * M_PI / 180));
}

/// Pressed onto a border it slides to the tip, and from there on falls beside the wedge. Followed
/// on by the gap of the tip, the step was handed over; and steps across the tip were of first
/// order.
TEST(WedgeTip, FreesWhatSlidesOverIt) {
  for (const double side : {-1.0, 1.0}) {
    const Vec3 border = towards(side * kHalf), inside = towards(side * (kHalf - 90));
    const Vec3 rod = std::cos(0.1) * Vec3::UnitY() + std::sin(0.1) * border;
    const Vec3 ahead = std::sin(0.1) * Vec3::UnitY() - std::cos(0.1) * border;
    const auto end = [&](const std::string& method, int rate) {
      Scene scene = thrown(rod, ahead, -5 * inside, method);
      scene.solver.step = 1.0 / rate;
      World world(scene);
      world.steps(rate / 20);
      EXPECT_LT(std::abs(world.x(kEnd).dot(inside)), 1e-7) << side;  // it slides
      int handed_over = 0;
      for (int i = 0; i < 3 * rate / 20; ++i) handed_over += world.steps(1).handed_over;
      EXPECT_EQ(handed_over, 0) << side;
      return world.x(kEnd);
    };
    const Vec3 best = end("rk, events: true", 1000);
    EXPECT_LT(best.dot(inside), -1e-3);  // it has fallen
    EXPECT_LT((end("rk, events: true", 60) - best).norm(), 1e-9) << side;
    for (const std::string method : {"shake", "rk"})
      for (const int rate : {60, 500, 2000})
        EXPECT_LT((end(method, rate) - best).norm(), 2.0 / (rate * rate)) << side << " " << rate;
  }
}

/// A limit that gives way lets a rod through its wedge: past the middle the other border pushes. It
/// comes there slowly, and either way is one.
TEST(WedgeTip, PushesToTheNearerBorderWhatGivesWay) {
  const Scene scene = parseScene(R"(
ragdolls:
  - position: [0, 0, 2]
    rpy_deg: [-15.4599, 54.1701, 144.169]
    velocity: [-0.396781, 0.40898, -0.945574]
    angular_velocity: [-3.48788, 2.77021, 0.62005]
    model:
      particles:
        a: {position: [0, 0, 0], mass: 1.62557}
        b: {position: [0.213264, 0.002420, 0], mass: 2.16772}
        c: {position: [-0.020670, 0.185479, 0.019832], mass: 2.26102}
        d: {position: [-0.014179, 0, 0.387558], mass: 2.47442}
        e: {position: [0.408234, 0.017048, -0.296820]}
      sticks: [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d], [b, e]]
      segments:
        trunk: {particles: [a, b, c, d]}
        rod: {from: b, to: e, mass: 1.30933, gyration: 0.289}
      joints:
        j: {type: planes, parent: trunk, child: rod, xz_deg: [-319.484, -87.9504],
            stiffness: 217.709}
pins: [ragdoll/e]
solver: {method: rk, events: true, damping: 0.261829}
)");
  const auto end = [&](int rate) {
    Scene at = scene;
    at.solver.step = 1.0 / rate;
    World world(at);
    world.steps(3 * rate / 10);
    return world.state.x;
  };
  EXPECT_LT((end(500) - end(2000)).cwiseAbs().maxCoeff(), 1e-10);
}

}  // namespace
}  // namespace ragdoll::test
