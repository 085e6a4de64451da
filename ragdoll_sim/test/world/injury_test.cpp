// The head injury criterion, and what each region had to take, against closed forms.
#include "ragdoll_sim/world/injury.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <string>
#include <utility>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

constexpr double kStandardG = HeadInjury::kG;

/// A half sine of so many g over `duration` [s], in exact means over steps of h.
double halfSine(double peak, double duration, double h) {
  HeadInjury injury;
  const int steps = static_cast<int>(std::lround(duration / h));
  const auto integral = [&](double t) {
    return peak * duration / M_PI * (1 - std::cos(M_PI * t / duration));
  };
  for (int i = 0; i < 10; ++i) injury.add(0, h);
  for (int i = 0; i < steps; ++i)
    injury.add(kStandardG * (integral((i + 1) * h) - integral(i * h)) / h, h);
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
  for (int i = 0; i < 100; ++i) injury.add(100 * kStandardG, 0.001);
  EXPECT_NEAR(injury.hic15(), 0.015 * 1e5, 1e-6);
  EXPECT_NEAR(injury.peakG(), 100, 1e-12);
  HeadInjury coarse;  // a step longer than the window
  for (int i = 0; i < 10; ++i) coarse.add(100 * kStandardG, 0.02);
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
  EXPECT_NEAR(heads.heads()[0].injury.peakG(), 9.81 / kStandardG, 1e-9);
}

struct FallRun {
  HeadInjuries heads;
  RegionLoads loads;
};

/// What heads and regions took over a time [s].
FallRun runOf(const Scene& scene, double time) {
  const Model model = buildModel(scene);
  State state = startState(model);
  const Inputs inputs = startInputs(model);
  Workspace workspace;
  Contacts contacts(model);
  workspace.keepContacts(&contacts.log());
  FallRun run{HeadInjuries(model), {}};
  for (int i = 0; i < std::lround(time / model.solver.step); ++i) {
    contacts.begin(state);
    run.heads.begin(state);
    step(model, inputs, workspace, state);
    run.heads.end(model, state);
    contacts.end(model, inputs, state);
    run.loads.add(model, contacts.last(), model.solver.step);
    run.loads.add(model, contacts.take().impacts);
  }
  return run;
}

/// What a scene's regions took in so many steps.
RegionLoads::Loads loadsOf(const std::string& text, int steps) {
  const Scene scene = parseScene(text);
  return runOf(scene, steps * scene.solver.step).loads.loads();
}

const char* const kRod = R"(
    model:
      particles: {a: {position: [0, 0, 0], radius: 0.05}, b: {position: [1, 0, 0], radius: 0.05}}
      sticks: [[a, b]]
      segments: {rod: {from: a, to: b, mass: 3, com: 0.5, gyration: 0.28867513459481287}}
)";

TEST(RegionLoads, OfARodHitAtItsEndAreThoseOfAQuarterOfItsMass) {
  // Effective mass m / 4; impulse (1 + e) v m / 4, in one step.
  const auto loads = loadsOf(std::string("gravity: [0, 0, 0]\nsolver: {step: 0.01}\nragdolls:\n"
                                         "  - position: [0, 0, 0.5]\n    velocity: [0, 0, -2]") +
                                 kRod +
                                 "obstacles: [{type: box, position: [-0.5, 0, 0], size: [1.02, 1, "
                                 "0.2], restitution: 0.5, friction: 0}]\n",
                             60);
  ASSERT_EQ(loads.size(), 1u);
  const auto& [region, load] = *loads.begin();
  EXPECT_EQ(region, std::pair(0, std::string("rod")));
  EXPECT_NEAR(load.approach_energy, 0.5 * (3.0 / 4) * 2 * 2, 1e-6);
  EXPECT_NEAR(load.peak_force, 1.5 * 2 * (3.0 / 4) / 0.01, 1e-4);
}

TEST(RegionLoads, OfMethodsThatKeepNoAccountHaveTheSameApproach) {
  const auto energyOf = [](const char* solver, double edge) {
    const auto loads =
        loadsOf("gravity: [0, 0, 0]\nsolver: " + std::string(solver) +
                    "\nragdolls:\n  - position: [0, 0, 0.5]\n    velocity: [0, 0, -2]" + kRod +
                    "obstacles: [{type: box, position: [" + std::to_string(edge - 0.51) +
                    ", 0, 0], size: [1.02, 1, 0.2], restitution: 0, friction: 0}]\n",
                60);
    return loads.empty() ? 0 : loads.begin()->second.approach_energy;
  };
  const double energy = 0.5 * (3.0 / 4) * 2 * 2;
  for (const auto& [solver, off] : {std::pair("{method: fast, step: 0.01}", 1e-3),
                                    std::pair("{method: jakobsen, step: 0.01}", 0.06)}) {
    EXPECT_NEAR(energyOf(solver, 0), energy, off) << solver;
    EXPECT_EQ(energyOf(solver, -0.06), 0) << solver << ": it passes 1 cm beside the box";
  }
}

