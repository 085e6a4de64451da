#include "settings.h"

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/config_tools.h>
#include <ros/master.h>
#include <ros/param.h>

#include <cmath>
#include <sstream>
#include <type_traits>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

using dynamic_reconfigure::ConfigTools;
using XmlRpc::XmlRpcValue;

const std::string kRecord = "/ragdoll_sim/settings";  // not among the node's own names

std::string textOf(XmlRpcValue value) {
  if (value.getType() == XmlRpcValue::TypeDouble) return numberText(value);
  std::ostringstream out;
  value.write(out);
  return out.str();
}

/// Of the one number in it; empty: it has none.
std::string textOf(const dynamic_reconfigure::Config& message) {
  if (!message.doubles.empty()) return numberText(message.doubles[0].value);
  return message.ints.empty() ? "" : std::to_string(message.ints[0].value);
}

/// Adds it to `message` if it is of this type of dynamic_reconfigure.
bool append(const std::string& name, const std::string& type, XmlRpcValue value,
            dynamic_reconfigure::Config& message) {
  const XmlRpcValue::Type is = value.getType();
  if (type == "str" && is == XmlRpcValue::TypeString)
    ConfigTools::appendParameter(message, name, static_cast<std::string&>(value));
  else if (type == "bool" && is == XmlRpcValue::TypeBoolean)
    ConfigTools::appendParameter(message, name, static_cast<bool&>(value));
  else if (type == "int" && is == XmlRpcValue::TypeInt)
    ConfigTools::appendParameter(message, name, static_cast<int&>(value));
  else if (type == "double" && is == XmlRpcValue::TypeInt)
    ConfigTools::appendParameter(message, name, static_cast<double>(static_cast<int&>(value)));
  else if (type == "double" && is == XmlRpcValue::TypeDouble)
    ConfigTools::appendParameter(message, name, static_cast<double&>(value));
  else
    return false;
  return true;
}

/// Of a setting that is a number with a name; null: of another one.
const std::vector<std::string>* numberNames(const std::string& setting) {
  if (setting == "method") return &methodNames();
  return setting == "integrator" ? &integratorNames() : nullptr;
}

/// The number of what is named; else as it is.
XmlRpcValue numbered(const std::string& setting, XmlRpcValue value) {
  const std::vector<std::string>* names = numberNames(setting);
  if (!names || value.getType() != XmlRpcValue::TypeString) return value;
  const int number = indexOf(*names, static_cast<std::string&>(value));
  return number < 0 ? value : XmlRpcValue(number);
}

/// "in [0, 2]", or "one of 0 verlet, 1 euler".
std::string rangeText(const std::string& name, const std::string& type) {
  if (const std::vector<std::string>* names = numberNames(name)) {
    std::vector<std::string> texts;
    for (const std::string& n : *names) texts.push_back(std::to_string(texts.size()) + " " + n);
    return "one of " + joined(texts);
  }
  dynamic_reconfigure::Config least, most;
  SolverConfig::__getMin__().__toMessage__(least);
  SolverConfig::__getMax__().__toMessage__(most);
  double low = 0, high = 0;
  if (type == "int") {
    int a = 0, b = 0;
    ConfigTools::getParameter(least, name, a);
    ConfigTools::getParameter(most, name, b);
    low = a, high = b;
  } else {
    ConfigTools::getParameter(least, name, low);
    ConfigTools::getParameter(most, name, high);
  }
  return "in [" + numberText(low) + ", " + numberText(high) + "]";
}

const char* kindOf(const std::string& type) {
  if (type == "str") return "text";
  if (type == "bool") return "true or false";
  return type == "int" ? "a whole number" : "a number";
}

bool isWithin(const SolverConfig& config) {
  SolverConfig clamped = config;
  clamped.__clamp__();
  dynamic_reconfigure::Config a, b;
  config.__toMessage__(a);
  clamped.__toMessage__(b);
  for (std::size_t i = 0; i < a.ints.size(); ++i)
    if (a.ints[i].value != b.ints[i].value) return false;
  for (std::size_t i = 0; i < a.doubles.size(); ++i)
    if (a.doubles[i].value != b.doubles[i].value) return false;  // nor is NaN
  return true;
}

void usePreset(const std::string& name, SolverSpec& solver) {
  SolverSpec next = preset(name);
  next.joint_damping = solver.joint_damping;
  next.threads = solver.threads;
  next.where = solver.where;
  solver = std::move(next);
}

Numbers numbersOf(const std::string& where, const std::string& name) {
  if (name == "double") return Numbers::kDouble;
  if (name == "float") return Numbers::kFloat;
  throw Error(where, "is '" + name + "'; it must be double or float");
}

