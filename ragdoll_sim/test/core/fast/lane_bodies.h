// Bodies of a scene, all of one model, as the packs have them: so that single stages can be called.
#pragma once

#include <cstdint>
#include <vector>

#include "core/fast/body_build.h"
#include "core/fast/lane_step.h"
#include "support/direct_island.h"

namespace ragdoll::test {

/// A pack of one double.
using OneLane = fast::LaneWork<double, 1>;

struct LaneBodies {
  struct One {
    Points x, v, x1, v1, predicted;
    std::vector<double> limits;  ///< [N m] impulses
    std::vector<fast::LaneImpulse> impulses;
  };

  Model model;
  fast::FastBody body;
  fast::PackStep step;
  std::vector<fast::StillPlane> planes;
  std::vector<One> bodies;
  std::vector<fast::Lane> lanes;
  std::vector<char> memory;

  /// Every lane holds the scene's first ragdoll; its planes are the obstacles.
  explicit LaneBodies(const Scene& scene, int count = 1)
      : model(buildModel(scene)),
        body(fast::buildBody(model, model.systems[0])),
        bodies(count),
        lanes(count) {
    const State state = startState(model);
    step.h = model.solver.step;
    for (int c = 0; c < 3; ++c) step.gravity[c] = model.gravity[c];
    for (const Obstacle& o : model.obstacles) addPlane(o);
    step.planes = planes.data();
    step.plane_count = static_cast<int>(planes.size());
    for (int l = 0; l < count; ++l) {
      One& one = bodies[l];
      one.x = one.x1 = one.v1 = one.predicted = state.x;
      one.v = state.v;
      one.limits.assign(body.limits.size() + 1, 0.0);
      one.impulses.resize(fast::impulseRoom(body, step.plane_count));
      bind(one, lanes[l]);
      lanes[l].h = step.h;
      lanes[l].bounds = step.bounds;
    }
  }

  /// A whole step.
  void take(const fast::PackMethod& method) {
    memory.assign(method.memory(body, step.plane_count) + 64, 0);
    method.predict(body, step, lanes.data(), memory.data());
    method.finish(body, step, lanes.data(), memory.data());
  }

  /// The first lane after its free motion, before there are rows.
  OneLane& predicted() {
    memory.assign(OneLane::room(body, step.plane_count) + 64, 0);
    fast::predict<OneLane>(body, step, lanes.data(), memory.data());
    const std::uintptr_t at = reinterpret_cast<std::uintptr_t>(memory.data());
    OneLane& w = *reinterpret_cast<OneLane*>((at + 63) & ~std::uintptr_t(63));
    w.z_next = w.z;
    return w;
  }
  /// The same with rows of contacts and limits, at coordinates zero, from where nothing moves it.
  OneLane& rows() {
    OneLane& w = predicted();
    w.recovery = 1;  // [m] more than there is to recover
    fast::setContacts(body, step, lanes.data(), w);
    fast::setLimits(body, w);
    w.unsettled = w.unsolved = true;
    for (int k = 0; k < body.tree.size; ++k) w.q[k] = w.y[k] = 0;
    fast::setPose(body, w);
    fast::measureContacts(body, w);
    return w;
  }

 private:
  void addPlane(const Obstacle& o) {
    fast::StillPlane plane;
    const Vec3 n = o.pose.orientation * Vec3::UnitZ();
    plane.obstacle = static_cast<int>(planes.size());
    for (int c = 0; c < 3; ++c) plane.normal[c] = n[c];
    plane.offset = n.dot(o.pose.position);
    plane.friction = o.friction;
    plane.restitution = o.restitution;
    planes.push_back(plane);
  }
  static void bind(One& one, fast::Lane& lane) {
    lane.x = one.x.data();
    lane.v = one.v.data();
    lane.x1 = one.x1.data();
    lane.v1 = one.v1.data();
    lane.tried_x = lane.x1;
    lane.tried_v = lane.v1;
    lane.limits_pressed = true;
    lane.predicted = one.predicted.data();
    lane.limit_impulse = one.limits.data();
    lane.impulses = one.impulses.data();
  }
};

/// Two balls of 1 kg on a rod of 1 m, tilted so that b is above a; a touches a floor.
inline Scene tiltedRod(double tilt, double friction = 0.5) {
  Scene scene = sceneOf(oneStick());
  scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(-tilt, Vec3::UnitY()));
  scene.obstacles = {floorPlane(friction)};
  return scene;
}

/// A ball of `mass` with its lowest point `gap` above a floor.
inline Scene ballOver(double gap, double mass, const Vec3& v, const ObstacleSpec& floor) {
  Scene scene = sceneOf(oneParticle(mass, 0.1), Vec3(0, 0, 0.1 + gap));
  scene.ragdolls[0].velocity = v;
  scene.obstacles = {floor};
  return scene;
}

}  // namespace ragdoll::test
