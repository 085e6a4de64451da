// The head injury criterion against closed forms.
#include "ragdoll_sim/world/injury.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

constexpr double kG = HeadInjury::kG;

/// A half sine of so many g over `duration` [s], in exact means over steps of h.
double halfSine(double peak, double duration, double h) {
  HeadInjury injury;
  const int steps = static_cast<int>(std::lround(duration / h));
  const auto integral = [&](double t) {
    return peak * duration / M_PI * (1 - std::cos(M_PI * t / duration));
  };
  for (int i = 0; i < 10; ++i) injury.add(0, h);
  for (int i = 0; i < steps; ++i) injury.add(kG * (integral((i + 1) * h) - integral(i * h)) / h, h);
  for (int i = 0; i < 10; ++i) injury.add(0, h);
  return injury.hic15();
}

/// Of the best window, tau = 2 T x / pi with tan x = 5/3 x, or of 15 ms.
double closedForm(double peak, double duration) {
  double x = 1.05;
  for (int i = 0; i < 50; ++i) {
    const double f = std::tan(x) - 5.0 / 3 * x, slope = 1 / std::pow(std::cos(x), 2) - 5.0 / 3;
    x -= f / slope;
  }
  x = std::min(x, M_PI * HeadInjury::kWindow / (2 * duration));
  return 2 * duration * x / M_PI * std::pow(peak * std::sin(x) / x, 2.5);
}

TEST(HeadInjury, HalfSine) {
  for (const double duration : {0.006, 0.012, 0.03, 0.1})
    EXPECT_NEAR(halfSine(80, duration, 1e-5) / closedForm(80, duration), 1, 1e-5) << duration;
}

TEST(HeadInjury, ConstantAcceleration) {
  HeadInjury injury;
  for (int i = 0; i < 100; ++i) injury.add(100 * kG, 0.001);
  EXPECT_NEAR(injury.hic15(), 0.015 * 1e5, 1e-6);
  EXPECT_NEAR(injury.peakG(), 100, 1e-12);
  HeadInjury coarse;  // a step longer than the window
  for (int i = 0; i < 10; ++i) coarse.add(100 * kG, 0.02);
  EXPECT_NEAR(coarse.hic15(), 0.015 * 1e5, 1e-6);
}

TEST(HeadInjury, FreeFallIsOneG) {
  const Model model = buildModel(parseScene("ragdolls: [{model: human}]\n"));
  State state = startState(model);
  const Inputs inputs = startInputs(model);
  Workspace workspace;
  HeadInjuries heads(model);
  ASSERT_EQ(heads.heads().size(), 1u);
  EXPECT_EQ(heads.heads()[0].name, "ragdoll/head");
  for (int i = 0; i < 60; ++i) {
    heads.begin(state);
    step(model, inputs, workspace, state);
    heads.end(model, state);
  }
  EXPECT_NEAR(heads.heads()[0].injury.peakG(), 9.81 / kG, 1e-9);
}

}  // namespace
}  // namespace ragdoll
