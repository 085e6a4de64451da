#include "parameters.h"

#include <ros/package.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <vector>

#include "frame_lookup.h"
#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

std::string shown(double v) { return numberText(v); }
std::string shown(bool v) { return v ? "true" : "false"; }
std::string shown(const std::string& v) { return v.empty() ? "\"\"" : v; }

/// As tf2 and rviz take one: no spaces, no slash at an end or beside another.
bool isFrameName(const std::string& name) {
  const auto isSpace = [](unsigned char c) { return std::isspace(c) != 0; };
  return !name.empty() && name.front() != '/' && name.back() != '/' &&
         name.find("//") == std::string::npos && std::none_of(name.begin(), name.end(), isSpace);
}

class Reader {
 public:
  Reader(const ros::NodeHandle& nh, const GivenSettings& settings)
      : nh_(nh), settings_(settings), setting_names_(settingNames()) {}

  template <class T>
  void read(const std::string& key, const std::string& type, T& value) {
    known_.push_back(key);
    const bool setting = indexOf(setting_names_, key) >= 0;
    if (!(setting ? settings_.has(key) : nh_.hasParam(key))) return;
    if (setting ? settings_.get(key, value) : nh_.getParam(key, value)) return;
    throw Error("parameter " + nh_.resolveName(key),
                "must be " + type + ", by default " + shown(value) + ", is " + given(key));
  }

  void check(bool ok, const std::string& key, const std::string& right) const {
    if (!ok) throw Error("parameter " + nh_.resolveName(key), "is " + given(key) + "; " + right);
  }

  /// Warns of what stands in the node's namespace and is not a parameter.
  void warnOfOthers() const {
    std::vector<std::string> names;
    nh_.getParamNames(names);
    const std::string prefix = nh_.getNamespace() + "/";
    for (const std::string& name : names) {
      if (name.compare(0, prefix.size(), prefix) != 0) continue;
      const std::string key = name.substr(prefix.size());
      const std::string head = key.substr(0, key.find('/'));
      if (indexOf(known_, head) < 0 && indexOf(setting_names_, head) < 0)
        ROS_WARN("unknown parameter %s; there are %s; and the settings %s", name.c_str(),
                 joined(known_).c_str(), joined(setting_names_).c_str());
    }
  }

 private:
  std::string given(const std::string& key) const {
    XmlRpc::XmlRpcValue value;
    if (!settings_.get(key, value)) nh_.getParam(key, value);
    if (value.getType() == XmlRpc::XmlRpcValue::TypeDouble) return numberText(value);
    std::ostringstream out;
    value.write(out);
    return out.str();
  }

  const ros::NodeHandle& nh_;
  const GivenSettings& settings_;
  std::vector<std::string> setting_names_, known_;
};

}  // namespace

Parameters readParameters(const ros::NodeHandle& nh, const GivenSettings& given) {
  Parameters p;
  Reader in(nh, given);
  in.read("scene", "text", p.scene);
  in.read("world_frame", "text", p.world_frame);
  in.read("publish_rate", "a number", p.publish_rate);
  in.read("realtime_factor", "a number", p.realtime_factor);
  in.read("start_paused", "true or false", p.start_paused);
  in.read("publish_clock", "true or false", p.publish_clock);
  in.read("wrench_timeout", "a number", p.wrench_timeout);
  in.read("coat", "text", p.coat);
  in.read("show_limits", "true or false", p.show_limits);
  in.read("show_contacts", "true or false", p.show_contacts);
  in.read("max_frame_speed", "a number", p.max_frame_speed);
  in.read("frame_prefix", "text", p.frame_prefix);
  in.read("publish_every", "a number", p.publish_every);
  in.read("tf_bodies", "text", p.tf_bodies);

  in.check(!p.scene.empty(), "scene", "it must name a scene: stairs, a path or package://...");
  p.world_frame = FrameLookup::normal(p.world_frame);
  in.check(isFrameName(p.world_frame), "world_frame",
           "it must name a TF frame, without spaces, a slash at its end or two in a row");
  in.check(p.publish_rate >= 0.001 && p.publish_rate <= 1000, "publish_rate",
           "it must be in [0.001, 1000] Hz");
  in.check((p.realtime_factor > 0 && std::isfinite(p.realtime_factor)) || p.realtime_factor == -1,
           "realtime_factor", "it must be > 0, or -1 to run free");
  in.check(p.wrench_timeout > 0 && p.wrench_timeout <= 60, "wrench_timeout",
           "it must be in (0, 60] s");
  p.frame_prefix = FrameLookup::normal(p.frame_prefix);
  in.check(
      isFrameName(p.frame_prefix + "x"), "frame_prefix",
      "it must begin TF frames' names, such as robot1/, without spaces or two slashes in a row");
  in.check(p.publish_every >= 0 && p.publish_every <= 3600, "publish_every",
           "it must be in [0, 3600] s of simulated time; 0: ~publish_rate holds");
  in.check(indexOf({"", "all", "roots", "none"}, p.tf_bodies) >= 0, "tf_bodies",
           "it must be all, roots or none");
  in.check(p.max_frame_speed > 0, "max_frame_speed", "it must be > 0 m/s");
  if (!p.coat.empty()) {
    try {
      coatKind(p.coat);
    } catch (const Error& e) {
      throw Error("parameter " + nh.resolveName("coat"), e.what());
    }
  }
  in.warnOfOthers();
  return p;
}

std::string resolvePackage(const std::string& path) {
  const std::string scheme = "package://";
  if (path.compare(0, scheme.size(), scheme) != 0) return path;
  const std::size_t slash = path.find('/', scheme.size());
  const std::string package = path.substr(scheme.size(), slash - scheme.size());
  const std::string folder = package.empty() ? "" : ros::package::getPath(package);
  const std::string right = "; it must be package://PACKAGE/FILE";
  if (folder.empty())
    throw Error(path, "no package '" + package + "' on the ROS_PACKAGE_PATH" + right);
  if (slash == std::string::npos || slash + 1 == path.size())
    throw Error(path, "names no file" + right);
  return folder + path.substr(slash);
}

}  // namespace ragdoll
