#include "ragdoll_sim/ros/any_model.h"

#include <ros/console.h>

#include <exception>

#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

/// Without RagdollModel.mass; its masses were the diagonal of the mass matrix.
constexpr const char* kWithoutMass = "90718b455b603a4402841136096aae23";

ragdoll_msgs::Model withoutMass(ros::serialization::IStream stream) {
  ragdoll_msgs::Model m;
  std::uint32_t ragdolls = 0;
  stream.next(m.header);
  stream.next(ragdolls);
  for (std::uint32_t i = 0; i < ragdolls; ++i) {
    ragdoll_msgs::RagdollModel r;
    stream.next(r.name);
    stream.next(r.particles);
    stream.next(r.masses);
    stream.next(r.sticks);
    stream.next(r.joints);
    m.ragdolls.push_back(std::move(r));
  }
  stream.next(m.scene_yaml);
  stream.next(m.scene);
  stream.next(m.run);
  stream.next(m.snapshot);
  return m;
}

}  // namespace

ragdoll_msgs::Model toModel(const AnyModel& message, const std::string& md5sum) {
  std::vector<std::uint8_t> bytes = message.bytes;
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  try {
    if (md5sum == kWithoutMass) return withoutMass(stream);
    if (md5sum == ros::message_traits::md5sum<ragdoll_msgs::Model>()) {
      ragdoll_msgs::Model model;
      stream.next(model);
      return model;
    }
  } catch (const std::exception& e) {
    throw Error("ragdoll_msgs/Model", std::string("is damaged: ") + e.what());
  }
  throw Error("ragdoll_msgs/Model",
              "was recorded with another version than this one knows: md5sum " + md5sum);
}

ros::Subscriber subscribeToModels(ros::NodeHandle& nh, const std::string& topic,
                                  const std::function<void(const ragdoll_msgs::Model&)>& hear) {
  using Event = ros::MessageEvent<AnyModel const>;
  const boost::function<void(const Event&)> hearAny = [hear](const Event& event) {
    try {
      hear(toModel(*event.getConstMessage(), event.getConnectionHeader()["md5sum"]));
    } catch (const Error& e) {
      ROS_WARN("%s", e.what());
    }
  };
  return nh.subscribe<AnyModel, const Event&>(topic, 1, hearAny);
}

}  // namespace ragdoll
