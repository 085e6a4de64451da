// ~handles: interactive markers on the bodies' main particles, to drag them with the mouse.
//
// While a handle is held, its particle is pulled to where the handle is (core/pull.h); when it is
// let go, or when nothing more is heard of whoever held it, the pull ends.
#pragma once

#include <interactive_markers/interactive_marker_server.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "frame_lookup.h"
#include "ragdoll_sim/world/simulation.h"

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
  ~Handles();

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  void feedback(const Feedback& message);
  bool isPulled(const std::string& name);
  void hold(const Feedback& message);
  void run();
  void endSilentGrips();
  void follow();
  void rebuild(const Model& model, const Points& x);

  Simulation& simulation_;
  const FrameLookup& frames_;
  ros::Publisher listeners_;  ///< of the server's topic, to count who listens
  interactive_markers::InteractiveMarkerServer server_;
  std::shared_ptr<const Scene> scene_;
  std::vector<Handle> handles_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Simulation::Clock::time_point> grips_;  ///< held handles: last heard of
  std::set<std::string> touched_;  ///< handles that were moved since follow() looked
  bool stopping_ = false;
  std::thread thread_;  // last
};

}  // namespace ragdoll
