#include "reconfigure.h"

#include <ros/master.h>

#include <cmath>
#include <type_traits>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

SolverConfig toConfig(const SolverSpec& solver, const Vec3& gravity, double realtime_factor,
                      bool show_limits) {
  SolverConfig c = SolverConfig::__getDefault__();
  c.preset = solver.preset;
  c.method = static_cast<int>(solver.method);
  c.integrator = static_cast<int>(solver.integrator);
  c.step = solver.step;
  c.sweeps = solver.sweeps;
  c.tolerance = solver.tolerance;
  c.damping = solver.damping;
  c.joint_damping = solver.joint_damping;
  c.sleep = solver.sleep;
  c.gravity_x = gravity.x();
  c.gravity_y = gravity.y();
  c.gravity_z = gravity.z();
  c.realtime_factor = realtime_factor;
  c.show_limits = show_limits;
  return c;
}

/// The knobs of `config` that are not as `shown`, on top of `scene`.
void apply(const SolverConfig& config, const SolverConfig& shown, Scene& scene) {
  const auto set = [](const auto& to, const auto& from, auto& value) {
    if (to != from) value = static_cast<std::decay_t<decltype(value)>>(to);
  };
  SolverSpec& solver = scene.solver;
  if (config.preset != shown.preset) {  // sets all knobs but what belongs to the body
    const double joint_damping = solver.joint_damping;
    solver = preset(config.preset);
    solver.joint_damping = joint_damping;
  } else {
    set(config.method, shown.method, solver.method);
    set(config.integrator, shown.integrator, solver.integrator);
    set(config.step, shown.step, solver.step);
    set(config.sweeps, shown.sweeps, solver.sweeps);
    set(config.tolerance, shown.tolerance, solver.tolerance);
    set(config.damping, shown.damping, solver.damping);
    set(config.sleep, shown.sleep, solver.sleep);
  }
  set(config.joint_damping, shown.joint_damping, solver.joint_damping);
  set(config.gravity_x, shown.gravity_x, scene.gravity.x());
  set(config.gravity_y, shown.gravity_y, scene.gravity.y());
  set(config.gravity_z, shown.gravity_z, scene.gravity.z());
}

}  // namespace

Reconfigure::Reconfigure(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher,
                         bool show_limits)
    : simulation_(simulation), publisher_(publisher) {
  present_.show_limits = show_limits;
  refresh();
  server_ = std::make_unique<dynamic_reconfigure::Server<SolverConfig>>(mutex_, nh);
  server_->setConfigDefault(present_);
  server_->updateConfig(present_);
  server_->setCallback([this](SolverConfig& config, std::uint32_t) { changed(config); });
}

void Reconfigure::refresh() {
  boost::recursive_mutex::scoped_lock lock(mutex_);
  const auto model = simulation_.call([](World& world) { return world.model(); });
  present_ =
      toConfig(model->solver, model->gravity, simulation_.realtimeFactor(), present_.show_limits);
  // Without a master the server would wait for one.
  if (server_ && ros::master::check()) server_->updateConfig(present_);
}

void Reconfigure::changed(SolverConfig& config) {
  try {
    // What was not asked for comes as it was shown, within its range; the scene may have another by
    // now, or one out of range.
    SolverConfig shown = present_;
    shown.__clamp__();
    const bool paced = config.realtime_factor > 0 && std::isfinite(config.realtime_factor);
    if (!paced && config.realtime_factor != -1)
      throw Error("realtime_factor", "is " + numberText(config.realtime_factor) +
                                         "; it must be > 0, or -1 to run free");
    const auto scene = simulation_.call([](World& world) { return world.scene(); });
    Scene next = *scene;
    apply(config, shown, next);
    next.text = toYaml(next);
    if (next.text != scene->text) {
      auto model = std::make_shared<Model>(buildModel(next));
      auto shared = std::make_shared<Scene>(std::move(next));
      simulation_.jump([&](World& world) { world.configure(scene, shared, model); });
    }
    if (config.realtime_factor != shown.realtime_factor)
      simulation_.setRealtimeFactor(config.realtime_factor);
    publisher_.showLimits(config.show_limits);
    const auto model = simulation_.call([](World& world) { return world.model(); });
    config =
        toConfig(model->solver, model->gravity, simulation_.realtimeFactor(), config.show_limits);
    present_ = config;
  } catch (const Error& e) {
    ROS_WARN("settings refused: %s", e.what());
    config = present_;
  }
}

}  // namespace ragdoll