TEST(RegionLoads, ContactsOfARegionBearTogether) {
  const auto loads = loadsOf(
      "ragdolls:\n  - position: [0, 0, 0.05]" + std::string(kRod) + "obstacles: [{type: plane}]\n",
      60);
  ASSERT_EQ(loads.size(), 1u);
  EXPECT_NEAR(loads.begin()->second.peak_force, 3 * 9.81, 1e-6) << "both ends, not the larger";
  EXPECT_EQ(loads.begin()->second.approach_energy, 0) << "it lay there from the start";
}

TEST(RegionLoads, OfASpringReachItsPeakWithinAStep) {
  // v sqrt(m k) of a hard spring, whose touch lasts a fifth of a step.
  const double m = 2, k = 2e6, v = 1;
  const auto loads = loadsOf(
      "gravity: [0, 0, 0]\nragdolls: [{velocity: [0, 0, -1], position: [0, 0, 0.15], model: "
      "{particles: {p: {position: [0, 0, 0], mass: 2, radius: 0.1}}}}]\n"
      "obstacles: [{type: plane, stiffness: 2000000, damping: 0}]\nsolver: {step: 0.001}\n",
      100);
  ASSERT_EQ(loads.size(), 1u);
  EXPECT_EQ(loads.begin()->first.second, "p");
  EXPECT_NEAR(loads.begin()->second.peak_force / (v * std::sqrt(m * k)), 1, 0.01);
  EXPECT_NEAR(loads.begin()->second.approach_energy, 0.5 * m * v * v, 1e-3);
}

TEST(RegionLoads, BothBodiesTakeWhatTheyGiveEachOther) {
  const std::string ball =
      "model: {particles: {p: {position: [0, 0, 0], mass: 2, radius: 0.1}}}}\n";
  const auto loads = loadsOf(
      "gravity: [0, 0, 0]\nragdoll_collision: true\nragdolls:\n"
      "  - {name: al, position: [-0.3, 0, 0], velocity: [1, 0, 0], " +
          ball + "  - {name: ben, position: [0.3, 0, 0], velocity: [-1, 0, 0], " + ball,
      60);
  ASSERT_EQ(loads.size(), 2u);
  for (const auto& [region, load] : loads) {
    EXPECT_EQ(region.second, "p");
    EXPECT_NEAR(load.approach_energy, 0.5 * 1 * 2 * 2, 1e-9);  // m / 2, closing at 2 m/s
    EXPECT_GT(load.peak_force, 0);
  }
  EXPECT_EQ(loads.begin()->second.peak_force, std::next(loads.begin())->second.peak_force);
}

/// A region of the page, or "HIC15": of the last run, the larger of left and right, as the page
/// writes it, in kN and J or HIC and g.
std::pair<double, double> figuresOf(const FallRun& run, const std::string& region) {
  if (region == "HIC15")
    return {run.heads.heads()[0].injury.hic15(), run.heads.heads()[0].injury.peakG()};
  std::pair<double, double> figures{0, 0};
  std::string joined = region;
  std::replace(joined.begin(), joined.end(), ' ', '_');
  for (const auto& [key, load] : run.loads.loads()) {
    if (key.second != joined && key.second != "left_" + joined && key.second != "right_" + joined)
      continue;
    figures.first = std::max(figures.first, load.peak_force / 1000);
    figures.second = std::max(figures.second, load.approach_energy);
  }
  return figures;
}

/// "7.3 kN, 202 J", "745 (96 g)", "-".
std::pair<double, double> numbersIn(const std::string& cell) {
  static const std::regex number("([0-9.]+)[^0-9.]+([0-9.]+)");
  std::smatch found;
  if (!std::regex_search(cell, found, number)) return {0, 0};
  return {std::stod(found[1]), std::stod(found[2])};
}

TEST(InjuryPage, TellsWhatTheFallsGive) {
  std::ifstream page(std::string(RAGDOLL_SHARE_DIR) + "/../docs/injury.md");
  if (!page) GTEST_SKIP() << "the package stands alone, without docs/";
  const FallRun fall = runOf(loadScene("fall"), 5), stairs = runOf(loadScene("stairs"), 5);
  const std::regex row(R"(\| ([a-zA-Z0-9 ]+) \| [0-9][^|]*\| ([^|]+) \| ([^|]+) \|)");
  std::smatch found;
  int count = 0;
  for (std::string line; std::getline(page, line);) {
    if (!std::regex_match(line, found, row)) continue;
    ++count;
    for (const auto& [run, cell] : {std::pair(&fall, found[2]), std::pair(&stairs, found[3])}) {
      const auto [first, second] = figuresOf(*run, found[1]);
      const auto [told_first, told_second] = numbersIn(cell);
      EXPECT_NEAR(told_first, first, 0.04 * first) << line;
      EXPECT_NEAR(told_second, second, 0.04 * second) << line;
    }
  }
  EXPECT_EQ(count, 8);
}

}  // namespace
}  // namespace ragdoll
