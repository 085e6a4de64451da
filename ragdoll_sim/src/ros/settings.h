// The settings of dynamic_reconfigure: as a scene has them, and as parameters give them at the
// start. cfg/Solver.cfg is the only list of them.
#pragma once

#include <XmlRpcValue.h>
#include <ragdoll_sim/SolverConfig.h>
#include <ros/node_handle.h>

#include <map>
#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll {

using ragdoll_sim::SolverConfig;

std::vector<std::string> settingNames();

/// What is drawn (show_limits, show_contacts, coat) is as `drawn` has it.
SolverConfig toConfig(const SolverSpec& solver, const Vec3& gravity, double realtime_factor,
                      const SolverConfig& drawn);

/// Throws Error that names a setting that is not as `shown`, its value and its range, if it is out
/// of that.
void checkChanges(const SolverConfig& config, const SolverConfig& shown);

/// The settings of `config` that are not as `shown`, on top of `scene`. Another preset comes first
/// and sets all that are the solver's but joint_damping, which belongs to the body.
void applyChanges(const SolverConfig& config, const SolverConfig& shown, Scene& scene);

/// What someone has given on the parameter server under the names of the settings. A node writes
/// its present settings there, too, where the next one of its name finds them: a record elsewhere
/// on the server tells these apart.
class GivenSettings {
 public:
  explicit GivenSettings(const ros::NodeHandle& nh);

  bool has(const std::string& name) const { return given_.count(name) > 0; }
  /// As NodeHandle::getParam, of what was given.
  template <class T>
  bool get(const std::string& name, T& value) const;

  /// On top of a scene, and into its text: the preset first, then the others. Throws Error that
  /// names the parameter, its value and what would be right.
  void apply(Scene& scene) const;

  /// "step 0.01, gravity_z -1.62": those that are in place of a scene's; empty: none.
  std::string overriding() const;

  /// To be called whenever the node has written other settings.
  void record(const SolverConfig& written) const;
  /// Leaves the server as if the node had written nothing; what someone has set since stays.
  void restore() const;

 private:
  XmlRpc::XmlRpcValue recorded(const char* part) const;

  ros::NodeHandle nh_;
  std::map<std::string, XmlRpc::XmlRpcValue> given_;
};

}  // namespace ragdoll
