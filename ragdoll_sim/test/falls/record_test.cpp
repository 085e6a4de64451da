// Records: the same whatever is simulated beside them, and labels computed anew from positions.
#include "ragdoll_sim/falls/record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/error_of.h"

namespace ragdoll::falls {
namespace {

Options optionsOf(const std::string& preset, double seconds) {
  Options options;
  options.seconds = seconds;
  options.settings = {"solver.preset=" + preset};
  return options;
}

/// [m] of the particle p in sample k.
Vec3 at(const Record& r, std::size_t n, int k, std::size_t p) {
  const float* x = r.positions.data() + 3 * (k * n + p);
  return Vec3(x[0], x[1], x[2]);
}

std::size_t indexOf(const Recorder& recorder, const std::string& name) {
  const auto& names = recorder.particles();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

void expectSame(const Record& a, const Record& b) {
  EXPECT_EQ(a.fall.seed, b.fall.seed);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.imu, b.imu);
  EXPECT_EQ(a.onset, b.onset);
  EXPECT_EQ(a.outcome.impact_time, b.outcome.impact_time);
  EXPECT_EQ(a.outcome.impact_speed, b.outcome.impact_speed);
  EXPECT_EQ(a.peak_force, b.peak_force);
  EXPECT_EQ(a.hic15, b.hic15);
}

class Records : public testing::TestWithParam<std::string> {};

TEST_P(Records, TheSameSeedIsTheSameRecordWhateverIsBesideIt) {
  Options options = optionsOf(GetParam(), 1.2);
  const Recorder one(options);
  options.threads = 2;
  const Recorder two(options);
  const std::vector<Record> among = two.record(1, 90);  // two or three of each scene
  for (const std::uint64_t seed : {1u, 3u, 42u, 44u, 87u}) {
    const std::vector<Record> alone = one.record(seed, 1);
    expectSame(alone[0], among[seed - 1]);
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, Records, testing::Values("fast", "balanced"));

/// All kinds, looked at from their positions alone.
class Labels : public testing::Test {
 protected:
  static const std::vector<Record>& made(const Recorder& recorder) {
    static const std::vector<Record> all = recorder.record(0, 40);
    return all;
  }
  double rate() const { return recorder.options().rate; }

  const Recorder recorder{optionsOf("fast", 4)};
  const std::vector<Record>& records = made(recorder);
  const std::size_t n = recorder.particles().size();
};

TEST_F(Labels, BeforeTheOnsetTheBodyIsHeldOrCarriedEvenly) {
  for (const Record& r : records) {
    const int quiet = static_cast<int>(std::lround(r.onset * rate()));
    ASSERT_GE(quiet, 30);
    for (std::size_t p = 0; p < n; ++p) {
      const Vec3 speed = (at(r, n, quiet - 1, p) - at(r, n, 0, p)) * rate() / (quiet - 1);
      EXPECT_NEAR(speed.norm(), r.fall.speed, 1e-3) << r.fall.seed;
    }
    double turn = 0;  // [m] from where the even motion would be, 0.2 s later: it falls
    for (std::size_t p = 0; p < n; ++p)
      turn = std::max(turn, (at(r, n, quiet + 19, p) - 21 * at(r, n, quiet - 1, p) +
                             20 * at(r, n, quiet - 2, p)).norm());
    EXPECT_GT(turn, 0.01) << r.fall.seed;
  }
}

TEST_F(Labels, AFaintFallsFromRestAtOnce) {
  int faints = 0;
  for (const Record& r : records) {
    if (r.fall.kind != "faint") continue;
    ++faints;
    const int quiet = static_cast<int>(std::lround(r.onset * rate()));
    const std::size_t head = indexOf(recorder, "head");
    EXPECT_EQ(at(r, n, 0, head), at(r, n, quiet - 1, head));
    // Freely to begin with: no limb is faster than g lets the body be, lever arms twice that.
    for (int k = 1; k <= 10; ++k)
      EXPECT_LT((at(r, n, quiet - 1 + k, head) - at(r, n, 0, head)).norm(), 9.81 * std::pow(k / rate(), 2) + 1e-5);
    EXPECT_LT(at(r, n, recorder.samples() - 1, head).z(), at(r, n, 0, head).z() - 0.3) << r.fall.seed;
  }
  EXPECT_EQ(faints, 12);
}

TEST_F(Labels, ImpactOnTheFlatIsTheFirstSampleAtTheFloor) {
  int checked = 0;
  const double human_radius = 0.03;  // [m] no particle of a body has less
  for (const Record& r : records) {
    if (r.fall.start == "stairs" || !r.outcome.impact_time) continue;
    const int k = static_cast<int>(std::lround(*r.outcome.impact_time * rate())) - 1;
    const std::size_t hit = indexOf(recorder, r.outcome.impact_body);
    const double touch = at(r, n, k, hit).z();  // its radius, but for what it sank in
    EXPECT_LT(touch, 0.2) << r.fall.seed;
    for (std::size_t p = 0; p < n; ++p) {
      if (recorder.particles()[p].find("foot") != std::string::npos) continue;
      for (int before = 0; before < k; ++before)
        EXPECT_GT(at(r, n, before, p).z(), human_radius) << r.fall.seed << recorder.particles()[p];
    }
    // It came down, as differences of positions tell; what slows down already, as its neighbour is
    // hit, by as much more as in the last sample.
    const auto speedBefore = [&](int sample) {
      return (at(r, n, sample, hit) - at(r, n, sample - 1, hit)).norm() * rate();
    };
    const double speed = speedBefore(k - 1), slowed = std::max(0.0, speedBefore(k - 2) - speed);
    EXPECT_NEAR(r.outcome.impact_speed, speed, 0.2 * speed + 0.2 + slowed) << r.fall.seed;
    ++checked;
  }
  EXPECT_GT(checked, 20);
}

TEST_F(Labels, ThePoseIsWhereTheBodysPartsLieAmongEachOther) {
  for (const Record& r : records) {
    const int last = recorder.samples() - 1;
    const auto z = [&](const char* name) { return at(r, n, last, indexOf(recorder, name)).z(); };
    const double across = z("left_shoulder") - z("right_shoulder");
    const double width = (at(r, n, last, indexOf(recorder, "left_shoulder")) -
                          at(r, n, last, indexOf(recorder, "right_shoulder"))).norm();
    const std::string& pose = r.outcome.end_pose;
    const double chest_looks_up_or_down = 0.8 * width + 1e-9, any = 2 * width;
    const double most = pose == "on_left_side" ? 0 : pose == "prone" || pose == "supine" ? chest_looks_up_or_down : any;
    const double least = pose == "on_right_side" ? 0 : -std::abs(most == 0 ? any : most);
    EXPECT_LE(across, most) << r.fall.seed << pose;
    EXPECT_GE(across, least) << r.fall.seed << pose;
    EXPECT_NEAR(r.outcome.end_head_height, z("head"), 1e-6);
  }
}

TEST(Recorder, RefusesOptionsThatCannotBe) {
  const auto refusal = [](const Options& options) {
    return test::errorOf([&] { Recorder recorder(options); });
  };
  Options o;
  o.rate = 60;
  EXPECT_NE(refusal(o).find("66.6667"), std::string::npos) << refusal(o);
  o = Options();
  o.seconds = 0;
  EXPECT_NE(refusal(o).find("--seconds"), std::string::npos);
  o.seconds = 0.004;
  EXPECT_NE(refusal(o).find("--seconds"), std::string::npos);
  o = Options();
  o.model = "nobody";
  EXPECT_NE(refusal(o).find("nobody"), std::string::npos);
  o = Options();
  o.settings = {"solver.step"};
  EXPECT_NE(refusal(o).find("key=value"), std::string::npos);
  o.settings = {"solver.speed=1"};
  EXPECT_NE(refusal(o).find("speed"), std::string::npos);
}

}  // namespace
}  // namespace ragdoll::falls
