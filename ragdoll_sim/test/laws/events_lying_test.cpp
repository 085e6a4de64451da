// `method: rk` from event to event where a body comes to lie on more contacts than it has freedoms:
// the halved step tells the same, and so do the times of what presses, slips and lets go.
#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

/// Scene fall at a rate.
Scene fallAt(double rate) {
  Scene scene = loadScene("fall");
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.sleep = false;
  scene.solver.step = 1 / rate;
  return scene;
}

struct Fall : World {
  int handed_over = 0;

  explicit Fall(double rate) : World(fallAt(rate)) {}
  void go(double seconds) {
    const int steps = static_cast<int>(std::lround(seconds / model.solver.step));
    for (int i = 0; i < steps; ++i) handed_over += this->steps(1).handed_over;
  }
  void startFrom(const Fall& other) {
    state = other.state;
    state.multipliers.clear();
    state.step = static_cast<std::uint64_t>(std::llround(state.time / model.solver.step));
  }
};

/// In 0.2 s some hundred contacts and slips begin and end at up to 1 m/s and 100 m/s^2: where one
/// of them comes 1e-9 s later the body is elsewhere by as many metres.
TEST(Events, OfABodyThatComesToLieAreTheSameForAnyStep) {
  Fall first(480), coarse(1920), fine(3840);
  first.go(0.8);
  coarse.startFrom(first);
  fine.startFrom(first);
  coarse.go(0.2);
  fine.go(0.2);
  EXPECT_EQ(coarse.handed_over + fine.handed_over, 0);
  EXPECT_LT((coarse.state.x - fine.state.x).colwise().norm().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace ragdoll::test
