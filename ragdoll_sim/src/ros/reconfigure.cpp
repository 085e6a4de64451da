#include "reconfigure.h"

#include <ros/master.h>

#include <cmath>

#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
Reconfigure::Reconfigure(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher,
                         const Parameters& parameters, const GivenSettings& given)
    : simulation_(simulation), publisher_(publisher), given_(given) {
  present_.show_limits = parameters.show_limits;
  present_.show_contacts = parameters.show_contacts;
  present_.coat = parameters.coat;
  refresh();
  server_ = std::make_unique<dynamic_reconfigure::Server<AskedConfig>>(mutex_, nh);
  server_->setConfigDefault(present_);
  server_->updateConfig(present_);
  given_.record(present_);
  server_->setCallback([this](SolverConfig& config, std::uint32_t) { changed(config); });
}

void Reconfigure::refresh() {
  boost::recursive_mutex::scoped_lock lock(mutex_);
  const auto model = simulation_.call([](World& world) { return world.model(); });
  present_ = toConfig(model->solver, model->gravity, simulation_.realtimeFactor(), present_);
  // Without a master the server would wait for one.
  if (!server_ || !ros::master::check()) return;
  server_->updateConfig(present_);
  given_.record(present_);
}

void Reconfigure::changed(SolverConfig& config) {
  try {
    checkChanges(config, present_);
    const bool paced = config.realtime_factor > 0 && std::isfinite(config.realtime_factor);
    if (!paced && config.realtime_factor != -1)
      throw Error("realtime_factor", "is " + numberText(config.realtime_factor) +
                                         "; it must be > 0, or -1 to run free");
    if (!config.coat.empty()) coatKind(config.coat);  // throws Error
    const auto scene = simulation_.call([](World& world) { return world.scene(); });
    const auto known = simulation_.call([](World& world) { return world.model()->warnings; });
    Scene next = *scene;
    applyChanges(config, present_, next);
    next.text = toYaml(next);
    if (next.text != scene->text) {
      auto model = std::make_shared<Model>(buildModel(next));
      for (const std::string& warning : model->warnings)
        if (indexOf(known, warning) < 0) ROS_WARN("%s", warning.c_str());
      auto shared = std::make_shared<Scene>(std::move(next));
      simulation_.jump([&](World& world) { world.configure(scene, shared, model); });
    }
    if (config.realtime_factor != present_.realtime_factor)
      simulation_.setRealtimeFactor(config.realtime_factor);
    publisher_.showLimits(config.show_limits);
    publisher_.showContacts(config.show_contacts);
    publisher_.setCoat(config.coat);
    const auto model = simulation_.call([](World& world) { return world.model(); });
    config = toConfig(model->solver, model->gravity, simulation_.realtimeFactor(), config);
    present_ = config;
  } catch (const Error& e) {
    ROS_WARN("settings refused: %s", e.what());
    config = present_;
  }
  given_.record(config);  // which the server writes next
}

}  // namespace ragdoll
