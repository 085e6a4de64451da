// ragdoll_msgs/Model of any version: bags outlive the fields of a message.
#pragma once

#include <ragdoll_msgs/Model.h>
#include <ros/message_traits.h>
#include <ros/node_handle.h>
#include <ros/serialization.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace ragdoll {

/// As it was recorded; arrives whatever its version. The version is its sender's md5sum.
struct AnyModel {
  std::vector<std::uint8_t> bytes;
};

/// What that version did not have is 0. Throws Error for a version that is not known.
ragdoll_msgs::Model toModel(const AnyModel& message, const std::string& md5sum);

/// hear(model) for every one on the topic, whatever its version; one that is not known is logged.
/// All of a program's subscribers to a topic have to be such: roscpp has one connection for them
/// all, and one of a fixed version makes it refuse the others.
ros::Subscriber subscribeToModels(ros::NodeHandle& nh, const std::string& topic,
                                  const std::function<void(const ragdoll_msgs::Model&)>& hear);

}  // namespace ragdoll

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<ragdoll::AnyModel> {
  static const char* value() { return "*"; }
  static const char* value(const ragdoll::AnyModel&) { return value(); }
};
template <>
struct DataType<ragdoll::AnyModel> {
  static const char* value() { return "ragdoll_msgs/Model"; }
  static const char* value(const ragdoll::AnyModel&) { return value(); }
};
template <>
struct Definition<ragdoll::AnyModel> {
  static const char* value() { return ""; }
  static const char* value(const ragdoll::AnyModel&) { return value(); }
};

}  // namespace message_traits
namespace serialization {

template <>
struct Serializer<ragdoll::AnyModel> {
  template <class Stream>
  static void read(Stream& stream, ragdoll::AnyModel& message) {
    message.bytes.resize(stream.getLength());
    if (!message.bytes.empty())
      std::memcpy(message.bytes.data(), stream.getData(), message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros
