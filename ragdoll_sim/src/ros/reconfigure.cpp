#include "ragdoll_sim/ros/reconfigure.h"

#include <ros/master.h>

#include <cmath>

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
  c.sleep = solver.sleep;
  c.gravity_x = gravity.x();
  c.gravity_y = gravity.y();
  c.gravity_z = gravity.z();
  c.realtime_factor = realtime_factor;
  c.show_limits = show_limits;
  return c;
}

/// The knobs of `config` on top of `solver`, which may have others.
SolverSpec fromConfig(const SolverConfig& config, SolverSpec solver) {
  solver.preset = config.preset;
  solver.method = static_cast<Method>(config.method);
  solver.integrator = static_cast<Integrator>(config.integrator);
  solver.step = config.step;
  solver.sweeps = config.sweeps;
  solver.tolerance = config.tolerance;
  solver.damping = config.damping;
  solver.sleep = config.sleep;
  return solver;
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
  const auto model = simulation_.call([](World& world) { return world.model(); });
  boost::recursive_mutex::scoped_lock lock(mutex_);
  present_ =
      toConfig(model->solver, model->gravity, simulation_.realtimeFactor(), present_.show_limits);
  // Without a master the server would wait for one.
  if (server_ && ros::master::check()) server_->updateConfig(present_);
}

void Reconfigure::changed(SolverConfig& config) {
  try {
    const bool paced = config.realtime_factor > 0 && std::isfinite(config.realtime_factor);
    if (!paced && config.realtime_factor != -1)
      throw Error("realtime_factor", "is " + numberText(config.realtime_factor) +
                                         "; it must be > 0, or -1 to run free");
    const auto scene = simulation_.call([](World& world) { return world.scene(); });
    Scene next = *scene;
    if (config.preset != present_.preset) {  // a preset sets all knobs that are shown
      next.solver = preset(config.preset);
      next.solver.joint_damping = scene->solver.joint_damping;
    } else {
      next.solver = fromConfig(config, scene->solver);
    }
    next.gravity = Vec3(config.gravity_x, config.gravity_y, config.gravity_z);
    next.text = toYaml(next);
    if (next.text != scene->text) {
      auto model = std::make_shared<Model>(buildModel(next));
      auto shared = std::make_shared<Scene>(std::move(next));
      simulation_.jump([&](World& world) { world.configure(shared, model); });
    }
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
