// The runs of ragdoll nodes in a bag: what ~model, ~pokes and ~followed say of each run, and its
// states in turn.
#pragma once

#include <ragdoll_msgs/FollowedFrame.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ragdoll_msgs/State.h>
#include <rosbag/bag.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace ragdoll::lab {

/// The topics of one node, found by their types; whatever the node was called.
struct NodeTopics {
  std::string name;                           ///< namespace of its topics: "/ragdoll"
  std::string model, state, pokes, followed;  ///< the last two: "" where there is none
};

class Recording {
 public:
  /// Throws Error: no bag, not readable, no node in it that could be replayed.
  explicit Recording(const std::string& path);

  const std::vector<NodeTopics>& nodes() const { return nodes_; }

  /// By number of the run. Throws Error.
  std::map<std::uint32_t, ragdoll_msgs::Model> models(const NodeTopics& node) const;
  std::map<std::uint32_t, std::vector<ragdoll_msgs::PokeEvent>> pokes(const NodeTopics& node) const;
  std::map<std::uint32_t, std::vector<ragdoll_msgs::FollowedFrame>> followed(
      const NodeTopics& node) const;
  void forEachState(const NodeTopics& node,
                    const std::function<void(const ragdoll_msgs::State&)>& visit) const;

 private:
  template <class Message, class Visit>
  void read(const std::string& topic, Visit visit) const;
  void findNodes();

  std::string path_;
  rosbag::Bag bag_;
  std::vector<NodeTopics> nodes_;
};

}  // namespace ragdoll::lab
