#include "core/direct/mode_energy.h"

#include <gtest/gtest.h>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// Balls of 2 kg: two that press on each other, and one by itself.
struct ThreeBalls : ModeBody {
  ThreeBalls() : ModeBody(scene()) {
    mode().rows.clear();
    ModeRow row;
    row.kind = ModeRow::Kind::kPair;
    row.body = 0;
    row.other = 1;
    mode().rows.push_back(row);
    mode().first.assign(1, 0);
    move({1, 0, 0}, {-1, 0, 0}, {0, 3, 0});
    findEnergies(island, now(), before);
  }
  void move(const Vec3& first, const Vec3& second, const Vec3& third) {
    for (int k = 0; k < 3; ++k)
      now().v.segment<3>(mode().offset[k]) = k == 0 ? first : k == 1 ? second : third;
  }
  Vec3 v(int k) { return now().v.segment<3>(mode().offset[k]); }
  void takeGains(double pressed) {
    ModeVector p(1);
    p[0] = pressed;
    takeImpactGains(island, p, before, now());
  }
  std::vector<double> before;

  static Scene scene() {
    Scene scene = modeScene(oneParticle(2, 0.1), Vec3(0, 0, 5), floorPlane());
    scene.ragdoll_collision = true;
    scene.ragdolls.resize(3, scene.ragdolls[0]);
    for (int k = 0; k < 3; ++k) {
      scene.ragdolls[k].name = "ball" + std::to_string(k);
      scene.ragdolls[k].pose.position.x() = 0.2 * k;
    }
    return scene;
  }
};

/// 1 m/s against each other before, 2 m/s after: the gain is out, the common 0.5 m/s stays, and so
/// does the third.
TEST(ModeEnergy, TakesAGainOutOfThoseThatWerePressedOnEachOther) {
  ThreeBalls balls;
  balls.move({-1.5, 0, 0}, {2.5, 0, 0}, {0, 3, 0});
  balls.takeGains(1);
  const double apart = std::sqrt(1 - 0.25);  // 2 kg (apart^2 + 0.5^2) = 2 J
  EXPECT_LT((balls.v(0) - Vec3(0.5 - apart, 0, 0)).norm(), 1e-12);
  EXPECT_LT((balls.v(1) - Vec3(0.5 + apart, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(balls.v(2), Vec3(0, 3, 0));
}

TEST(ModeEnergy, LeavesALoss) {
  ThreeBalls balls;
  balls.move({-0.5, 0, 0}, {0.5, 0, 0}, {0, 3, 0});
  balls.takeGains(1);
  EXPECT_EQ(balls.v(0), Vec3(-0.5, 0, 0));
  EXPECT_EQ(balls.v(1), Vec3(0.5, 0, 0));
}

}  // namespace
}  // namespace ragdoll
