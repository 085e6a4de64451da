#include "ragdoll_sim/world/looks.h"

#include <algorithm>
#include <array>

namespace ragdoll {
namespace {

constexpr int kTiles = 30;            ///< floor tiles along each side
constexpr double kTile = 1;           ///< [m] or twice, four times ... as much where bodies lie far apart
constexpr double kFadeBegin = 4;      ///< [m] from the middle, the floor starts to fade
constexpr double kMargin = 1.5;        ///< [m] of floor beyond the outermost body before that
constexpr double kFade = 10;          ///< [m] after so much more it is the background
constexpr double kFloorDrop = 0.002;  ///< [m] drawn this much lower: bodies lie on it, not in it
constexpr Rgba kBackground{0.910f, 0.922f, 0.937f, 1};  ///< of rviz/ragdoll.rviz
constexpr Rgba kLight{0.835f, 0.850f, 0.870f, 1};
constexpr Rgba kDark{0.770f, 0.790f, 0.815f, 1};
constexpr std::array<Rgba, 2> kTints{{{0.60f, 0.69f, 0.77f, 1}, {0.54f, 0.63f, 0.71f, 1}}};

Rgba mixed(const Rgba& a, const Rgba& b, double share) {
  const float s = static_cast<float>(share);
  return {a.r + s * (b.r - a.r), a.g + s * (b.g - a.g), a.b + s * (b.b - a.b), 1};
}

/// What of an endless plane is drawn.
struct Floor {
  Vec3 middle = Vec3::Zero();  ///< in the plane's frame, on it [m]
  double fade = kFadeBegin;    ///< [m] from the middle, it starts to fade
  double tile = kTile;         ///< [m]
};

/// About the plane's origin, or, where bodies start farther out than that shows, about them all.
Floor floorUnder(const Model& model, const Pose& plane) {
  Floor floor;
  Eigen::Array2d low = Eigen::Array2d::Constant(1e300), high = -low;
  double farthest = 0;
  for (const Ragdoll& r : model.ragdolls) {
    const Vec3 at =
        plane.orientation.conjugate() * (model.start_position.col(r.first) - plane.position);
    low = low.min(at.head<2>().array());
    high = high.max(at.head<2>().array());
    farthest = std::max(farthest, at.head<2>().norm());
  }
  if (farthest <= kFadeBegin) return floor;
  floor.fade = std::max(kFadeBegin, (high - low).matrix().norm() / 2 + kMargin);
  while (floor.tile * kTiles / 2 < floor.fade + kFade) floor.tile *= 2;
  const double whole = 2 * floor.tile;  // the pattern repeats
  floor.middle.head<2>() = whole * ((low + high) / 2 / whole).round();
  return floor;
}

Rgba faded(const Rgba& color, double beyond) {
  const double s = std::clamp(beyond / kFade, 0.0, 1.0);
  return mixed(color, kBackground, s * s * (3 - 2 * s));
}

/// Tiles in the plane's frame: z is its normal.
Mesh checker(const Floor& floor) {
  Mesh mesh;
  mesh.vertices.resize(3, 4 * kTiles * kTiles);
  int v = 0;
  for (int i = -kTiles / 2; i < kTiles / 2; ++i) {
    for (int j = -kTiles / 2; j < kTiles / 2; ++j) {
      for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        const Vec3 corner(floor.tile * (i + di), floor.tile * (j + dj), -kFloorDrop);
        const Rgba& color = (i + j) % 2 == 0 ? kLight : kDark;
        mesh.colors.push_back(faded(color, corner.norm() - floor.fade));
        mesh.vertices.col(v++) = floor.middle + corner;
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

CoatShape obstacleLook(const Model& model, int index) {
  const Obstacle& obstacle = model.obstacles[static_cast<std::size_t>(index)];
  CoatShape shape;
  shape.type = CoatShape::Type::kMesh;
  if (obstacle.type == ObstacleSpec::Type::kPlane) {
    shape.mesh = checker(floorUnder(model, obstacle.pose));
    return shape;
  }
  shape.mesh = solid(obstacle);
  if (shape.mesh.normals.cols() == 0) computeNormals(shape.mesh);
  const Rgba& tint = kTints[static_cast<std::size_t>(index) % kTints.size()];
  for (Eigen::Index i = 0; i < shape.mesh.normals.cols(); ++i)
    shape.mesh.colors.push_back(shade(tint, obstacle.pose.orientation * shape.mesh.normals.col(i)));
  return shape;
}

}  // namespace ragdoll
