#include "ragdoll_sim/body/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "frame_law.h"
#include "human_model.h"
#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll::test {
namespace {

/// [rad] the model's arms are straight but for the rounding of positions to 0.1 mm.
constexpr double kStraightness = 1e-4;

struct TrackedHuman {
  Model model = modelOf(humanSkeleton());
  FrameTracker tracker{model};
  const Skeleton& skeleton = model.skeletons[0];

  void reset(const Points& x) { tracker.reset(stateOf(x)); }
  void update(const Points& x) { tracker.update(stateOf(x, tracker.now().time + 1)); }
  const Pose& frame(const std::string& name) const {
    return tracker.now().frames[tracker.tree(0).frame(name)];
  }
};

TEST(Frames, RestPoseIsAlignedWithTheWorld) {
  TrackedHuman human;
  human.reset(human.skeleton.rest);
  for (int f = 0; f < human.tracker.size(); ++f)
    EXPECT_LT(angle(human.tracker.now().frames[f].orientation, Quat::Identity()), 1e-12)
        << human.tracker.name(f);
  EXPECT_EQ(human.tracker.name(0), "ragdoll/pelvis");
  EXPECT_EQ(human.frame("pelvis").position, Vec3::Zero());
  EXPECT_EQ(human.frame("right_hand").position, Vec3(-0.01, -0.346, -0.1545));
}

TEST(Frames, RigidMotionTurnsEveryFrameAlike) {
  TrackedHuman human;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto pose = posed(human.skeleton, {{"right_elbow", turn({0, -1, 0}, 1.3)},
                                           {"left_shoulder", turn({1, 0.4, 0}, 1.1)},
                                           {"right_leg", turn({0.2, -1, 0}, 0.7)},
                                           {"torso", turn({0, 1, 0}, 0.3)}});
  human.reset(pose);
  const auto start = human.tracker.now().frames;
  Quat q = Quat::Identity();
  for (int i = 0; i < 500; ++i) {
    const Vec3 w(normal(random), normal(random), normal(random));
    q = (turn(w, 0.3 * w.norm()) * q).normalized();
    human.update(q.toRotationMatrix() * pose);
    for (int f = 0; f < human.tracker.size(); ++f) {
      const Pose& now = human.tracker.now().frames[f];
      ASSERT_LT(angle(now.orientation, q * start[f].orientation), 1e-9) << human.tracker.name(f);
      ASSERT_LT((now.position - q * start[f].position).norm(), 1e-12);
    }
  }
}

TEST(Frames, BentElbowShowsTheTurnOfTheUpperArm) {
  TrackedHuman human;
  for (const double twist : {-1.2, -0.5, 0.0, 0.4, 1.0}) {
    const Quat shoulder = turn({0.3, 1, 0.1}, -1.0) * turn({0, 0, 1}, twist);
    human.reset(posed(human.skeleton,
                      {{"right_shoulder", shoulder}, {"right_elbow", turn({0, -1, 0}, 1.2)}}));
    EXPECT_LT(angle(human.frame("right_shoulder").orientation, shoulder), kStraightness) << twist;
    EXPECT_LT(angle(human.frame("right_elbow").orientation, shoulder * turn({0, -1, 0}, 1.2)),
              kStraightness);
  }
}

TEST(Frames, TwistIsFollowedInMotion) {
  TrackedHuman human;
  human.reset(human.skeleton.rest);
  for (int i = 0; i <= 300; ++i) {
    const double t = i / 300.0;
    const Quat shoulder = turn({0, 1, 0}, -1.5 * t) * turn({0, 0, 1}, 0.9 * std::sin(6 * t));
    const Quat elbow = turn({0, -1, 0}, 1.5 * t);
    human.update(posed(human.skeleton, {{"right_shoulder", shoulder}, {"right_elbow", elbow}}));
    if (t > 0.5) {
      ASSERT_LT(angle(human.frame("right_shoulder").orientation, shoulder), kStraightness) << t;
    }
  }
}

TEST(Frames, StraightArmDoesNotGatherTwist) {
  // A straight arm that circles carries holonomy in a parallel transport; the reference takes it
  // out.
  TrackedHuman human;
  human.reset(human.skeleton.rest);
  double most = 0;
  for (int i = 0; i <= 6000; ++i) {
    const double phase = 2 * M_PI * i / 300;
    const Quat shoulder = turn({std::cos(phase), std::sin(phase), 0}, 0.8);
    human.update(posed(human.skeleton, {{"right_shoulder", shoulder}}));
    most = std::max(most, angle(human.frame("right_shoulder").orientation, shoulder));
  }
  EXPECT_LT(most, 1.0);
}

TEST(Frames, StillBodyNeverTurns) {
  TrackedHuman human;
  human.reset(human.skeleton.rest);
  const auto pose = posed(human.skeleton, {{"right_shoulder", turn({1, 0, 0}, -2.0)},
                                           {"right_elbow", turn({1, 0, 1}, 0.8)}});
  human.update(pose);  // a jump: the twist lags behind
  human.update(pose);
  const auto before = human.tracker.now().parts;
  for (int i = 0; i < 100; ++i) human.update(pose);
  for (std::size_t p = 0; p < before.size(); ++p)
    EXPECT_LT(angle(before[p], human.tracker.now().parts[p]), 1e-12);
}

TEST(Frames, InterpolationMeetsItsEndsAndTheMiddle) {
  TrackedHuman human;
  human.reset(human.skeleton.rest);
  const Quat q = turn({0, 0, 1}, 0.4);
  const Points x = (q.toRotationMatrix() * human.skeleton.rest).colwise() + Vec3(1, 0, 0);
  human.update(x);
  Posture p;
  human.tracker.interpolate(0, p);
  EXPECT_EQ(p.x, human.skeleton.rest);
  EXPECT_EQ(p.time, 0);
  human.tracker.interpolate(1, p);
  EXPECT_LT((p.x - x).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(p.time, 1);
  human.tracker.interpolate(0.5, p);
  EXPECT_LT((p.x - (human.skeleton.rest + x) / 2).cwiseAbs().maxCoeff(), 1e-15);
  for (const Pose& pose : p.frames) EXPECT_LT(angle(pose.orientation, turn({0, 0, 1}, 0.2)), 1e-12);
}

TEST(Frames, LocalPosesComposeToTheWorld) {
  TrackedHuman human;
  human.reset(posed(human.skeleton,
                    {{"pelvis", turn({1, 2, 3}, 2)}, {"left_elbow", turn({0, -1, 0}, 1)}},
                    Vec3(1, 2, 3)));
  const Posture& now = human.tracker.now();
  for (int f = 0; f < human.tracker.size(); ++f) {
    Pose sum = human.tracker.local(now, f);
    for (int p = human.tracker.parent(f); p >= 0; p = human.tracker.parent(p)) {
      const Pose up = human.tracker.local(now, p);
      sum = {up.position + up.orientation * sum.position, up.orientation * sum.orientation};
    }
    EXPECT_LT((sum.position - now.frames[f].position).norm(), 1e-12);
    EXPECT_LT(angle(sum.orientation, now.frames[f].orientation), 1e-12);
  }
}

TEST(Frames, SeveralRagdollsHaveTheirOwn) {
  const Model model = modelOf(humanSkeleton(), 3);
  FrameTracker tracker(model);
  tracker.reset(stateOf(model.start_position));
  EXPECT_EQ(tracker.size(), 51);
  EXPECT_EQ(tracker.name(tracker.firstFrame(2)), "ragdoll2/pelvis");
  EXPECT_EQ(tracker.parent(tracker.firstFrame(2)), -1);
  EXPECT_EQ(tracker.parent(tracker.firstFrame(2) + 1), tracker.firstFrame(2));
  EXPECT_EQ(tracker.now().frames[tracker.firstFrame(2)].position, Vec3(0, 4, 0));
}

TEST(Frames, FollowingFewPartsGivesThemTheSameBits) {
  const TrackedHuman human;
  const FrameTree& tree = human.tracker.tree(0);
  for (std::size_t part = 0; part < tree.parts.size(); ++part) {
    FrameTracker all(human.model), few(human.model);
    few.followOnly({static_cast<int>(part)});
    std::mt19937 random(11);
    std::normal_distribution<double> normal(0, 0.03);
    Points x = human.skeleton.rest;
    all.reset(stateOf(x));
    few.reset(stateOf(x));
    for (int i = 1; i <= 50; ++i) {
      for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] += normal(random);
      all.update(stateOf(x, i));
      few.update(stateOf(x, i));
    }
    EXPECT_EQ(few.now().parts[part].coeffs(), all.now().parts[part].coeffs()) << tree.parts[part].name;
  }
}

TEST(Frames, CollapsedOrBrokenParticlesLeaveTheFrameWhereItWas) {
  TrackedHuman human;
  human.reset(human.skeleton.rest);
  Points x = human.skeleton.rest;
  x.col(human.skeleton.particle("right_hand")) = x.col(human.skeleton.particle("right_elbow"));
  x.col(human.skeleton.particle("left_hand")).setConstant(std::nan(""));
  human.update(x);
  for (int f = 0; f < human.tracker.size(); ++f)
    EXPECT_LT(angle(human.tracker.now().frames[f].orientation, Quat::Identity()), 1e-12);
}

/// Smooth random turn of bounded speed: turns about three axes by sums of sines.
class Wander {
 public:
  explicit Wander(unsigned seed, double rate) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (auto& row : term_)
      for (auto& t : row)
        t = {1 + uniform(random), rate * (1.2 + uniform(random)), 3.2 * uniform(random)};
  }
  Quat operator()(double t) const {
    return turn({0, 0, 1}, value(0, t)) * turn({0, 1, 0}, value(1, t)) *
           turn({1, 0, 0}, value(2, t));
  }
  double value(int i, double t) const {
    double sum = 0;
    for (const Term& s : term_[i]) sum += s.size * std::sin(s.rate * t + s.phase);
    return sum;
  }

