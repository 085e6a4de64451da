// A body, or bodies, at the beginning of a motion through events, so that single stages of it can
// be called.
#pragma once

#include "core/direct/mode_constants.h"
#include "core/direct/mode_list.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_rows.h"
#include "support/direct_island.h"
#include "support/gravity.h"

namespace ragdoll::test {

constexpr double kModeRadius = 0.1;  ///< [m]

inline Scene modeScene(SkeletonSpec skeleton, const Vec3& position, const ObstacleSpec& obstacle) {
  Scene scene = sceneOf(std::move(skeleton), position);
  scene.gravity = Vec3(0, 0, -kG);
  scene.obstacles = {obstacle};
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = 1.0 / 120;
  return scene;
}

/// A plane through the origin that rises along x, its normal, and the direction up along it.
struct Slope {
  double angle;

  Vec3 normal() const { return {-std::sin(angle), 0, std::cos(angle)}; }
  Vec3 up() const { return {std::cos(angle), 0, std::sin(angle)}; }
  ObstacleSpec plane(double friction) const {
    ObstacleSpec plane = floorPlane(friction);
    plane.normal = normal();
    return plane;
  }
  /// A block of 2 kg on it, pushed up along it.
  Scene block(double friction, double speed) const {
    Scene scene = modeScene(oneParticle(2, kRadius), kRadius * normal(), plane(friction));
    scene.ragdolls[0].velocity = speed * up();
    return scene;
  }
  static constexpr double kRadius = 0.1;
};

/// Two balls of 1 kg on a rod of 1 m whose end a touches a floor at the origin. The other end is
/// `tilt` above the floor, towards x, and turns about a at `rate`.
inline Scene rodOnEnd(double friction, double tilt, double rate) {
  Scene scene = modeScene(oneStick(), Vec3::Zero(), floorPlane(friction));
  RagdollSpec& rod = scene.ragdolls[0];
  rod.pose.orientation = Quat(Eigen::AngleAxisd(-tilt, Vec3::UnitY()));
  rod.angular_velocity = Vec3(0, -rate, 0);
  rod.velocity = 0.5 * rate * Vec3(-std::sin(tilt), 0, std::cos(tilt));
  return scene;
}

struct ModeBody : DirectIsland {
  bool listed;  ///< what startMode says

  explicit ModeBody(const Scene& scene) : DirectIsland(scene) {
    listed = startMode(island, reachOf(island, h));
  }
  /// All particles move so. A scene's own velocities do not lead into what they touch.
  ModeBody(const Scene& scene, const Vec3& velocity) : ModeBody(scene) {
    for (int i = 0; i < body().n; ++i) now().v.segment<3>(3 * i) = velocity;
  }

  Mode& mode() { return island.s.mode; }
  ModePoint& now() { return mode().start; }
  ModeRow& row(int i) { return mode().rows[i]; }
  /// What touches is closed.
  void close() {
    for (ModeRow& row : mode().rows) row.closed = row.gap_start < kClosedGap;
  }
  /// The mode in which what touches is closed.
  bool start() {
    close();
    return findMode(island, now());
  }
  /// Of a particle, from a point's x, v or a.
  static Vec3 of(const RowValues& values, int particle) { return values.segment<3>(3 * particle); }
};

}  // namespace ragdoll::test
