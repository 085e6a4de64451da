// Frames of others that come late, unevenly, after a silence or from elsewhere: what follows them
// flings nothing.
#include "ragdoll_sim/world/follow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/world.h"

namespace {

using ragdoll::Pose;
using ragdoll::Vec3;
using ragdoll::World;

constexpr double kLook = 0.01;     ///< [s] between two looks at TF, as Attachments looks
constexpr double kSilence = 1;     ///< [s] after which a frame comes back
constexpr double kAllowance = 3;   ///< [m/s] beyond the frame's own speed
constexpr double kFrameSpeed = 5;  ///< [m/s] docs/ros_api.md: a faster motion is a jump

const char* const kBall = R"(
gravity: [0, 0, 0]
ragdolls: [{model: {particles: {p: {position: [0, 0, 0], mass: 5, radius: 0.1}}}, position: [0, 0, 1]}]
obstacles: [{type: box, frame: pusher, position: [0, 0, 0], size: [0.2, 1, 1]}]
)";
/// On the floor, as in scenes/push.yaml: limbs of a body that is struck in the air whip.
const char* const kLying = R"(
ragdolls: [{model: human, position: [0, 0, 0.12], rpy_deg: [0, 90, 0]}]
obstacles:
  - {type: plane}
  - {type: box, frame: pusher, position: [0, 0, -0.7], size: [0.2, 1, 0.4]}
solver: {joint_damping: 2}
)";
const char* const kFree = R"(
gravity: [0, 0, 0]
ragdolls: [{name: ragdoll, model: human, position: [0, 0, 1]}]
)";

Pose at(double x) {
  Pose pose;
  pose.position = Vec3(x, 0, 1);
  return pose;
}

/// A world whose frame `pusher` is heard as Attachments would tell it.
class Followed {
 public:
  explicit Followed(const char* scene) : world_(ragdoll::parseScene(scene, "scene")) {}

  World& world() { return world_; }
  double fastest() const { return fastest_; }
  double own() const { return own_; }

  /// The frame is published here.
  void publish(const Pose& pose) {
    const double passed = std::max(kLook, now_ - published_);
    const double speed = (pose.position - sent_.position).norm() / passed;
    if (heard_ && speed < kFrameSpeed) own_ = std::max(own_, speed);
    sent_ = pose;
    published_ = now_;
    news_ = true;
  }
  /// Goes on until then [s], looking at the frame in between.
  void advanceTo(double time) {
    const double h = world_.stepLength();
    while (now_ < time) {
      if (now_ >= next_look_) look();
      world_.advance();
      now_ += h;
      fastest_ = std::max(fastest_, world_.state().v.colwise().norm().maxCoeff());
    }
  }
  double time() const { return now_; }

 private:
  void look() {
    next_look_ += kLook;
    if (!news_) return;
    news_ = false;
    world_.hear("pusher", sent_, heard_ && now_ - told_ > kSilence);
    heard_ = true;
    told_ = now_;
  }

  World world_;
  Pose sent_;
  double now_ = 0, next_look_ = 0, published_ = 0, told_ = 0, fastest_ = 0, own_ = 0;
  bool news_ = false, heard_ = false;
};

/// A box at 0.5 m/s that reaches the body, then nothing for a time, then the box again where it is
/// by then: what the body's fastest particle does [m/s].
double fastestAfterAGap(const char* scene, double gap, double jump) {
  Followed f(scene);
  const auto x = [](double t) { return -0.6 + 0.5 * t; };
  for (double t = 0; t < 1; t += 0.02) f.publish(at(x(t))), f.advanceTo(t + 0.02);
  const double begin = 1 + gap;
  f.advanceTo(begin);
  for (double t = begin; t < begin + 1; t += 0.02)
    f.publish(at(x(t) + jump)), f.advanceTo(t + 0.02);
  return f.fastest();
}

TEST(Follow, aGapFlingsNothing) {
  for (const char* scene : {kBall, kLying})
    for (const double gap : {0.1, 0.3, 0.6, 0.9, 1.5, 3.0})
      EXPECT_LT(fastestAfterAGap(scene, gap, 0), 0.5 + kAllowance) << gap << " s" << scene;
}

TEST(Follow, aJumpFlingsNothing) {
  for (const char* scene : {kBall, kLying})
    for (const double jump : {0.1, 0.3, 0.5, 1.0, 2.0, -0.5, -2.0})
      EXPECT_LT(fastestAfterAGap(scene, 0, jump), 0.5 + kAllowance) << jump << " m" << scene;
}

TEST(Follow, aJumpOfWhatHoldsAParticleFlingsNothing) {
  for (const double jump : {0.1, 0.5, 2.0, 5.0}) {
    Followed f(kFree);
    const int hand = ragdoll::findBody(*f.world().model(), "right_hand").particles[0];
    Pose pose;
    pose.position = f.world().state().x.col(hand);
    f.publish(pose);
    f.world().attach("right_hand", "pusher");
    f.advanceTo(1);
    pose.position.x() += jump;
    double end = 1;
    for (; end < 20; end += 0.02) f.publish(pose), f.advanceTo(end);
    EXPECT_LT(f.fastest(), kAllowance) << jump << " m";
    EXPECT_LT((f.world().state().x.col(hand) - pose.position).norm(), 1e-3) << jump << " m";
  }
}