 private:
  struct Term {
    double size, rate, phase;
  };
  Term term_[3][3];
};

/// Everything turns: joints without limits, so through poles, straight arms, hyperextension.
Points tumble(const Skeleton& s, double t) {
  static const std::vector<std::string> balls = {
      "pelvis", "torso", "neck", "left_shoulder", "right_shoulder", "left_leg", "right_leg"};
  static const std::vector<std::string> hinges = {"left_elbow", "right_elbow", "left_knee",
                                                  "right_knee"};
  std::map<std::string, Quat> turns;
  for (std::size_t i = 0; i < balls.size(); ++i) turns[balls[i]] = Wander(i + 1, 0.7)(t);
  turns["torso"] = turn({0, 1, 0}, Wander(90, 0.7).value(0, t));
  for (std::size_t i = 0; i < hinges.size(); ++i)
    turns[hinges[i]] = turn({0, 1, 0}, Wander(50 + i, 0.7).value(0, t));
  return posed(s, turns);
}

/// Follows `tumble` and returns the largest step of any part [rad].
double largestStep(double seconds, double dt) {
  TrackedHuman human;
  human.reset(tumble(human.skeleton, 0));
  FrameRecord record;
  const int steps = static_cast<int>(std::lround(seconds / dt));
  for (int i = 1; i <= steps && !testing::Test::HasFailure(); ++i) {
    human.update(tumble(human.skeleton, i * dt));
    expectContinuous(human.tracker, 0, record);
  }
  return record.step;
}

