#include "extreme_random.h"

#include <cmath>
#include <iterator>
#include <random>
#include <sstream>

#include "extreme_scenes.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

/// Numbers from a seed, the same with every library: not the standard's distributions. Every number
/// is drawn in the order of the text: << has an order, + has none.
class Draw {
 public:
  explicit Draw(std::uint32_t seed) : random_(seed) {}

  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(random_()) / 4294967296.0;
  }
  bool chance(double share) { return uniform(0, 1) < share; }
  std::uint32_t below(std::uint32_t count) { return random_() % count; }
  std::string vector(double reach) {
    std::ostringstream text;
    text << "[" << uniform(-reach, reach) << ", " << uniform(-reach, reach) << ", "
         << uniform(-reach, reach) << "]";
    return text.str();
  }

 private:
  std::mt19937 random_;
};

/// How a body starts: from `low` to `high` [m] up, thrown at up to `speed` [m/s] along each axis.
void putThrow(Draw& draw, double low, double high, double speed, std::ostringstream& text) {
  text << "position: [0, 0, " << draw.uniform(low, high) << "], rpy_deg: " << draw.vector(180)
       << ", velocity: " << draw.vector(speed)
       << ", angular_velocity: " << draw.vector(draw.uniform(0, 10));
}

/// The key `obstacles`: a floor and up to `most` things on it.
void putObstacles(Draw& draw, int most, std::ostringstream& text) {
  text << "obstacles:\n- {type: plane, friction: " << draw.uniform(0, 1)
       << ", restitution: " << (draw.chance(0.3) ? draw.uniform(0, 1) : 0) << "}\n";
  const int obstacles = static_cast<int>(draw.uniform(0, most + 1));
  for (int i = 0; i < obstacles; ++i) {
    text << "- {friction: " << draw.uniform(0, 1);
    std::ostringstream at;
    at << "[" << draw.uniform(-1.5, 1.5) << ", " << draw.uniform(-1.5, 1.5) << ", "
       << draw.uniform(-0.2, 0.6) << "]";
    switch (draw.below(4)) {
      case 0:
        text << ", type: sphere, position: " << at.str() << ", radius: " << draw.uniform(0.05, 0.6);
        break;
      case 1:
        text << ", type: capsule, from: " << at.str() << ", to: " << draw.vector(0.6)
             << ", radius: " << draw.uniform(0.03, 0.3);
        break;
      default:
        text << ", type: box, position: " << at.str() << ", rpy_deg: " << draw.vector(180)
             << ", size: [" << draw.uniform(0.05, 1) << ", " << draw.uniform(0.05, 1) << ", "
             << draw.uniform(0.05, 1) << "]";
    }
    text << "}\n";
  }
}

constexpr double kRates[] = {30, 60, 120, 240};  ///< [Hz]

constexpr const char* kBodies[] = {"head", "right_hand", "left_foot", "torso", "right_thigh"};
constexpr int kParticles = 3;  ///< of these, the first, are particles

constexpr double kDriven = 2;           ///< [s] that things are driven for
constexpr double kJointDamping = 2;     ///< [1/s] of every other scene, as of most that are shipped
constexpr double kLargestSwing = 0.5;   ///< [m] of what is driven, to either side
constexpr double kLargestTurn = 1;      ///< [rad] likewise
constexpr double kSlowest = 1;          ///< [rad/s]
constexpr double kFastest = 12;         ///< [rad/s] 6 m/s; a hand shakes as fast

/// To and fro along a line, and about an axis; what is driven ends wherever it is.
struct Swing {
  Vec3 direction = Vec3::Zero();  ///< [m] as far as it goes
  Vec3 turn = Vec3::Zero();       ///< [rad] likewise
  double rate = 0;                ///< [rad/s]

  double at(double time) const { return std::sin(rate * std::min(time, kDriven)); }
  Pose moved(const Pose& start, double time) const {
    const double angle = turn.norm() * at(time);
    Pose pose = start;
    pose.position += at(time) * direction;
    if (turn.norm() > 0)
      pose.orientation = Eigen::AngleAxisd(angle, turn.normalized()) * pose.orientation;
    return pose;
  }
};

Swing drawSwing(Draw& draw) {
  Swing swing;
  const auto vector = [&draw] {
    const double x = draw.uniform(-1, 1), y = draw.uniform(-1, 1), z = draw.uniform(-1, 1);
    return Vec3(x, y, z);
  };
  swing.rate = draw.uniform(kSlowest, kFastest);
  const double far = draw.uniform(0, kLargestSwing), turn = draw.uniform(0, kLargestTurn);
  swing.direction = far * vector().normalized();
  swing.turn = turn * vector().normalized();
  return swing;
}

}  // namespace

