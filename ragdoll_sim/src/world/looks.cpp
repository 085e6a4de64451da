#include "ragdoll_sim/world/looks.h"

#include <algorithm>
#include <array>

namespace ragdoll {
namespace {

constexpr int kTiles = 30;            ///< floor tiles along each side
constexpr double kTile = 1;           ///< [m]
constexpr double kFadeBegin = 4;      ///< [m] from the middle, the floor starts to fade
constexpr double kFadeEnd = 14;       ///< [m] and is the background here
constexpr double kFloorDrop = 0.002;  ///< [m] drawn this much lower: bodies lie on it, not in it
constexpr Rgba kBackground{0.910f, 0.922f, 0.937f, 1};  ///< of rviz/ragdoll.rviz
constexpr Rgba kLight{0.835f, 0.850f, 0.870f, 1};
constexpr Rgba kDark{0.770f, 0.790f, 0.815f, 1};
constexpr std::array<Rgba, 2> kTints{{{0.60f, 0.69f, 0.77f, 1}, {0.54f, 0.63f, 0.71f, 1}}};

Rgba mixed(const Rgba& a, const Rgba& b, double share) {
  const float s = static_cast<float>(share);
  return {a.r + s * (b.r - a.r), a.g + s * (b.g - a.g), a.b + s * (b.b - a.b), 1};
}

Rgba faded(const Rgba& color, double distance) {
  const double s = std::clamp((distance - kFadeBegin) / (kFadeEnd - kFadeBegin), 0.0, 1.0);
  return mixed(color, kBackground, s * s * (3 - 2 * s));
}

/// Tiles in the plane's frame: z is its normal.
Mesh checker() {
  Mesh mesh;
  mesh.vertices.resize(3, 4 * kTiles * kTiles);
  int v = 0;
  for (int i = -kTiles / 2; i < kTiles / 2; ++i) {
    for (int j = -kTiles / 2; j < kTiles / 2; ++j) {
      for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        const Vec3 corner(kTile * (i + di), kTile * (j + dj), -kFloorDrop);
        mesh.colors.push_back(faded((i + j) % 2 == 0 ? kLight : kDark, corner.norm()));
        mesh.vertices.col(v++) = corner;
      }
      mesh.triangles.push_back({v - 4, v - 3, v - 2});
      mesh.triangles.push_back({v - 4, v - 2, v - 1});
    }
  }
  return mesh;
}

Mesh solid(const Obstacle& o) {
  switch (o.type) {
    case ObstacleSpec::Type::kSphere:
      return ellipsoid(Vec3::Constant(o.radius), 36, 18);
    case ObstacleSpec::Type::kCapsule:
      return roundCone(Vec3(0, 0, -o.half.z()), o.radius, Vec3(0, 0, o.half.z()), o.radius, 32, 8);
    default:
      return box(2 * o.half);
  }
}

}  // namespace

CoatShape obstacleLook(const Obstacle& obstacle, int index) {
  CoatShape shape;
  shape.type = CoatShape::Type::kMesh;
  if (obstacle.type == ObstacleSpec::Type::kPlane) {
    shape.mesh = checker();
    return shape;
  }
  shape.mesh = solid(obstacle);
  if (shape.mesh.normals.cols() == 0) computeNormals(shape.mesh);
  const Rgba& tint = kTints[index % kTints.size()];
  for (Eigen::Index i = 0; i < shape.mesh.normals.cols(); ++i)
    shape.mesh.colors.push_back(shade(tint, obstacle.pose.orientation * shape.mesh.normals.col(i)));
  return shape;
}

}  // namespace ragdoll
