#include "core/direct/impulse_cache.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

Contact pairContact(int a, int b, int c, int d) {
  Contact contact;
  contact.particle = {a, b, c, d};
  contact.count = 4;
  return contact;
}

TEST(ImpulseCache, FindsTheSameContactOrLimitAndNoOther) {
  Contact floor;
  floor.particle = {7};
  floor.count = 1;
  floor.obstacle = 2;
  LimitRow limit;
  limit.limit = 7;
  ImpulseCache cache;
  cache.add(keyOf(floor));
  cache.last().impulse = Vec3(1, 2, 3);
  cache.add(keyOf(limit));
  cache.last().impulse = Vec3(4, 0, 0);
  EXPECT_EQ(cache.find(floor)->impulse, Vec3(1, 2, 3));
  EXPECT_EQ(cache.find(limit)->impulse, Vec3(4, 0, 0));
  floor.obstacle = 1;
  limit.limit = 6;
  EXPECT_EQ(cache.find(floor), nullptr);
  EXPECT_EQ(cache.find(limit), nullptr);
}

TEST(ImpulseCache, HandsOutEachImpulseOnce) {
  const Contact contact = pairContact(0, 1, 5, 6);  // capsules along each other: two of them
  ImpulseCache cache;
  for (const double force : {1.0, 2.0}) {
    cache.add(keyOf(contact));
    cache.last().impulse = Vec3(0, 0, force);
  }
  cache.startHandingOut();
  EXPECT_EQ(cache.handOut(pairContact(0, 1, 5, 7)), nullptr);
  EXPECT_EQ(cache.handOut(contact)->impulse.z(), 1);
  EXPECT_EQ(cache.handOut(contact)->impulse.z(), 2);
  EXPECT_EQ(cache.handOut(contact), nullptr);
}

}  // namespace
}  // namespace ragdoll
