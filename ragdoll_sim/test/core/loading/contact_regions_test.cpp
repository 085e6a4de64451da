#include "core/loading/contact_regions.h"

#include <gtest/gtest.h>

#include <limits>

#include "ragdoll_sim/core/error.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ContactSpec contactOf(double stiffness, double damping = 0) {
  ContactSpec contact;
  contact.stiffness = stiffness;
  contact.damping = damping;
  return contact;
}

std::string refusal(const ContactSpec& contact) {
  try {
    complianceOf(contact, "obstacles[0].contact");
  } catch (const Error& e) {
    return e.where() + ": " + e.what();
  }
  return "";
}

TEST(ContactRegions, GiveWayByTheInverseOfTheirStiffness) {
  EXPECT_EQ(complianceOf(contactOf(5e4, 300), "").compliance, 1 / 5e4);
  EXPECT_EQ(complianceOf(contactOf(5e4, 300), "").damping, 300);
  EXPECT_EQ(complianceOf(contactOf(kInfinity), "").compliance, 0);  // rigid
  EXPECT_EQ(complianceOf(contactOf(1), "").compliance, 1);
  EXPECT_EQ(complianceOf(contactOf(1e12), "").compliance, 1e-12);
}

TEST(ContactRegions, RefuseWhatNoRunCanFollow) {
  for (const double k : {0.0, 0.99, -5.0, 1.1e12, -kInfinity, std::nan("")}) {
    const std::string told = refusal(contactOf(k));
    EXPECT_NE(told.find("obstacles[0].contact.stiffness"), std::string::npos) << k << ": " << told;
    EXPECT_NE(told.find("it must be from 1 to 1e+12 [N/m]"), std::string::npos) << told;
  }
  for (const double c : {-1e-9, 1.1e12, kInfinity, std::nan("")}) {
    const std::string told = refusal(contactOf(1e4, c));
    EXPECT_NE(told.find("obstacles[0].contact.damping"), std::string::npos) << c << ": " << told;
    EXPECT_NE(told.find("it must be from 0 to 1e+12 [N s/m]"), std::string::npos) << told;
  }
}

/// Particles a, b, c in a chain; the bone a-b is soft, b-c rigid.
TEST(ContactRegions, OfAParticleAreThoseOfTheBoneThatEndsThere) {
  SkeletonSpec s = oneStick();
  s.particles.push_back(particle("c", 2 * Vec3::UnitX()));
  s.sticks.push_back(stick("b", "c"));
  s.segments[0].contact = contactOf(1e4, 50);
  s.segments.push_back(bone("bc", "b", "c"));
  const World world(sceneOf(s));
  const Skeleton& skeleton = world.model.skeletonOf(world.model.ragdolls[0]);
  ASSERT_EQ(skeleton.particle_contact.size(), 3u);
  ASSERT_EQ(skeleton.stick_contact.size(), 2u);
  EXPECT_EQ(skeleton.particle_contact[0].compliance, 1e-4);  // nothing ends at a: the first bone
  EXPECT_EQ(skeleton.particle_contact[1].compliance, 1e-4);
  EXPECT_EQ(skeleton.particle_contact[1].damping, 50);
  EXPECT_EQ(skeleton.particle_contact[2].compliance, 0);
  EXPECT_EQ(skeleton.stick_contact[0].compliance, 1e-4);
  EXPECT_EQ(skeleton.stick_contact[1].compliance, 0);
}

}  // namespace
}  // namespace ragdoll