/// A weightless body that is drawn by a hand whips the other one, some time later.
TEST(Follow, aSilenceOfWhatHoldsAParticleFlingsNothing) {
  for (const std::string model : {"human", "human_lumped"})
    for (const double silence : {0.3, 0.9, 1.5, 4.0})
      for (const double jump : {0.3, 2.0, 5.0}) {
        const std::string scene =
            "gravity: [0, 0, 0]\nragdolls: [{model: " + model + ", position: [0, 0, 1]}]\n";
        Followed f(scene.c_str());
        Pose pose;
        pose.position = f.world().state().x.col(
            ragdoll::findBody(*f.world().model(), "right_hand").particles[0]);
        f.publish(pose);
        f.world().attach("right_hand", "pusher");
        double t = 0;
        for (; t < 1; t += 0.02) f.publish(pose), f.advanceTo(t);
        t += silence;
        f.advanceTo(t);
        pose.position.x() += jump;
        for (const double end = t + 18; t < end; t += 0.02) f.publish(pose), f.advanceTo(t);
        EXPECT_LT(f.fastest(), kAllowance) << model << ", " << silence << " s, " << jump << " m";
      }
}

TEST(Follow, aJumpWakesWhoSleepsThere) {
  Followed f(kBall);
  f.publish(at(-2));
  f.advanceTo(2);
  ASSERT_TRUE(f.world().state().asleep[0]);
  f.publish(at(-0.05));
  f.advanceTo(3);
  EXPECT_GT(f.world().state().x(0, 0), 0.149);
}

TEST(Follow, aFrameThatTurnsByAJumpFlingsNothing) {
  Followed f(kBall);
  Pose pose = at(-0.7);
  for (double t = 0; t < 1; t += 0.02) f.publish(pose), f.advanceTo(t + 0.02);
  pose.orientation = Eigen::AngleAxisd(1.5, Vec3::UnitZ());
  for (double t = 1; t < 2; t += 0.02) f.publish(pose), f.advanceTo(t + 0.02);
  EXPECT_LT(f.fastest(), kAllowance);
}

TEST(Follow, whereItMovedWhilePausedItJumps) {
  Followed f(kBall);
  f.publish(at(-1));
  f.advanceTo(0.5);
  for (double x = -1; x < 0; x += 0.01) f.world().hear("pusher", at(x));  // without a step
  f.advanceTo(2);
  EXPECT_LT(f.fastest(), kAllowance);
}

/// A frame at up to `fastest` [m/s] that goes to and fro for 6 s, published 10 to 100 times a
/// second, with gaps, jitter and jumps of all sizes, every two seconds one. place: of the frame, by
/// how far it is on its way [m]. Returns what the fastest particle has beyond the frame's own
/// speed, as its news tell it [m/s].
template <class Place>
double excessOnARandomWay(Followed& f, unsigned seed, double fastest, const Place& place) {
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const double period = 1 / uniform(10, 100), speed = uniform(0, fastest);
  double x = uniform(-1.5, -0.5), direction = 1, sent = f.time();
  for (double t = f.time(), end = t + 6; t < end;) {
    t += period * uniform(0.3, 1.7);
    if (uniform(0, 1) < 0.5 * period) t += uniform(0.05, 2.5);
    x += direction * speed * (t - sent);
    sent = t;
    if (uniform(0, 1) < 0.5 * period) x += uniform(-2, 2);
    if (std::abs(x) > 1.5) direction = x > 0 ? -1 : 1;
    f.advanceTo(t);
    f.publish(place(x));
  }
  return f.fastest() - f.own();
}

/// The body only at speeds at which no impact, however it falls, whips a limb of it up to more.
TEST(Follow, nothingIsMuchFasterThanItsFrame) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const char* scene = seed % 2 == 0 ? kBall : kLying;
    Followed f(scene);
    EXPECT_LT(excessOnARandomWay(f, seed, scene == kBall ? 2 : 0.3, at), kAllowance)
        << "seed " << seed << scene;
  }
}

/// Weightless and undamped: nothing takes from a limb what it has been given. Of many more such
/// ways one of 200 whips a limb to more, of faster frames more of them (docs/research.md).
TEST(Follow, whoIsHeldIsNotMuchFasterThanTheFrame) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Followed f(kFree);
    const int hand = ragdoll::findBody(*f.world().model(), "right_hand").particles[0];
    const Vec3 start = f.world().state().x.col(hand);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const Vec3 way = Vec3(normal(random), normal(random), normal(random)).normalized();
    Pose pose;
    pose.position = start;
    f.publish(pose);
    f.world().attach("right_hand", "pusher");
    f.advanceTo(1);
    double from = NAN;  // it sets off where it is
    const auto place = [&](double x) {
      if (std::isnan(from)) from = x;
      pose.position = start + (x - from) * way;
      return pose;
    };
    EXPECT_LT(excessOnARandomWay(f, seed, 0.4, place), kAllowance) << "seed " << seed;
  }
}

}  // namespace
