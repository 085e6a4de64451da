#include "recording.h"

#include <rosbag/view.h>

#include <set>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/ros/any_model.h"

namespace ragdoll::lab {
namespace {

constexpr const char* kInput = "poke_replay";  ///< what a node listens to is not what it did

std::string parentOf(const std::string& topic) { return topic.substr(0, topic.rfind('/')); }

std::string baseOf(const std::string& topic) { return topic.substr(topic.rfind('/') + 1); }

using Topics = std::set<std::string>;

Topics topicsOf(rosbag::Bag& bag, const std::string& type) {
  Topics topics;
  rosbag::View view(bag, rosbag::TypeQuery(type));
  for (const rosbag::ConnectionInfo* connection : view.getConnections())
    if (baseOf(connection->topic) != kInput) topics.insert(connection->topic);
  return topics;
}

std::string inNamespace(const Topics& topics, const std::string& name) {
  for (const std::string& topic : topics)
    if (parentOf(topic) == name) return topic;
  return "";
}

}  // namespace

Recording::Recording(const std::string& path) : path_(path) {
  try {
    bag_.open(path, rosbag::bagmode::Read);
    findNodes();
  } catch (const rosbag::BagUnindexedException&) {
    throw Error(path, "is not indexed, its recording was cut off: rosbag reindex mends it");
  } catch (const rosbag::BagException& e) {
    throw Error(path, std::string("cannot be read as a bag: ") + e.what());
  }
}

void Recording::findNodes() {
  const Topics models = topicsOf(bag_, "ragdoll_msgs/Model");
  const Topics states = topicsOf(bag_, "ragdoll_msgs/State");
  const Topics pokes = topicsOf(bag_, "ragdoll_msgs/PokeEvent");
  const Topics followed = topicsOf(bag_, "ragdoll_msgs/FollowedFrame");
  const std::string right = "; record ~model, ~pokes and ~state of the node";
  if (models.empty()) throw Error(path_, "holds no ragdoll_msgs/Model" + right);
  if (states.empty()) throw Error(path_, "holds no ragdoll_msgs/State" + right);
  if (models.size() == 1 && states.size() == 1 && pokes.size() <= 1 && followed.size() <= 1) {
    nodes_.push_back({parentOf(*states.begin()), *models.begin(), *states.begin(),
                      pokes.empty() ? "" : *pokes.begin(),
                      followed.empty() ? "" : *followed.begin()});
    return;
  }
  for (const std::string& state : states) {
    NodeTopics node{parentOf(state), "", state, "", ""};
    node.model = inNamespace(models, node.name);
    node.pokes = inNamespace(pokes, node.name);
    node.followed = inNamespace(followed, node.name);
    if (node.model.empty())
      throw Error(path_, "holds no ragdoll_msgs/Model beside " + state + right);
    nodes_.push_back(node);
  }
}

template <class Message, class Visit>
void Recording::read(const std::string& topic, Visit visit) const {
  if (topic.empty()) return;
  rosbag::View view(bag_, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view) {
    typename Message::ConstPtr message;
    try {
      message = instance.instantiate<Message>();
    } catch (const std::exception& e) {
      throw Error(path_ + ": " + topic, std::string("is damaged: ") + e.what());
    }
    if (!message)
      throw Error(path_ + ": " + topic, "was recorded with another version of " +
                                            instance.getDataType() + " than this one knows");
    visit(*message);
  }
}

std::map<std::uint32_t, ragdoll_msgs::Model> Recording::models(const NodeTopics& node) const {
  std::map<std::uint32_t, ragdoll_msgs::Model> found;
  rosbag::View view(bag_, rosbag::TopicQuery(node.model));
  for (const rosbag::MessageInstance& instance : view) {
    boost::shared_ptr<AnyModel const> message;
    try {
      message = instance.instantiate<AnyModel>();
      const ragdoll_msgs::Model m = toModel(*message, instance.getMD5Sum());
      found[m.run] = m;
    } catch (const std::exception& e) {
      throw Error(path_ + ": " + node.model, e.what());
    }
  }
  return found;
}

std::map<std::uint32_t, std::vector<ragdoll_msgs::PokeEvent>> Recording::pokes(
    const NodeTopics& node) const {
  std::map<std::uint32_t, std::vector<ragdoll_msgs::PokeEvent>> found;
  read<ragdoll_msgs::PokeEvent>(
      node.pokes, [&](const ragdoll_msgs::PokeEvent& m) { found[m.run].push_back(m); });
  return found;
}

std::map<std::uint32_t, std::vector<ragdoll_msgs::FollowedFrame>> Recording::followed(
    const NodeTopics& node) const {
  std::map<std::uint32_t, std::vector<ragdoll_msgs::FollowedFrame>> found;
  read<ragdoll_msgs::FollowedFrame>(
      node.followed, [&](const ragdoll_msgs::FollowedFrame& m) { found[m.run].push_back(m); });
  return found;
}

void Recording::forEachState(const NodeTopics& node,
                             const std::function<void(const ragdoll_msgs::State&)>& visit) const {
  read<ragdoll_msgs::State>(node.state, visit);
}

}  // namespace ragdoll::lab
