// A child that points along the axis of a region of more than a half turn: it is at the tip of the
// wedge that the region leaves out (limit.h), where both borders meet.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

/// A rod of 2 kg on a group that pins hold, along the group's axis y; its region is about that.
constexpr const char* kRod = R"(
gravity: [0, 0, 0]
ragdolls:
  - name: r
    model:
      name: rod
      particles:
        a: {position: [0, 0, 0], mass: 1}
        b: {position: [0.3, 0, 0], mass: 1}
        c: {position: [0, 0.3, 0], mass: 1}
        d: {position: [0, 0, 0.3], mass: 1}
        e: {position: [0, 0.4, 0]}
      sticks: [[a, b], [a, c], [b, c], [a, d], [b, d], [c, d], [a, e]]
      segments:
        trunk: {particles: [a, b, c, d]}
        rod: {from: a, to: e, mass: 2, gyration: 0.289}
      joints:
        j: {type: planes, parent: trunk, child: rod, yz_deg: [-200, 60]}
pins: [r/a, r/b, r/c]
solver: {method: METHOD}
)";

constexpr double kMiddle = 110, kHalf = 130;  // [deg] from x to z

/// The rod thrown at 1 rad/s about its end that pins hold, `degrees` from the middle of its region.
Scene thrown(double degrees, const std::string& method) {
  std::string text = kRod;
  text.replace(text.find("METHOD"), 6, method);
  Scene scene = parseScene(text);
  const World still(scene);
  const double angle = (kMiddle + degrees) * M_PI / 180;
  RagdollSpec& rod = scene.ragdolls[0];
  rod.angular_velocity = Vec3(std::sin(angle), 0, -std::cos(angle));
  rod.velocity = rod.angular_velocity.cross(centreOfMass(still.model, still.state, 0));
  return scene;
}

constexpr double kLength = 0.4;  // [m]
constexpr int kEnd = 4;          // its particle e

/// The rod starts and moves on in one plane: `degrees` from the middle, at `speed` [rad/s].
void expectSwings(double thrown_to, double degrees, double speed) {
  const double angle = (kMiddle + degrees) * M_PI / 180;
  const Vec3 ahead(std::cos(angle), 0, std::sin(angle));
  for (const std::string method : {"shake", "rk", "rk, events: true"})
    for (const int rate : {60, 1000}) {
      Scene scene = thrown(thrown_to, method);
      scene.solver.step = 1.0 / rate;
      World world(scene);
      const auto what = method + " " + std::to_string(rate) + " " + std::to_string(thrown_to);
      EXPECT_LT((world.v(kEnd) - kLength * speed * ahead).norm(), 1e-9) << what;
      world.steps(rate / 10);
      const double angle = 0.1 * speed;
      const Vec3 end = kLength * (std::sin(angle) * ahead + std::cos(angle) * Vec3::UnitY());
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

}  // namespace
}  // namespace ragdoll::test