/// Throws Error that names it as `where` if it is out of range in `one`, where all others are as by
/// default. is: "is 3; it must be ".
void checkRange(const SolverConfig::AbstractParamDescription& setting, const std::string& where,
                const std::string& is, const SolverConfig& one) {
  if (!isWithin(one))
    throw Error(where, is + rangeText(setting.name, setting.type) + ": " + setting.description);
  if (setting.name == "tolerance") checkTolerance(where, one.tolerance);
  if (setting.name == "numbers") numbersOf(where, one.numbers);
}

/// A setting as a parameter, into `config`. Throws Error that names it as `where`.
void takeGiven(const SolverConfig::AbstractParamDescription& setting, const std::string& where,
               const XmlRpcValue& given, SolverConfig& config) {
  const std::string &name = setting.name, &type = setting.type;
  const std::string is = "is " + textOf(given) + "; it must be ";
  dynamic_reconfigure::Config message;
  if (!append(name, type, numbered(name, given), message)) {
    if (numberNames(name)) throw Error(where, is + rangeText(name, type));
    throw Error(where, std::string("must be ") + kindOf(type) + ", by default the scene's, is " +
                           textOf(given));
  }
  SolverConfig one = SolverConfig::__getDefault__();
  setting.fromMessage(message, one);
  checkRange(setting, where, is, one);
  setting.fromMessage(message, config);
}

/// Which a scene has, too.
bool isOfScene(const std::string& setting) {
  return setting != "realtime_factor" && setting != "show_limits" && setting != "show_contacts";
}

}  // namespace

std::vector<std::string> settingNames() {
  std::vector<std::string> names;
  for (const auto& setting : SolverConfig::__getParamDescriptions__())
    names.push_back(setting->name);
  return names;
}

SolverConfig toConfig(const SolverSpec& solver, const Vec3& gravity, double realtime_factor,
                      const SolverConfig& drawn) {
  SolverConfig c = SolverConfig::__getDefault__();
  c.preset = solver.preset;
  c.method = static_cast<int>(solver.method);
  c.integrator = static_cast<int>(solver.integrator);
  c.step = solver.step;
  c.sweeps = solver.sweeps;
  c.tolerance = solver.tolerance;
  c.numbers = solver.numbers == Numbers::kFloat ? "float" : "double";
  c.threads = solver.threads;
  c.damping = solver.damping;
  c.joint_damping = solver.joint_damping;
  c.sleep = solver.sleep;
  c.gravity_x = gravity.x();
  c.gravity_y = gravity.y();
  c.gravity_z = gravity.z();
  c.realtime_factor = realtime_factor;
  c.show_limits = drawn.show_limits;
  c.show_contacts = drawn.show_contacts;
  c.coat = drawn.coat;
  return c;
}

void checkChanges(const SolverConfig& config, const SolverConfig& shown) {
  for (const auto& setting : SolverConfig::__getParamDescriptions__()) {
    dynamic_reconfigure::Config message, before;
    setting->toMessage(message, config);
    setting->toMessage(before, shown);
    const std::string value = textOf(message);
    if (value == textOf(before)) continue;
    SolverConfig one = SolverConfig::__getDefault__();
    setting->fromMessage(message, one);
    checkRange(*setting, setting->name, "is " + value + "; it must be ", one);
  }
}

void applyChanges(const SolverConfig& config, const SolverConfig& shown, Scene& scene) {
  const auto set = [](const auto& to, const auto& from, auto& value) {
    if (to != from) value = static_cast<std::decay_t<decltype(value)>>(to);
  };
  SolverSpec& solver = scene.solver;
  if (config.preset != shown.preset) usePreset(config.preset, solver);
  set(config.method, shown.method, solver.method);
  set(config.integrator, shown.integrator, solver.integrator);
  set(config.step, shown.step, solver.step);
  set(config.sweeps, shown.sweeps, solver.sweeps);
  set(config.tolerance, shown.tolerance, solver.tolerance);
  if (config.numbers != shown.numbers) solver.numbers = numbersOf("numbers", config.numbers);
  set(config.damping, shown.damping, solver.damping);
  set(config.sleep, shown.sleep, solver.sleep);
  set(config.threads, shown.threads, solver.threads);
  set(config.joint_damping, shown.joint_damping, solver.joint_damping);
  set(config.gravity_x, shown.gravity_x, scene.gravity.x());
  set(config.gravity_y, shown.gravity_y, scene.gravity.y());
  set(config.gravity_z, shown.gravity_z, scene.gravity.z());
}

