// What is drawn from a seed: the same fall, every kind, within what docs/data.md says.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "human.h"
#include "ragdoll_sim/falls/fall.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/error_of.h"

namespace ragdoll::falls {
namespace {

using test::errorOf;

constexpr double kStep = 1.0 / 200;

std::string textOf(std::uint64_t seed) {
  const Fall fall = drawFall(seed);
  return toYaml(fallScene(fall, scaledModel(*human(), fall.scale), kStep).scene);
}

TEST(DrawFall, TheSameSeedIsTheSameFallAndAnotherIsNot) {
  std::set<std::string> all;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    EXPECT_EQ(textOf(seed), textOf(seed));
    EXPECT_EQ(drawFall(seed).onset, drawFall(seed).onset);
    all.insert(textOf(seed));
  }
  EXPECT_EQ(all.size(), 40u);
}

TEST(DrawFall, AnyFortySeedsHaveEveryKind) {
  for (const std::uint64_t first : {0u, 17u, 3990u, 99999960u}) {
    std::map<std::pair<std::string, std::string>, int> kinds;
    std::set<std::uint64_t> scenes;
    for (std::uint64_t seed = first; seed < first + kScenes; ++seed) {
      ++kinds[{drawFall(seed).kind, drawFall(seed).start}];
      scenes.insert(sceneOf(seed));
    }
    EXPECT_EQ(kinds.size(), 10u);
    for (const auto& [kind, count] : kinds) EXPECT_EQ(count, 4) << kind.first << kind.second;
    EXPECT_EQ(scenes.size(), 40u);
  }
}

TEST(DrawFall, FallsOfOneSceneShareBodyFrictionAndPins) {
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    const Fall a = drawFall(seed), b = drawFall(seed + kScenes), c = drawFall(seed + 4000);
    EXPECT_EQ(sceneOf(seed), sceneOf(seed + kScenes));
    EXPECT_NE(sceneOf(seed), sceneOf(seed + 4000));
    EXPECT_EQ(a.height, b.height);
    EXPECT_NE(a.height, c.height);
    EXPECT_EQ(a.friction, b.friction);
    EXPECT_EQ(a.hold, b.hold);
    EXPECT_EQ(a.foot, b.foot);
  }
}

TEST(DrawFall, HeightsAreThoseOfAdults) {
  double sum = 0, squares = 0;
  constexpr int kBlocks = 100;
  for (std::uint64_t block = 0; block < kBlocks; ++block)
    for (std::uint64_t seed = 4000 * block; seed < 4000 * block + kScenes; ++seed) {
      const Fall fall = drawFall(seed);
      EXPECT_GE(fall.height, 1.45);
      EXPECT_LE(fall.height, 1.98);
      EXPECT_NEAR(fall.mass, 75 * std::pow(fall.height / 1.75, 3), 1e-9);
      sum += fall.height;
      squares += fall.height * fall.height;
    }
  const double n = kBlocks * kScenes, mean = sum / n;
  EXPECT_NEAR(mean, 1.69, 4 * 0.095 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 0.095, 0.004);
}

TEST(DrawFall, PushesTripsSlipsAndFaintsAreWhatTheyAreCalled) {
  const auto model = human();
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Fall fall = drawFall(seed);
    const FallScene made = fallScene(fall, model, kStep);
    EXPECT_EQ(fall.kind == "push", made.scene.pokes.size() == 1) << seed;
    EXPECT_EQ(fall.kind == "trip", made.held() == std::vector<std::string>{fall.foot}) << seed;
    EXPECT_EQ(fall.kind == "trip" ? fall.hold : 0, made.release) << seed;
    EXPECT_EQ(fall.kind == "faint", made.held().size() == model->particles.size()) << seed;
    EXPECT_EQ(fall.kind == "slip", fall.foot_friction > 0) << seed;
    EXPECT_EQ(fall.kind == "slip", made.floors == 2) << seed;
    EXPECT_EQ(fall.kind == "trip" || fall.kind == "slip", fall.speed > 0) << seed;
    if (fall.kind == "push") {
      EXPECT_GE(fall.push.norm(), 100 * fall.mass / 75 * 0.999) << seed;
      EXPECT_LE(fall.push.norm(), 500 * fall.mass / 75 * 1.001) << seed;
    }
  }
}

TEST(DrawFall, RefusesSeedsBeyondTheLast) {
  EXPECT_NO_THROW(drawFall(kLastSeed));
  const std::string error = errorOf([] { drawFall(kLastSeed + 1); });
  EXPECT_NE(error.find("99999999"), std::string::npos) << error;
}

TEST(DrawFall, RefusesAModelWithoutWhatAFallNeeds) {
  SkeletonSpec model = *human();
  for (ParticleSpec& p : model.particles)
    if (p.name == "left_foot") p.name = "left_hoof";
  const std::string error =
      errorOf([&] { fallScene(drawFall(1), std::make_shared<SkeletonSpec>(model), kStep); });
  EXPECT_NE(error.find("left_foot"), std::string::npos) << error;
}

TEST(StepsPerSample, AreWholeOrNameTheRatesThatAre) {
  EXPECT_EQ(stepsPerSample(100, kStep), 2);
  EXPECT_EQ(stepsPerSample(200, kStep), 1);
  EXPECT_EQ(stepsPerSample(1, kStep), 200);
  for (const double rate : {60.0, 300.0, -1.0, 0.0, std::nan("")}) {
    const std::string text = errorOf([&] { stepsPerSample(rate, kStep); });
    EXPECT_NE(text.find("--rate"), std::string::npos) << text;
    const char* fit = rate == 60 ? "50 or 66.6667 Hz" : rate == 300 ? "be 200 Hz" : "(0, 10000] Hz";
    EXPECT_NE(text.find(fit), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace ragdoll::falls
