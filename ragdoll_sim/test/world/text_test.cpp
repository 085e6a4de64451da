#include "ragdoll_sim/world/text.h"

#include <gtest/gtest.h>

#include <limits>

#include "particles.h"
#include "ragdoll_sim/core/build_model.h"
#include "support/error_of.h"

namespace ragdoll {
namespace {

using test::errorOf;
using test::floorPlane;
using test::particles;

TEST(Text, ListsTwentyNamesAndCountsTheRest) {
  std::vector<std::string> names(20, "a");
  EXPECT_EQ(listed(names).find("more"), std::string::npos);
  names.resize(27, "b");
  const std::string text = listed(names);
  EXPECT_EQ(text.substr(text.size() - 11), " and 7 more");
  EXPECT_EQ(text.find('b'), std::string::npos);
}

TEST(Text, ShowsVectorsAndWhatAModelHas) {
  EXPECT_EQ(shown(Vec3(1, -2.5, 0)), "(1, -2.5, 0)");
  Scene scene = particles(2);
  scene.obstacles.push_back(floorPlane());
  EXPECT_EQ(contents(buildModel(scene)), "2 ragdolls, 1 obstacle");
}

TEST(Text, NamesWhatIsNotFinite) {
  EXPECT_NO_THROW(checkFinite(Vec3(1, 2, 3), "force", "[N]"));
  const Vec3 broken(1, std::numeric_limits<double>::quiet_NaN(), 3);
  const std::string error = errorOf([&] { checkFinite(broken, "force", "[N]"); });
  EXPECT_NE(error.find("force"), std::string::npos) << error;
  EXPECT_NE(error.find("[N]"), std::string::npos) << error;
}

TEST(Text, FullNamesHaveTheRagdoll) {
  const Model model = buildModel(particles(2));
  BodyRef body;
  body.ragdoll = 1;
  EXPECT_EQ(fullName(model, body, "p"), "other_1/p");
  EXPECT_EQ(fullName(model, body, "other_1/p"), "other_1/p");
}

}  // namespace
}  // namespace ragdoll
