#include "core/direct/mode_spin.h"

#include <gtest/gtest.h>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// Rods of 1 m that cross in the air, one above the other, and press where they cross.
struct RodsThatPress : ModeBody {
  explicit RodsThatPress(int count = 2, bool pinned = false) : ModeBody(scene(count, pinned)) {
    mode().rows.clear();
    for (int k = 0; k + 1 < count; ++k) {
      ModeRow row;
      row.kind = ModeRow::Kind::kPair;
      row.body = k;
      row.other = k + 1;
      row.b = row.d = 1;
      row.ra = row.rb = row.rc = row.rd = kRadius;
      row.friction = 0.5;
      row.closed = row.presses = true;
      mode().rows.push_back(row);
    }
  }
  static constexpr double kRadius = 0.05;

  static Scene scene(int count, bool pinned) {
    Scene scene = modeScene(oneStick(1, 3, kRadius), Vec3(0, 0, 5), floorPlane());
    scene.ragdoll_collision = true;
    scene.ragdolls.resize(count, scene.ragdolls[0]);
    for (int k = 0; k < count; ++k) {
      RagdollSpec& rod = scene.ragdolls[k];
      rod.name = "rod" + std::to_string(k);
      rod.pose.position = Vec3(k % 2 ? 0.4 : 0, k % 2 ? -0.7 : 0, 5 - 0.12 * k);
      rod.pose.orientation =
          Quat(Eigen::AngleAxisd(k % 2 ? 1.4 : 0.1, Vec3(0, 0.2, 1).normalized()));
    }
    if (pinned) scene.pins = {PinSpec{}};
    if (pinned) scene.pins[0].particle = "rod0/a";
    return scene;
  }

  double mass(int k) { return k % 2 ? 3 : 1; }  // of each coordinate's particle, in turn
  int particles() { return 2 * static_cast<int>(island.bodies.size()); }
  /// Calls use(mass, place among the coordinates) for each particle.
  template <class Use>
  void forEach(const Use& use) {
    for (int k = 0; k < particles(); ++k) use(mass(k), mode().offset[k / 2] + 3 * (k % 2));
  }
  Vec3 centre() {
    Vec3 sum = Vec3::Zero();
    double all = 0;
    forEach([&](double m, int at) { sum += m * now().x.segment<3>(at), all += m; });
    return sum / all;
  }
  /// [kg m^2/s] about the centre.
  Vec3 angularMomentum(const RowValues& v) {
    Vec3 sum = Vec3::Zero();
    forEach([&](double m, int at) {
      sum += m * (now().x.segment<3>(at) - centre()).cross(Vec3(v.segment<3>(at)));
    });
    return sum;
  }
  /// All turn as one.
  void turn(const Vec3& rate, const Vec3& drift) {
    forEach([&](double, int at) {
      now().v.segment<3>(at) = drift + rate.cross(Vec3(now().x.segment<3>(at) - centre()));
    });
  }
  /// Any motion.
  RowValues motion(double phase) {
    RowValues v;
    v.setZero(mode().size);
    forEach([&](double, int at) {
      v.segment<3>(at) = Vec3(std::sin(phase + at), std::cos(2 * phase + at), std::sin(3 * at));
    });
    return v;
  }
  RowPlace place(const RowValues& x, const RowValues& v, bool curvature = false) {
    return placeOf(island, row(0), x.data(), v.data(), curvature);
  }
  Vec3 slip(const RowValues& x, const RowValues& v) {
    return slipOf(island, row(0), place(x, v), x.data(), v.data());
  }
  void find(SpinOf which = SpinOf::kPressing) {
    findSpins(island, now().x.data(), now().v.data(), which);
  }
};

const Vec3 kTurn(0.7, -1.1, 0.9), kDrift(2, 3, -4);

TEST(ModeSpin, IsThatOfAllAsOne) {
  RodsThatPress rods;
  rods.turn(kTurn, kDrift);
  rods.find();
  const GroupSpin& spin = rods.mode().spins[0];
  EXPECT_LT((spin.rate - kTurn).norm(), 1e-13);
  EXPECT_LT((spin.centre - rods.centre()).norm(), 1e-14);
  EXPECT_LT((spin.inertia * kTurn - rods.angularMomentum(rods.now().v)).norm(), 1e-13);
}

/// Friction between axes that are apart does not hold bodies that turn as one.
TEST(ModeSpin, OfBodiesThatTurnAsOneIsNoSlip) {
  RodsThatPress rods;
  rods.turn(kTurn, kDrift);
  rods.find();
  const RowPlace place = rods.place(rods.now().x, rods.now().v);
  EXPECT_GT(motionOf(rods.island, place.contact, rods.now().v.data()).norm(), 0.1);
  EXPECT_LT(rods.slip(rods.now().x, rods.now().v).norm(), 1e-13);
}

