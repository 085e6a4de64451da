// Whoever moves evenly sees the same: an obstacle that moves does to a body at rest what one at
// rest does to a body that moves, also in steps that impacts and tension cut.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

struct MovingMeeting {
  std::string obstacle, method;
  double spin = 0;  ///< [rad/s] of the bar
  double hz = 0;
};

constexpr double kSpeed = 2;    ///< [m/s]
constexpr double kUntil = 0.2;  ///< [s]

/// Where a spinning bar ends, seen from the obstacle's start. moves: the obstacle does.
Points barAfter(const MovingMeeting& meeting, bool moves, int& substeps) {
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\nragdolls: [{position: [0.5037, 0.2, 0], model: {particles: {a: "
      "{position: [-0.2, 0, 0], "
      "radius: 0.05}, b: {position: [0.2, 0, 0], radius: 0.05}}, sticks: [[a, b]], segments: {ab: "
      "{from: a, to: b, "
      "mass: 2, gyration: 0.289}}}}]\nobstacles: [{" +
      meeting.obstacle + "}]\nsolver: {sleep: false}\n");
  applySetting(scene, "solver.method", meeting.method);
  scene.solver.step = 1 / meeting.hz;
  scene.ragdolls[0].velocity = Vec3(moves ? 0 : -kSpeed, 0, 0);
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, meeting.spin);
  const Model model = buildModel(scene);
  State state = startState(model);
  Inputs inputs = startInputs(model);
  Workspace workspace;
  const int steps = static_cast<int>(std::lround(kUntil * meeting.hz));
  substeps = 0;
  for (int i = 1; i <= steps; ++i) {
    inputs.obstacles.assign(1, model.obstacles[0].pose);
    inputs.obstacles[0].position.x() += moves ? kSpeed * i / meeting.hz : 0;
    substeps += step(model, inputs, workspace, state).substeps;
  }
  Points x = state.x;
  if (moves) x.row(0).array() -= kSpeed * kUntil;
  return x;
}

const char* const kThings[] = {"type: sphere, radius: 0.2, position: [0, 0, 0]",
                               "type: box, size: [0.4, 2, 2], position: [0, 0, 0]"};
const char* const kGive[] = {"", ", stiffness: 20000, damping: 100"};

TEST(MovingObstacle, DoesWhatOneAtRestDoesToWhatMoves) {
  // Up to 0.34 m apart at 1000 Hz, where a part of a step had the obstacle at the step's end.
  for (const std::string thing : kThings)
    for (const std::string give : kGive)
      for (const char* method : {"shake", "rk"})
        for (const double spin : {10.0, 60.0})
          for (const double hz : {120.0, 250.0, 500.0, 1000.0, 4000.0}) {
            const MovingMeeting meeting{thing + give + ", friction: 0.3", method, spin, hz};
            int cut = 0, also_cut = 0;
            const Points still = barAfter(meeting, false, cut);
            const Points moving = barAfter(meeting, true, also_cut);
            EXPECT_GT(cut, kUntil * hz) << "an impact cuts a step";
            EXPECT_EQ(cut, also_cut) << meeting.obstacle << method << spin << " " << hz;
            EXPECT_LT((still - moving).cwiseAbs().maxCoeff(), 1e-8)
                << meeting.obstacle << " " << method << " " << spin << " " << hz;
          }
}

/// [m/s] of what is fastest in 1 s after a box, which has come over the legs of a damped body that
/// lies there, and stood there for a while, sets off again at kSetOff.
constexpr double kSetOff = 0.5;
double fastestWhereABoxSetsOff(double from) {
  const Model model = buildModel(parseScene(
      "ragdolls: [{model: human, position: [0, 0, 0.12], rpy_deg: [0, 90, 0]}]\n"
      "obstacles: [{type: plane}, {type: box, position: [-0.7, 0, 0.3], size: [0.2, 1, 0.4]}]\n"
      "solver: {joint_damping: 2}\n"));
  State state = startState(model);
  Inputs inputs = startInputs(model);
  Workspace workspace;
  inputs.obstacles = state.obstacles;
  const double h = model.solver.step;
  double fastest = 0;
  for (double time = 0; time < 4; time += h) {
    double& x = inputs.obstacles[1].position.x();
    if (time > 0.5 && time < 2.5) x = std::min(from, x + 0.25 * h);
    if (time > 3) x += kSetOff * h;
    step(model, inputs, workspace, state);
    if (time > 3)
      fastest = std::max(fastest, std::sqrt(state.v.colwise().squaredNorm().maxCoeff()));
  }
  return fastest;
}

/// Squeezed between the floor and an edge that closes they have overlaps without a way out.
TEST(MovingObstacle, ThatSetsOffOnALegFlingsNothing) {
  for (double from = -0.49; from < -0.4; from += 0.002)
    EXPECT_LT(fastestWhereABoxSetsOff(from), kSetOff + 3) << from;
}

}  // namespace
}  // namespace ragdoll
