// ~handles: interactive markers on the bodies' main particles, to drag them with the mouse.
//
// While a handle is held, its particle is pulled to where the handle is (core/pull.h); when it is
// let go, or when nothing more is heard of whoever held it, the pull ends.
#pragma once

#include <interactive_markers/interactive_marker_server.h>
#include <ros/node_handle.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "frame_lookup.h"
#include "ragdoll_sim/world/simulation.h"
#include "topic.h"

namespace ragdoll {

struct Handle {
  std::string name;           ///< "ragdoll/left_hand"
  int particle = 0;           ///< of the state
  double radius = 0;          ///< [m]
  std::optional<Vec3> shown;  ///< [m] where listeners were told that it is

  bool operator==(const Handle& o) const {
    return name == o.name && particle == o.particle && radius == o.radius;
  }
};

class Handles {
 public:
  Handles(ros::NodeHandle& nh, Simulation& simulation, const FrameLookup& frames);

  /// When update() is to be called; it may be earlier.
  Simulation::Clock::time_point due() const { return due_; }
  /// Tells listeners where the handles are, and lets go what nobody holds any more. Of one thread.
  /// Throws Error when the simulation has ended.
  void update();
  /// Tells where the handles are, and which there are, if nobody listens, too: who listens later to
  /// ~handles/update_full alone hears the last. As update().
  void follow();

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  void feedback(const Feedback& message);
  bool isPulled(const std::string& name);
  void hold(const Feedback& message);
  void endSilentGrips();
  void rebuild(const Model& model, const Points& x);

  Simulation& simulation_;
  const FrameLookup& frames_;
  Topic changes_, all_;  ///< the server's, to know whether anyone listens
  interactive_markers::InteractiveMarkerServer server_;
  std::shared_ptr<const Scene> scene_;
  std::vector<Handle> handles_;
  Simulation::Clock::time_point due_;

  std::mutex mutex_;
  std::map<std::string, Simulation::Clock::time_point> grips_;  ///< held handles: last heard of
  std::set<std::string> touched_;  ///< handles that were moved since follow() looked
};

}  // namespace ragdoll
