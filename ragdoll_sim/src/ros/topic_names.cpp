#include "topic_names.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace ragdoll {
namespace {

std::string topicName(std::string name) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '/'; };
  std::replace_if(
      name.begin(), name.end(), [&](char c) { return !fits(c); }, '_');
  return name;
}

}  // namespace

std::vector<std::string> topicNames(const std::vector<std::string>& names) {
  std::vector<std::string> topics;
  std::set<std::string> taken;
  for (const std::string& name : names) {
    const std::string wanted = topicName(name);
    std::string topic = wanted;
    for (int k = 2; !taken.insert(topic).second; ++k) topic = wanted + "_" + std::to_string(k);
    topics.push_back(topic);
  }
  return topics;
}

}  // namespace ragdoll
