#include "core/contact/stick_ends.h"

#include <gtest/gtest.h>

#include "core/contact/soft_chain.h"
#include "core/contact/stick_springs.h"

namespace ragdoll {
namespace {

using namespace test;

struct OnASoftBox {
  World world{chainOnASoftBox()};
  const Obstacle& box = world.model.obstacles[0];
  std::vector<Contact> contacts;

  Contact& add(int a, int b = -1, double gap = 0) {
    Contact c;
    c.particle = {a, b};
    c.count = b < 0 ? 1 : 2;
    c.give = box.contact;
    c.gap_start = gap;
    contacts.push_back(c);
    return contacts.back();
  }
  void share() { shareSprings(world.model, box, world.model.ragdolls[0], 0, contacts); }
  /// [N/m], [N s/m] Of the middle particle's own contact, if it has one.
  Eigen::Vector2d left() const {
    for (const Contact& c : contacts)
      if (c.count == 1 && c.particle[0] == 1) return {1 / c.give.compliance, c.give.damping};
    return {0, 0};
  }
};

/// What a stick that presses takes of it (endsOf) and what is left are the particle's spring.
TEST(SharedSprings, SticksAndTheirParticleHaveOneSpring) {
  for (const int pressing : {0, 1, 2}) {
    OnASoftBox one;
    one.add(1);
    if (pressing > 0) one.add(0, 1);
    if (pressing > 1) one.add(1, 2);
    one.share();
    const StickEnds ends =
        endsOf(one.world.model, one.box, one.world.model.ragdolls[0], 0, 1, one.box.contact);
    const Eigen::Vector2d part(1 / ends.b.compliance, ends.b.damping);
    EXPECT_LT((one.left() + pressing * part - Eigen::Vector2d(2000, 12)).norm(), 1e-9) << pressing;
    EXPECT_EQ(one.contacts.size(), pressing == 2 ? 2u : 1u + pressing);
  }
}

TEST(SharedSprings, ASticksTwoPlacesAreOneAndWhatIsRigidKeepsItsOwn) {
  OnASoftBox one;
  one.add(1);
  one.add(0, 1);
  one.add(0, 1);
  one.share();
  EXPECT_NEAR(one.left()[0], 1000, 1e-9);
  OnASoftBox rigid;
  rigid.add(1).give = {};
  rigid.add(0, 1);
  rigid.add(1, 2);
  rigid.share();
  EXPECT_EQ(rigid.contacts.size(), 3u);
}

/// On what is round a stick presses at its deepest place and its shallower end.
TEST(SharedSprings, OnWhatIsRoundTheDeeperEndHasNone) {
  for (const bool first : {false, true}) {
    OnASoftBox one;
    one.add(0, -1, first ? -0.02 : -0.01);
    one.add(1, -1, first ? -0.01 : -0.02);
    one.add(2, -1, -0.05);  // of another stick
    one.add(0, 1, -0.03);
    dropDeeperEnds(0, one.contacts);
    ASSERT_EQ(one.contacts.size(), 3u);
    EXPECT_EQ(one.contacts[0].particle[0], first ? 1 : 0);
    EXPECT_EQ(one.contacts[1].particle[0], 2);
  }
}

}  // namespace
}  // namespace ragdoll
