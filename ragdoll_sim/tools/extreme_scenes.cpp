#include "extreme_scenes.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

std::shared_ptr<SkeletonSpec> ownModel(RagdollSpec& ragdoll) {
  auto own = std::make_shared<SkeletonSpec>(*ragdoll.skeleton);
  ragdoll.skeleton = own;
  return own;
}

}  // namespace

std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

Scene humanScene(const std::string& start, const std::string& rest) {
  return parseScene("ragdolls: [{model: human, " + start + "}]\n" + rest, "extreme");
}

Scene chainScene(const std::vector<double>& masses, double link, double tilt) {
  Scene scene;
  auto model = std::make_shared<SkeletonSpec>();
  model->name = "chain";
  for (std::size_t i = 0; i < masses.size(); ++i) {
    ParticleSpec p;
    p.name = "p" + std::to_string(i);
    p.position = Vec3(0, 0, -link * static_cast<double>(i));
    p.mass = masses[i];
    model->particles.push_back(p);
    if (i == 0) continue;
    StickSpec s;
    s.a = model->particles[i - 1].name;
    s.b = p.name;
    model->sticks.push_back(s);
  }
  RagdollSpec ragdoll;
  ragdoll.skeleton = model;
  ragdoll.pose.orientation = Quat(Eigen::AngleAxisd(-tilt, Vec3::UnitY()));
  scene.ragdolls.push_back(ragdoll);
  PinSpec pin;
  pin.particle = "p0";
  scene.pins.push_back(pin);
  return scene;
}

Scene massRatioChain(double ratio, double tilt) {
  std::vector<double> masses(6, 1.0);
  masses.back() = ratio;
  return chainScene(masses, 0.3, tilt);
}

void scaleModel(Scene& scene, double length, double mass) {
  for (RagdollSpec& ragdoll : scene.ragdolls) {
    const auto model = ownModel(ragdoll);
    for (ParticleSpec& p : model->particles) {
      p.position *= length;
      p.radius *= length;
      p.mass *= mass;
    }
    for (StickSpec& s : model->sticks)
      if (s.length) *s.length *= length;
    for (SegmentSpec& s : model->segments) {
      s.mass *= mass;
      s.com_point *= length;
      s.inertia *= mass * length * length;
    }
  }
}

void flattenModel(Scene& scene) {
  for (RagdollSpec& ragdoll : scene.ragdolls) {
    const auto model = ownModel(ragdoll);
    for (ParticleSpec& p : model->particles) p.position.x() = 0;
  }
}

}  // namespace ragdoll::lab
