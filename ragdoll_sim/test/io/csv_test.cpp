#include "ragdoll_sim/io/csv.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cstdlib>
#include <sstream>
#include <string>

#include "support/worlds.h"

namespace ragdoll {
namespace {

std::string textOf(double value) {
  std::string row = "row";
  appendCsv(value, row);
  return row;
}

TEST(Csv, NumbersReadBackToTheSameBits) {
  EXPECT_EQ(textOf(0.5), "row,0.5");
  EXPECT_EQ(textOf(0.1), "row,0.10000000000000001");
  for (const double value : {1.0 / 3, -2e-308, 1.7976931348623157e308, 5e-324, -0.0})
    EXPECT_EQ(std::strtod(textOf(value).c_str() + 4, nullptr), value);
}

TEST(Csv, NumbersHaveAPointInEveryLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  if (!std::setlocale(LC_NUMERIC, "de_DE.UTF-8") && !std::setlocale(LC_NUMERIC, "fr_FR.UTF-8"))
    GTEST_SKIP() << "no locale with a decimal comma is installed";
  const std::string text = textOf(-0.5);
  std::setlocale(LC_NUMERIC, before.c_str());
  EXPECT_EQ(text, "row,-0.5");
}

TEST(Csv, RowsHaveTheColumnsOfTheHeader) {
  Scene scene = test::sceneOf(test::oneStick(), Vec3(0, 0, 2));
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].pose.position = Vec3(0, 0.25, 3);
  test::World world(scene);
  world.state.step = 7;
  std::ostringstream header, row;
  writeCsvHeader(world.model, header);
  writeCsvRow(world.model, world.state, 0.5, row);
  EXPECT_EQ(header.str(),
            "step,time,a.x,a.y,a.z,b.x,b.y,b.z,"
            "other/a.x,other/a.y,other/a.z,other/b.x,other/b.y,other/b.z\n");
  EXPECT_EQ(row.str(), "7,0.5,0,0,2,1,0,2,0,0.25,3,1,0.25,3\n");
}

}  // namespace
}  // namespace ragdoll
