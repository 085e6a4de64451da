// ragdoll.Fall: falls/fall.h and falls/judge.h for python.
#include <map>

#include "common.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/falls/judge.h"
#include "ragdoll_sim/io/model_yaml.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/io/share.h"

namespace ragdoll::python {
namespace {

using Samples = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Any whole number of python's or numpy's. Throws Error where falls::drawFall would.
std::uint64_t seedFrom(const py::object& seed) {
  if (PyIndex_Check(seed.ptr()) == 0) throw py::type_error("seed must be a whole number");
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(seed.ptr()));
  if (!whole) throw py::error_already_set();
  const unsigned long long value = PyLong_AsUnsignedLongLong(whole.ptr());
  if (PyErr_Occurred() == nullptr) return value;
  PyErr_Clear();
  throw Error("seed", "is " + py::repr(whole).cast<std::string>() + "; 0 ... " +
                          std::to_string(falls::kLastSeed) + " is expected");
}

class PyFall {
 public:
  PyFall(const py::object& seed, const std::string& model, double step)
      : fall_(falls::drawFall(seedFrom(seed))) {
    const auto body = loadModel(findModel(model, ".", "model"));
    made_ = falls::fallScene(fall_, falls::scaledModel(*body, fall_.scale), step);
    made_.scene.text = toYaml(made_.scene);
    const Model built = buildModel(made_.scene);
    const Skeleton& s = built.skeletons[0];
    names_.assign(s.particles.begin(), s.particles.begin() + s.named);
    radii_.assign(s.radius.data(), s.radius.data() + s.named);
    floors_.assign(built.obstacles.begin(), built.obstacles.begin() + made_.floors);
  }

  py::dict labels() const {
    py::dict all;
    all["seed"] = fall_.seed;
    all["kind"] = fall_.kind;
    all["start"] = fall_.start;
    all["height"] = fall_.height;
    all["mass"] = fall_.mass;
    all["start_yaw_deg"] = fall_.yaw;
    all["start_pitch_deg"] = fall_.pitch;
    all["start_roll_deg"] = fall_.roll;
    all["friction"] = fall_.friction;
    all["speed"] = fall_.speed;
    all["push_body"] = fall_.push_body;
    all["push_x"] = fall_.push.x();
    all["push_y"] = fall_.push.y();
    all["push_z"] = fall_.push.z();
    all["push_duration"] = fall_.push_duration;
    all["foot"] = fall_.foot;
    all["foot_hold"] = fall_.hold;
    all["foot_friction"] = fall_.foot_friction;
    return all;
  }

  std::string scene() const { return made_.scene.text; }
  double release() const { return made_.release; }
  std::vector<std::string> held() const { return made_.held(); }
  std::vector<std::string> particles() const { return names_; }

  py::dict judge(const Samples& times, const Samples& positions, const Samples& velocities) const {
    const py::ssize_t n = static_cast<py::ssize_t>(names_.size()), count = times.size();
    for (const Samples* array : {&positions, &velocities})
      if (count < 1 || array->ndim() != 3 || array->shape(0) != count || array->shape(1) != n ||
          array->shape(2) != 3)
        throw Error("judge", "times (T,), positions and velocities (T, " + std::to_string(n) +
                                 ", 3) are expected, T > 0");
    falls::Judge judge(names_, radii_, floors_);
    for (py::ssize_t k = 0; k < count; ++k)
      judge.look(times.data()[k], Eigen::Map<const Points>(positions.data() + 3 * n * k, 3, n),
                 Eigen::Map<const Points>(velocities.data() + 3 * n * k, 3, n));
    const falls::Outcome o = judge.outcome();
    py::dict all;
    all["impact_time"] = o.impact_time ? py::object(py::float_(*o.impact_time)) : py::none();
    all["impact_body"] = o.impact_body;
    all["impact_region"] = o.impact_region;
    all["impact_speed"] = o.impact_time ? py::object(py::float_(o.impact_speed)) : py::none();
    all["end_pose"] = o.end_pose;
    all["end_head_height"] = o.end_head_height;
    return all;
  }

 private:
  falls::Fall fall_;
  falls::FallScene made_;
  std::vector<std::string> names_;
  std::vector<double> radii_;
  std::vector<Obstacle> floors_;
};

std::string poseClass(const std::map<std::string, py::object>& at) {
  const auto point = [&at](const char* name) {
    const auto it = at.find(name);
    if (it == at.end()) throw Error("pose_class", std::string("there is no '") + name + "'");
    return vectorFrom(it->second, name);
  };
  return falls::poseClass(point("neck"), point("left_shoulder"), point("right_shoulder"),
                          point("left_hip"), point("right_hip"));
}

}  // namespace

void addFall(py::module& module) {
  py::class_<PyFall>(
      module, "Fall",
      "A fall of the data sets (docs/data.md), drawn from its seed alone: the falls of `ragdoll_lab "
      "falls`. Time 0 is its onset. model: a model's name or file; step [s] of the scene.")
      .def(py::init<py::object, std::string, double>(), py::arg("seed"),
           py::arg("model") = "human", py::arg("step") = 1.0 / 200)
      .def_property_readonly("labels", &PyFall::labels, "What is known before it, by name.")
      .def_property_readonly("scene", &PyFall::scene, "YAML text of its scene.")
      .def_property_readonly("held", &PyFall::held,
                             "Particles that pins hold at first: let go of them at `release`.")
      .def_property_readonly("release", &PyFall::release, "[s] 0: at the onset")
      .def_property_readonly("particles", &PyFall::particles, "Names, in the order that judge() wants.")
      .def("judge", &PyFall::judge, py::arg("times"), py::arg("positions"), py::arg("velocities"),
           "What it came to, by name: impact_time [s], impact_body, impact_region, impact_speed "
           "[m/s], end_pose, end_head_height [m]; from times [s] (T,), positions [m] and velocities "
           "[m/s] (T, n, 3) of the particles.");
  module.def("pose_class", &poseClass, py::arg("positions"),
             "How a body lies, from its particles' positions [m] by name: upright, supine, prone, "
             "on_left_side or on_right_side.");
}

}  // namespace ragdoll::python