/// A chain of rods of which each presses on the next; then the last one lets go, is held by a
/// floor, and the first by a pin.
TEST(ModeSpin, IsOfBodiesThatNothingOutsideHolds) {
  using Groups = std::vector<int>;
  RodsThatPress rods(3);
  rods.find();
  EXPECT_EQ(rods.mode().spin_of, (Groups{0, 0, 0}));
  rods.row(1).presses = false;
  rods.find();
  EXPECT_EQ(rods.mode().spin_of, (Groups{0, 0, -1}));
  rods.find(SpinOf::kClosed);
  EXPECT_EQ(rods.mode().spin_of, (Groups{0, 0, 0}));
  ModeRow floor;
  floor.body = 2;
  floor.obstacle = 0;
  floor.closed = true;
  rods.mode().rows.insert(rods.mode().rows.begin(), floor);
  rods.find(SpinOf::kClosed);
  EXPECT_EQ(rods.mode().spin_of, (Groups{-1, -1, -1}));
  rods.find();
  EXPECT_EQ(rods.mode().spin_of, (Groups{0, 0, -1}));
  RodsThatPress hung(2, true);
  hung.find();
  EXPECT_EQ(hung.mode().spin_of, (Groups{-1, -1}));
}

/// An impulse of friction, by what the system's rows say it moves: angular momentum stays, and the
/// slip changes as the coupled matrix has it.
TEST(ModeSpin, AnswersToFrictionKeepAngularMomentum) {
  RodsThatPress rods;
  rods.now().v = rods.motion(0.3);
  rods.find();
  ModeSystem system;
  const double *x = rods.now().x.data(), *v = rods.now().v.data();
  ASSERT_TRUE(buildModeSystem(rods.island, x, v, false, system));
  const ModeMatrix alone = system.A;
  coupleFriction(rods.island, system.A);
  EXPECT_GT((system.A - alone).norm(), 1e-3);
  system.p = Vec3(2, 0.4, -0.7);
  RowValues moved = rods.now().v;
  IslandScratch& s = rods.island.s;
  s.p = system.p;
  s.joint.split(s.p, s.parts);
  for (std::size_t k = 0; k < s.bodies.size(); ++k)
    s.bodies[k]->memory->schur.move(s.parts[k], moved.data() + rods.mode().offset[k]);
  EXPECT_GT((rods.angularMomentum(moved) - rods.angularMomentum(rods.now().v)).norm(), 1e-2);
  addSpins(rods.island, system.p, x, moved.data());
  EXPECT_LT((rods.angularMomentum(moved) - rods.angularMomentum(rods.now().v)).norm(), 1e-13);
  const RowPlace place = rods.place(rods.now().x, rods.now().v);
  const std::array<Vec3, 3> along = place.contact.directions();
  const Vec3 change = rods.slip(rods.now().x, moved) - rods.slip(rods.now().x, rods.now().v);
  const ModeVector answer = system.A * system.p;
  for (int k = 1; k < 3; ++k) EXPECT_NEAR(along[k].dot(change), answer[k], 1e-13);
}

/// Rates along the tangents are those of the slip, and accelerations how these change as the bodies
/// go on, by differences.
TEST(ModeSpin, RatesAndAccelerationsAreThoseOfTheSlip) {
  RodsThatPress rods;
  ModePoint& now = rods.now();
  now.v = rods.motion(0.3);
  now.a = rods.motion(1.7);
  rods.find();
  ModeSystem system;
  ASSERT_TRUE(buildModeSystem(rods.island, now.x.data(), now.v.data(), true, system));
  ModeVector rates = ModeVector::Zero(3), accelerations = ModeVector::Zero(3);
  takeSpinRates(rods.island, rates);
  takeSpinAccelerations(rods.island, now, accelerations);
  const std::array<Vec3, 3> along = rods.place(now.x, now.v).contact.directions();
  const auto spinAt = [&](double t) {
    RowValues x, v;
    x = now.x + t * now.v + 0.5 * t * t * now.a;
    v = now.v + t * now.a;
    return spinMotion(rods.island, rods.row(0), rods.place(x, v), x.data(), v.data());
  };
  const double e = 1e-5;
  const Vec3 changes = (spinAt(e) - spinAt(-e)) / (2 * e);
  EXPECT_EQ(rates[0], 0);
  EXPECT_EQ(accelerations[0], 0);
  for (int k = 1; k < 3; ++k) {
    EXPECT_NEAR(rates[k], -along[k].dot(spinAt(0)), 1e-14);
    EXPECT_NEAR(accelerations[k], -along[k].dot(changes), 1e-8);
  }
}

}  // namespace
}  // namespace ragdoll
