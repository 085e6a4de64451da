// What of a floor is drawn: wherever bodies start it is there, and no larger mesh than for one.
#include "ragdoll_sim/world/looks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace {

using ragdoll::Mesh;
using ragdoll::Model;
using ragdoll::Rgba;
using ragdoll::Vec3;

constexpr float kBackground = 0.910f;  ///< red of rviz/*.rviz
constexpr float kLightest = 0.835f;    ///< red of the floor's lighter tiles

Model crowd(int count, double spacing, const std::string& plane = "") {
  return ragdoll::buildModel(ragdoll::parseScene(
      "ragdolls:\n  - {name: p, model: {particles: {p: {position: [0, 0, 0], mass: 1}}}, count: " +
          std::to_string(count) + ", spacing: [" + std::to_string(spacing) + ", " +
          std::to_string(spacing) + ", 0], position: [0, 0, 1]}\nobstacles: [{type: plane" + plane +
          "}]\n",
      "scene"));
}

/// The reddest colour of the tile below a point of the plane; the background where there is none.
float redAt(const Mesh& floor, double x, double y) {
  for (std::size_t t = 0; t < floor.triangles.size(); t += 2) {
    const int first = floor.triangles[t][0];
    const Vec3 low = floor.vertices.col(first), high = floor.vertices.col(first + 2);
    if (x < low.x() || x > high.x() || y < low.y() || y > high.y()) continue;
    float red = 0;
    for (int i = first; i < first + 4; ++i)
      red = std::max(red, floor.colors[static_cast<std::size_t>(i)].r);
    return red;
  }
  return kBackground;
}

TEST(Floor, isAsItWasUnderOneBody) {
  const Mesh floor = ragdoll::obstacleLook(crowd(1, 1), 0).mesh;
  EXPECT_EQ(floor.vertices.row(0).minCoeff(), -15);
  EXPECT_EQ(floor.vertices.row(1).maxCoeff(), 15);
  EXPECT_EQ(floor.triangles.size(), 2u * 30 * 30);
  EXPECT_FLOAT_EQ(redAt(floor, 0.5, 0.5), kLightest);
  EXPECT_FLOAT_EQ(redAt(floor, 14.5, 14.5), kBackground);
}

TEST(Floor, isUnderAllBodies) {
  for (const int count : {20, 200, 1000}) {
    const Model model = crowd(count, 1.6);
    const Mesh floor = ragdoll::obstacleLook(model, 0).mesh;
    EXPECT_EQ(floor.triangles.size(), 2u * 30 * 30);
    for (const ragdoll::Ragdoll& r : model.ragdolls) {
      const Vec3 at = model.start_position.col(r.first);
      EXPECT_LT(redAt(floor, at.x(), at.y()), (kLightest + kBackground) / 2) << at.transpose();
    }
    // Nobody sees where it ends.
    for (Eigen::Index i = 0; i < floor.vertices.cols(); ++i) {
      const Eigen::Array2d from_low = floor.vertices.col(i).head<2>().array() -
                                      floor.vertices.topRows<2>().rowwise().minCoeff().array();
      if (from_low.minCoeff() == 0) {
        EXPECT_FLOAT_EQ(floor.colors[static_cast<std::size_t>(i)].r, kBackground);
      }
    }
  }
}

TEST(Floor, keepsItsPattern) {
  const Mesh one = ragdoll::obstacleLook(crowd(1, 1), 0).mesh;
  const Mesh many = ragdoll::obstacleLook(crowd(9, 2.2), 0).mesh;  // about (2, 2)
  EXPECT_FLOAT_EQ(redAt(one, 0.5, 0.5), redAt(many, 0.5, 0.5));
  EXPECT_FLOAT_EQ(redAt(one, 1.5, 0.5), redAt(many, 1.5, 0.5));
}

}  // namespace
