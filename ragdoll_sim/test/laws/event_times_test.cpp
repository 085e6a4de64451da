// When the mode of a human that falls changes, by `method: rk` from event to event: told by motions
// that end just before and after, from steps of different lengths.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <vector>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kWindow = 0.1;            ///< [s]
constexpr double kEventLook = 1.0 / 1920;  ///< [s] in which one contact changes at the most

Scene fallAt(double rate) {
  Scene scene = loadScene("fall");
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.sleep = false;
  scene.solver.step = 1 / rate;
  return scene;
}

/// What presses: contacts that stick and that slip, and joint limits.
struct Pressing {
  int sticking = 0, slipping = 0, limits = 0;
};
bool operator==(const Pressing& a, const Pressing& b) {
  return a.sticking == b.sticking && a.slipping == b.slipping && a.limits == b.limits;
}
void PrintTo(const Pressing& all, std::ostream* out) {
  *out << all.sticking << " stick, " << all.slipping << " slip, " << all.limits << " limits";
}

Pressing pressingOf(const Model& model, const State& state) {
  Pressing all;
  for (const CachedImpulse& c : state.impulses) {
    const double friction = c.impulse.head<2>().norm();
    const double most = c.obstacle < 0 ? 0 : model.obstacles[c.obstacle].friction * c.impulse.z();
    (c.a < 0 ? all.limits : friction < (1 - 1e-9) * most ? all.sticking : all.slipping)++;
  }
  return all;
}

struct Change {
  double time;  ///< [s]
  Pressing before, now;
};

class Changes {
 public:
  explicit Changes(double rate) : step_(1 / rate), probe_(fallAt(rate)) {}

  /// From a state on, in its steps.
  std::vector<Change> after(const State& start) {
    from_ = start;
    from_.multipliers.clear();
    std::vector<Change> found;
    Pressing before = pressingAt(0.001 * kEventLook);
    for (double end = start.time + kWindow; from_.time < end - 0.5 * kEventLook;) {
      double last = 0;
      for (double t = kEventLook; t < step_ + 0.5 * kEventLook; t += kEventLook) {
        const Pressing now = pressingAt(t);
        if (!(now == before))
          found.push_back({from_.time + firstOther(last, t, before), before, now});
        before = now;
        last = t;
      }
      pressingAt(step_);
      from_ = probe_.state;
    }
    return found;
  }

 private:
  /// That time after the step's start.
  Pressing pressingAt(double time) {
    probe_.state = from_;
    probe_.model.solver.step = time;
    const StepReport report = probe_.steps(1);
    EXPECT_EQ(report.handed_over, 0) << from_.time;
    return pressingOf(probe_.model, probe_.state);
  }

  /// [s] Between two, where it is no longer `before`.
  double firstOther(double lo, double hi, const Pressing& before) {
    while (hi - lo > 1e-11) {
      const double middle = 0.5 * (lo + hi);
      (pressingAt(middle) == before ? lo : hi) = middle;
    }
    return hi;
  }

  double step_;
  State from_;
  World probe_;
};

/// From that time on, at that rate.
struct FallWindow {
  double from, rate;
};
class EventTimes : public testing::TestWithParam<FallWindow> {};

TEST_P(EventTimes, OfAFallAreTheSameForAnyStep) {
  World first(fallAt(480));
  while (first.state.time < GetParam().from - 1e-9) first.steps(1);
  const std::vector<Change> fine = Changes(1920).after(first.state);
  EXPECT_GT(fine.size(), 5u);
  const std::vector<Change> coarse = Changes(GetParam().rate).after(first.state);
  ASSERT_EQ(coarse.size(), fine.size());
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_NEAR(coarse[i].time, fine[i].time, 1e-9);
    EXPECT_EQ(coarse[i].before, fine[i].before) << fine[i].time;
    EXPECT_EQ(coarse[i].now, fine[i].now) << fine[i].time;
  }
}

// It lands on its feet, on knees and hands, and comes to lie. Later windows are dear: those up to
// 1.8 s agree, too (23 changes more; one of their probes is handed over).
INSTANTIATE_TEST_SUITE_P(Windows, EventTimes,
                         testing::Values(FallWindow{0.6, 240}, FallWindow{0.7, 120},
                                         FallWindow{0.8, 240}));

}  // namespace
}  // namespace ragdoll::test