GivenSettings::GivenSettings(const ros::NodeHandle& nh) : nh_(nh) {
  const XmlRpcValue written = recorded("written"), given = recorded("given");
  for (const std::string& name : settingNames()) {
    XmlRpcValue value;
    if (!nh.getParam(name, value)) continue;
    const bool left_over = written.valid() && written.hasMember(name) && written[name] == value;
    if (!left_over)
      given_[name] = value;
    else if (given.valid() && given.hasMember(name))  // to the one before, and that still stands
      given_[name] = given[name];
  }
}

/// Invalid where there is none.
XmlRpcValue GivenSettings::recorded(const char* part) const {
  XmlRpcValue record;
  if (!ros::param::get(kRecord + nh_.getNamespace(), record) ||
      record.getType() != XmlRpcValue::TypeStruct || !record.hasMember(part) ||
      record[part].getType() != XmlRpcValue::TypeStruct)
    return {};
  return record[part];
}

template <class T>
bool GivenSettings::get(const std::string& name, T& value) const {
  const auto found = given_.find(name);
  if (found == given_.end()) return false;
  XmlRpcValue given = found->second;
  if constexpr (std::is_same_v<T, XmlRpcValue>) {
    value = given;
    return true;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (given.getType() != XmlRpcValue::TypeBoolean) return false;
    value = static_cast<bool&>(given);
    return true;
  } else if constexpr (std::is_same_v<T, double>) {
    if (given.getType() == XmlRpcValue::TypeInt)
      value = static_cast<int&>(given);
    else if (given.getType() == XmlRpcValue::TypeDouble)
      value = static_cast<double&>(given);
    else
      return false;
    return true;
  } else {
    if (given.getType() != XmlRpcValue::TypeString) return false;
    value = static_cast<std::string&>(given);
    return true;
  }
}

template bool GivenSettings::get(const std::string&, bool&) const;
template bool GivenSettings::get(const std::string&, double&) const;
template bool GivenSettings::get(const std::string&, std::string&) const;
template bool GivenSettings::get(const std::string&, XmlRpcValue&) const;

void GivenSettings::apply(Scene& scene) const {
  if (given_.empty()) return;
  Scene next = scene;
  if (std::string name; has("preset")) {
    if (!get("preset", name) || indexOf(presetNames(), name) < 0)
      throw Error("parameter " + nh_.resolveName("preset"),
                  "is " + textOf(given_.at("preset")) + "; there are " + joined(presetNames()));
    usePreset(name, next.solver);
  }
  const SolverConfig shown = toConfig(next.solver, next.gravity, 1, SolverConfig::__getDefault__());
  SolverConfig config = shown;
  for (const auto& setting : SolverConfig::__getParamDescriptions__()) {
    const std::string& name = setting->name;
    if (has(name) && name != "preset" && name != "coat")
      takeGiven(*setting, "parameter " + nh_.resolveName(name), given_.at(name), config);
  }
  applyChanges(config, shown, next);
  next.text = toYaml(next);
  scene = std::move(next);
}

std::string GivenSettings::overriding() const {
  std::vector<std::string> texts;
  for (const std::string& name : settingNames()) {
    if (!has(name) || !isOfScene(name)) continue;
    const std::string value = textOf(given_.at(name));
    if (!value.empty()) texts.push_back(name + " " + value);
  }
  return joined(texts);
}

void GivenSettings::record(const SolverConfig& config) const {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  XmlRpcValue written, given;
  for (const auto& p : message.bools) written[p.name] = XmlRpcValue(p.value != 0);
  for (const auto& p : message.ints) written[p.name] = XmlRpcValue(static_cast<int>(p.value));
  for (const auto& p : message.doubles) written[p.name] = XmlRpcValue(p.value);
  for (const auto& p : message.strs) written[p.name] = XmlRpcValue(p.value);
  for (const auto& [name, value] : given_) given[name] = value;
  XmlRpcValue record;
  record["written"] = written;
  if (given.valid()) record["given"] = given;
  ros::param::set(kRecord + nh_.getNamespace(), record);
}

void GivenSettings::restore() const {
  if (!ros::master::check()) return;  // else ROS would wait for one
  XmlRpcValue written = recorded("written"), now;
  for (const std::string& name : settingNames()) {
    if (!written.valid() || !written.hasMember(name)) continue;
    if (!nh_.getParam(name, now) || now != written[name]) continue;
    const auto given = given_.find(name);
    if (given != given_.end())
      nh_.setParam(name, given->second);
    else
      nh_.deleteParam(name);
  }
  ros::param::del(kRecord + nh_.getNamespace());
}

}  // namespace ragdoll
