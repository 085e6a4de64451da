// Small scenes built by hand for tests: one particle, one stick, n ragdolls of the same model.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll::test {

inline ParticleSpec particle(const std::string& name, const Vec3& position, double mass = 1,
                             double radius = 0) {
  ParticleSpec p;
  p.name = name;
  p.position = position;
  p.mass = mass;
  p.radius = radius;
  p.where = "particles." + name;
  return p;
}

inline StickSpec stick(const std::string& a, const std::string& b) {
  StickSpec s;
  s.a = a;
  s.b = b;
  s.where = "sticks " + a + "-" + b;
  return s;
}

inline SegmentSpec bone(const std::string& name, const std::string& from, const std::string& to) {
  SegmentSpec s;
  s.name = name;
  s.particles = {from, to};
  s.where = "segments." + name;
  return s;
}

inline ObstacleSpec floorPlane(double friction = 0, double restitution = 0) {
  ObstacleSpec o;
  o.type = ObstacleSpec::Type::kPlane;
  o.friction = friction;
  o.restitution = restitution;
  return o;
}

/// Holds the particle where it starts.
inline PinSpec pinOf(const std::string& particle) {
  PinSpec pin;
  pin.particle = particle;
  return pin;
}

/// One ragdoll named "ragdoll" with its model's origin at `position`.
inline Scene sceneOf(SkeletonSpec skeleton, const Vec3& position = Vec3::Zero()) {
  Scene scene;
  RagdollSpec r;
  r.skeleton = std::make_shared<const SkeletonSpec>(std::move(skeleton));
  r.pose.position = position;
  scene.ragdolls.push_back(r);
  return scene;
}

/// Without gravity.
inline Scene weightless(SkeletonSpec skeleton, const Vec3& velocity = Vec3::Zero()) {
  Scene scene = sceneOf(std::move(skeleton));
  scene.gravity.setZero();
  scene.ragdolls[0].velocity = velocity;
  return scene;
}

inline SkeletonSpec oneParticle(double mass = 1, double radius = 0) {
  SkeletonSpec s;
  s.name = "particle";
  s.particles = {particle("p", Vec3::Zero(), mass, radius)};
  return s;
}

/// Two particles 1 m apart along x.
inline SkeletonSpec oneStick(double mass_a = 1, double mass_b = 1, double radius = 0) {
  SkeletonSpec s;
  s.name = "stick";
  s.particles = {particle("a", Vec3::Zero(), mass_a, radius),
                 particle("b", Vec3::UnitX(), mass_b, radius)};
  s.sticks = {stick("a", "b")};
  s.segments = {bone("ab", "a", "b")};
  return s;
}

/// Lets all joints of the first body turn freely.
inline void removeJoints(Scene& scene) {
  SkeletonSpec skeleton = *scene.ragdolls[0].skeleton;
  skeleton.joints.clear();
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(std::move(skeleton));
}

/// A scene that runs: model, state, scripted inputs, scratch.
struct World {
  Model model;
  State state;
  Inputs inputs;
  Workspace workspace;

  explicit World(const Scene& scene)
      : model(buildModel(scene)), state(startState(model)), inputs(startInputs(model)) {}

  StepReport steps(int n) {
    StepReport last;
    for (int i = 0; i < n; ++i) last = step(model, inputs, workspace, state);
    return last;
  }
  Vec3 x(int i) const { return state.x.col(i); }
  Vec3 v(int i) const { return state.v.col(i); }
};

}  // namespace ragdoll::test
