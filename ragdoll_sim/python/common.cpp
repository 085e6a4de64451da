#include "common.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::python {
namespace {

constexpr double kMostSteps = 1e12;

/// As a scene file would write it.
std::string settingText(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::hasattr(value, "tolist")) return settingText(value.attr("tolist")());
  return py::repr(py::isinstance<py::tuple>(value) ? py::object(py::list(value.cast<py::tuple>()))
                                                   : value.cast<py::object>())
      .cast<std::string>();
}

void apply(Scene& scene, const py::object& settings, const std::string& prefix, const char* what) {
  if (settings.is_none()) return;
  if (!py::hasattr(settings, "items"))
    throw Error(what, "is not a mapping; a dict such as {\"preset\": \"fast\"} is expected");
  const py::dict all = py::dict(settings);
  std::vector<std::pair<std::string, std::string>> others;
  for (const auto& item : all) {
    const std::string key = prefix + py::str(item.first).cast<std::string>();
    if (key == "solver.preset")  // sets the others, whatever their order
      applySetting(scene, key, settingText(item.second));
    else
      others.emplace_back(key, settingText(item.second));
  }
  for (const auto& [key, value] : others) applySetting(scene, key, value);
}

}  // namespace

Scene sceneFrom(const py::object& scene, const py::object& solver, const py::object& settings,
                std::string* source) {
  if (!py::isinstance<py::str>(scene) && !py::hasattr(scene, "__fspath__"))
    throw Error("scene", "is a " + py::str(scene.get_type().attr("__name__")).cast<std::string>() +
                             "; a scene's name, a path or YAML text is expected");
  const bool path = !py::isinstance<py::str>(scene);
  const std::string text = py::str(path ? scene.attr("__fspath__")() : scene).cast<std::string>();
  const bool yaml = !path && isSceneText(text);
  Scene result = yaml ? parseScene(text) : loadScene(text);
  if (source) *source = yaml ? "" : text;
  fixFrames(result);
  apply(result, solver, "solver.", "solver");
  apply(result, settings, "", "settings");
  return result;
}

Vec3 vectorFrom(const py::object& value, const char* name) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw Error(name, "is no vector; three numbers are expected");
  }
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw Error(name, "has " + std::to_string(array.size()) + " numbers; three are expected");
  const Vec3 v(array.data()[0], array.data()[1], array.data()[2]);
  if (!v.allFinite()) throw Error(name, "is not finite");
  return v;
}

Poke pokeFrom(const py::object& force, double duration, const py::object& point) {
  Poke poke;
  poke.force = vectorFrom(force, "force");
  poke.point = vectorFrom(point, "point");
  poke.duration = duration;
  if (!(duration >= 0 && std::isfinite(duration)) && duration != -1)
    throw Error("duration", "is " + std::to_string(duration) +
                                "; seconds >= 0 are expected (0: one step), or -1: until cleared");
  return poke;
}

double timeFrom(const py::object& at, double now) {
  const double time = at.is_none() ? now : at.cast<double>();
  if (!std::isfinite(time)) throw Error("at", "is no time [s]");
  return time;
}

py::array_t<double> toArray(const Points& points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.cols()), static_cast<py::ssize_t>(3)});
  std::copy(points.data(), points.data() + points.size(), array.mutable_data());
  return array;
}

py::array_t<double> toArray(const Vec3& v) {
  py::array_t<double> array(3);
  std::copy(v.data(), v.data() + 3, array.mutable_data());
  return array;
}

std::string hashText(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::uint64_t stepsFrom(const py::int_& steps) {
  const double wanted = PyLong_AsDouble(steps.ptr());
  PyErr_Clear();
  if (!(wanted >= 0 && wanted <= kMostSteps))
    throw Error("steps", "is " + py::repr(steps).cast<std::string>() +
                             "; a number in 0 ... 1e12 is expected");
  return static_cast<std::uint64_t>(wanted);
}

}  // namespace ragdoll::python
