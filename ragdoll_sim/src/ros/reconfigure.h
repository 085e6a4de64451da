// dynamic_reconfigure: the settings of the solver, gravity, pace and what is drawn, while the
// simulation runs.
#pragma once

#include <dynamic_reconfigure/server.h>
#include <ros/node_handle.h>

#include <memory>

#include "publisher.h"
#include "ragdoll_sim/world/simulation.h"
#include "settings.h"

namespace ragdoll {

/// As it was asked for: the server would move what is out of range into it without a word.
struct AskedConfig : SolverConfig {
  AskedConfig() = default;
  AskedConfig(const SolverConfig& config) : SolverConfig(config) {}
  void __clamp__() {}
};

class Reconfigure {
 public:
  Reconfigure(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher,
              const Parameters& parameters, const GivenSettings& given);

  /// Shows the present settings to whoever looks: after another scene or state.
  void refresh();

 private:
  void changed(SolverConfig& config);

  Simulation& simulation_;
  Publisher& publisher_;
  const GivenSettings& given_;
  boost::recursive_mutex mutex_;
  SolverConfig present_;
  std::unique_ptr<dynamic_reconfigure::Server<AskedConfig>> server_;
};

}  // namespace ragdoll
