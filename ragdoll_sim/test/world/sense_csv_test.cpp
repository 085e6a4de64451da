#include "ragdoll_sim/world/sense_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "particles.h"
#include "ragdoll_sim/core/build_model.h"

namespace ragdoll {
namespace {

using test::floorPlane;
using test::particles;

std::size_t columns(const std::string& row) {
  return 1 + static_cast<std::size_t>(std::count(row.begin(), row.end(), ','));
}

TEST(SenseCsv, AnImuRowHasTheColumnsOfItsHeader) {
  Model model = buildModel(particles(1));
  model.sensors.emplace_back();
  model.sensors[0].name = "low_back";
  ImuSample sample;
  sample.step = 250;
  sample.acceleration = Vec3(0.1, 0, 9.81);
  std::ostringstream header, row;
  writeImuHeader(header);
  writeImuRow(model, sample, row);
  EXPECT_EQ(columns(header.str()), columns(row.str()));
  EXPECT_EQ(row.str(), "0.25,low_back,0.10000000000000001,0,9.8100000000000005,0,0,0,0,0,0,1\n");
}

TEST(SenseCsv, AContactRowHasMeansOverItsInterval) {
  Scene scene = particles(1);
  scene.obstacles.push_back(floorPlane());
  scene.obstacles[0].name = "floor";
  const Model model = buildModel(scene);
  ContactReport report;
  report.step = 500;
  report.interval = 0.5;
  Touch touch;
  touch.contact.obstacle = 0;
  touch.contact.particle = {0, -1};
  touch.contact.impulse = Vec3(0, 0, 5);
  touch.peak_force = 12;
  report.touches.push_back(touch);
  std::ostringstream header, rows;
  writeContactHeader(header);
  writeContactRows(model, report, rows);
  EXPECT_EQ(columns(header.str()), columns(rows.str()));
  EXPECT_NE(rows.str().find("0.5,ragdoll,p,floor,"), std::string::npos) << rows.str();
  EXPECT_NE(rows.str().find(",0,0,10,12,5,0\n"), std::string::npos) << rows.str();
}

}  // namespace
}  // namespace ragdoll
