// What rviz shows: the coat, the sticks, obstacles, the pokes and pulls that act, and the joints'
// limits and the contacts while they are asked for; ~scenery is ~markers without the bodies (coat
// and sticks), for who draws those itself. Fixed namespaces and ids, so that each message
// overwrites the last. What stays as it is, rigid parts and obstacles, is told once to a new
// listener and when it changes, and has no lifetime; once a minute it is told anew, as a full queue
// or a reset of rviz may have lost it. What is told again and again has a short lifetime.
#pragma once

#include <ros/publisher.h>
#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "body_markers.h"
#include "contact_markers.h"
#include "ragdoll_sim/world/simulation.h"
#include "topic.h"

namespace ragdoll {

class MarkerPublisher {
 public:
  /// coat: overrides the scene's unless empty.
  MarkerPublisher(ros::NodeHandle& nh, const std::string& world_frame, const std::string& coat);

  bool wanted() const { return markers_.isHeard() || scenery_.isHeard(); }

  /// Joint limits from the next message on, or no more (body/limit_shapes.h). Of any thread.
  void showLimits(bool show) { limits_ = show; }

  /// Contacts and their forces likewise (contact_markers.h), from the snapshots' reports.
  void showContacts(bool show) { contacts_ = show; }
  /// Whether the world has to keep its contacts for this.
  bool wantsContacts() const { return contacts_ && wanted(); }

  /// Another coat from the next message on; empty: the scene's. Of any thread.
  void setCoat(const std::string& coat);

  /// Does nothing while nobody listens, and more often than kRate.
  void publish(const Snapshot& world, const Posture& posture,
               Simulation::Clock::time_point now = Simulation::Clock::now());

  /// With the next message, what is told once, too. Of any thread.
  void tellAll() { newcomer_ = true; }

  /// Whether all frames of all bodies are on TF: then it moves their rigid parts.
  void useFrames(bool frames) { frames_ = frames; }

  /// Takes all markers away.
  void clear();

  /// How often messages were computed.
  std::size_t drawn() const { return drawn_; }

 private:
  void startScene(const Snapshot& world);
  void makeBodies(const Snapshot& world);
  void addBodies(const Snapshot& world, const Posture& posture, Simulation::Clock::time_point now,
                 bool all);
  void send();
  void addScenery(const Snapshot& world, const Posture& posture, bool slow);
  visualization_msgs::Marker marker(const std::string& ns, int id, double lifetime) const;
  void addSticks(const Snapshot& world, const Posture& posture);
  void addObstacles(const Snapshot& world, bool all);
  void addPokes(const Snapshot& world, const Posture& posture);
  void addPulls(const Snapshot& world, const Posture& posture);
  void addPins(const Snapshot& world, const Posture& posture);
  void addLimits(const Snapshot& world, const Posture& posture);
  void addContacts();

  std::string world_frame_;
  std::mutex coat_mutex_;
  std::string coat_;
  std::atomic<bool> other_coat_{false};
  std::atomic<bool> newcomer_{true}, limits_{false}, contacts_{false};
  Topic markers_, scenery_;
  std::shared_ptr<const Scene> scene_;
  CoatKind kind_ = CoatKind::kNone;
  std::vector<BodyMarkers> bodies_;
  std::size_t next_body_ = 0;  ///< that the next message begins with
  bool divided_ = false;       ///< the last picture was of several messages
  bool frames_ = true;
  std::vector<visualization_msgs::Marker> obstacles_;
  std::vector<Poke> pokes_;  ///< that acted since the last message
  ContactMarkers contact_markers_;
  std::uint32_t contacts_run_ = 0;  ///< that those are of
  std::vector<Pose> shown_obstacles_;
  Simulation::Clock::time_point next_, next_sticks_, next_obstacles_;
  ros::Time time_;                                         ///< of the last message
  std::optional<Simulation::Clock::time_point> reset_by_;  ///< rviz
  visualization_msgs::MarkerArray message_;                ///< ~scenery, then ~markers
  std::size_t drawn_ = 0;
};

}  // namespace ragdoll