Extreme randomExtreme(std::uint32_t seed) {
  Draw draw(seed);
  const double speed = std::pow(10, draw.uniform(-1, 1.5));
  std::ostringstream start, rest;
  putThrow(draw, 2.6, 4, speed, start);
  putObstacles(draw, 5, rest);
  if (draw.chance(0.2)) rest << "pins: [" << kBodies[draw.below(kParticles)] << "]\n";
  if (draw.chance(0.5))
    rest << "pokes: [{at: " << draw.uniform(0, 1)
         << ", body: " << kBodies[draw.below(std::size(kBodies))]
         << ", force: " << draw.vector(std::pow(10, draw.uniform(1, 5)))
         << ", duration: " << draw.uniform(0, 0.1) << "}]\n";
  if (draw.chance(0.2)) rest << "self_collision: true\n";
  Extreme e;
  e.group = "random scenes";
  e.name = "seed " + std::to_string(seed);
  e.scene = humanScene(start.str(), rest.str());
  e.seconds = 3;
  e.laws.joined = 0;
  return e;
}

Extreme randomPile(std::uint32_t seed) {
  Draw draw(seed);
  constexpr double kApart = 2;  // [m] more than a body is long
  const int bodies = 2 + static_cast<int>(draw.below(3));
  std::ostringstream text;
  text << "ragdolls:\n";
  for (int i = 0; i < bodies; ++i) {
    const double x = (i % 2 - 0.5) * kApart, y = (i / 2 - 0.5) * kApart;
    const double speed = std::pow(10, draw.uniform(-1, 1.3));
    text << "- {name: r" << i << ", model: " << (draw.chance(0.7) ? "human" : "human_lumped")
         << ", position: [" << x << ", " << y << ", " << draw.uniform(2.6, 4)
         << "], rpy_deg: " << draw.vector(180) << ", velocity: [" << -speed * x << ", "
         << -speed * y << ", " << draw.uniform(-speed, speed)
         << "], angular_velocity: " << draw.vector(draw.uniform(0, 10)) << "}\n";
  }
  putObstacles(draw, 3, text);
  const auto body = [&](std::uint32_t kinds) {
    const std::uint32_t i = draw.below(bodies);
    return "r" + std::to_string(i) + "/" + kBodies[draw.below(kinds)];
  };
  if (draw.chance(0.2)) text << "pins: [" << body(kParticles) << "]\n";
  if (draw.chance(0.5)) {
    text << "pokes: [{at: " << draw.uniform(0, 1) << ", body: " << body(std::size(kBodies));
    text << ", force: " << draw.vector(std::pow(10, draw.uniform(1, 5)))
         << ", duration: " << draw.uniform(0, 0.1) << "}]\n";
  }
  text << "ragdoll_collision: true\n";
  if (draw.chance(0.5)) text << "self_collision: true\n";
  Extreme e;
  e.step = 1 / kRates[draw.below(std::size(kRates))];
  e.group = "random piles";
  e.name = "seed " + std::to_string(seed);
  e.scene = parseScene(text.str(), "extreme");
  e.seconds = 3;
  e.laws.joined = 0;
  return e;
}

Extreme randomDriven(std::uint32_t seed) {
  Draw draw(seed);
  const double speed = std::pow(10, draw.uniform(-1, 0.7));
  std::ostringstream start, rest;
  putThrow(draw, 1.5, 3, speed, start);
  putObstacles(draw, 5, rest);
  if (draw.chance(0.5)) rest << "pins: [" << kBodies[draw.below(kParticles)] << "]\n";
  if (draw.chance(0.2)) rest << "self_collision: true\n";
  Extreme e;
  e.step = 1 / kRates[draw.below(std::size(kRates))];
  e.group = "random driven scenes";
  e.name = "seed " + std::to_string(seed);
  e.scene = humanScene(start.str(), rest.str());
  if (seed % 2 == 1) e.scene.solver.joint_damping = kJointDamping;
  e.seconds = 2 * kDriven;
  e.laws.joined = e.laws.settled = kDriven + e.step;
  e.laws.squeezed = true;
  if (!e.scene.pins.empty()) e.laws.depth = kUnbounded;  // a pin may be driven into an obstacle
  e.laws.speed = 100;
  std::vector<Swing> swings(e.scene.obstacles.size());
  for (std::size_t i = 1; i < swings.size(); ++i)  // the floor stands
    if (draw.chance(0.7)) swings[i] = drawSwing(draw);
  e.drive = [swings, first = std::vector<Pose>()](double time, std::vector<Pose>& poses) mutable {
    if (first.empty()) first = poses;
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = swings[i].moved(first[i], time);
  };
  const Swing hand = drawSwing(draw);
  e.drive_pins = [hand, first = std::vector<Vec3>()](double time, std::vector<Vec3>& pins) mutable {
    if (first.empty()) first = pins;
    for (std::size_t i = 0; i < pins.size(); ++i) pins[i] = first[i] + hand.at(time) * hand.direction;
  };
  return e;
}

}  // namespace ragdoll::lab