TEST(FramesLaw, TenMinutesOfTumblingWithoutAFlip) {
  const double coarse = largestStep(600, 1 / 60.0);
  EXPECT_LT(coarse, 1.2);
}

TEST(FramesLaw, StepsShrinkWithTheTimeStep) {
  // A flip would stay as large as it is however fine the steps; motion shrinks in proportion.
  const double coarse = largestStep(20, 1 / 240.0), fine = largestStep(20, 1 / 2400.0);
  EXPECT_LT(fine, 0.13 * coarse);
}

TEST(FramesLaw, SameStatesGiveSameBits) {
  TrackedHuman a;
  a.reset(tumble(a.skeleton, 0));
  for (int i = 1; i < 200; ++i) a.update(tumble(a.skeleton, i / 60.0));
  FrameTracker copy = a.tracker;
  for (int i = 200; i < 400; ++i) {
    a.update(tumble(a.skeleton, i / 60.0));
    copy.update(stateOf(tumble(a.skeleton, i / 60.0), copy.now().time + 1));
  }
  for (std::size_t p = 0; p < copy.now().parts.size(); ++p)
    EXPECT_EQ(copy.now().parts[p].coeffs(), a.tracker.now().parts[p].coeffs());
}

}  // namespace
}  // namespace ragdoll::test
