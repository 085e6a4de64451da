// ragdoll.World: world/world.h for python.
#include "ragdoll_sim/world/world.h"

#include <cmath>
#include <memory>
#include <optional>

#include "common.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/world/batch.h"
#include "senses.h"

namespace ragdoll::python {
namespace {

class PyWorld {
 public:
  PyWorld(const py::object& scene, const py::object& solver, const py::object& settings) {
    std::string source;
    Scene from = sceneFrom(scene, solver, settings, &source);
    world_ = std::make_unique<World>(std::move(from), source);
    world_->keepContacts(true);
  }

  void step(const py::int_& steps) {
    forgetSenses();
    runSteps(stepsFrom(steps), [this](std::uint64_t n) {
      const std::lock_guard<std::mutex> lock(mutex_);
      for (std::uint64_t k = 0; k < n; ++k) world_->advance();
      world_->takeActed();  // nobody asks for what is told
      world_->takeEvents();
      world_->takeFollowed();
    });
  }

  py::array_t<double> positions() { return toArray(named([](const State& s) { return &s.x; })); }
  py::array_t<double> velocities() { return toArray(named([](const State& s) { return &s.v; })); }

  std::uint64_t poke(const std::string& body, const py::object& force, double duration,
                     const py::object& point, const py::object& at) {
    Poke poke = pokeFrom(force, duration, point);
    const Locked lock(mutex_);
    poke.start = timeFrom(at, world_->state().time);
    poke.body = findBody(*world_->model(), body);
    poke.body_name = fullNameOf(poke.body, body);
    return world_->addPoke(std::move(poke));
  }

  /// (position [m], orientation x, y, z, w), world
  py::tuple frame(const std::string& name) {
    const Locked lock(mutex_);
    const std::optional<Pose> pose = world_->frame(name);
    if (!pose) {
      std::string names;
      for (const std::string& known : world_->frameNames())
        names += (names.empty() ? "" : ", ") + known;
      throw Error("", "there is no frame '" + name + "'; there are " + names);
    }
    py::array_t<double> turn(4);
    std::copy(pose->orientation.coeffs().data(), pose->orientation.coeffs().data() + 4,
              turn.mutable_data());
    return py::make_tuple(toArray(pose->position), turn);
  }

  py::array_t<bool> asleep() {
    const Locked lock(mutex_);
    const auto& asleep = world_->state().asleep;
    py::array_t<bool> array(static_cast<py::ssize_t>(asleep.size()));
    for (std::size_t i = 0; i < asleep.size(); ++i) array.mutable_data()[i] = asleep[i] != 0;
    return array;
  }

  py::dict report() {
    const Locked lock(mutex_);
    const StepReport& r = world_->report();
    py::dict all;
    all["contacts"] = r.contacts;
    all["substeps"] = r.substeps;
    all["guarded"] = r.guarded;
    all["limited"] = r.limited;
    all["implicit"] = r.implicit;
    all["rigid"] = r.rigid;
    all["joining"] = r.joining;
    all["unresolved"] = r.unresolved;
    all["fast_fallbacks"] = r.fast_fallbacks;
    all["handed_over"] = r.handed_over;
    all["tolerance_missed"] = r.tolerance_missed;
    all["error_estimate"] = r.error_estimate;
    return all;
  }

  void forgetSenses() {
    const Locked lock(mutex_);
    world_->takeContacts();
    world_->takeImuSamples();
    contacts_.reset();
    samples_.clear();
  }

  py::object contacts() {
    const Locked lock(mutex_);
    if (!contacts_) contacts_ = world_->takeContacts();
    return contactArray(*world_->model(), *contacts_);
  }

  py::object imu() {
    const Locked lock(mutex_);
    for (ImuSample& sample : world_->takeImuSamples()) samples_.push_back(std::move(sample));
    return imuArray(*world_->model(), samples_);
  }

  py::bytes save() {
    const Locked lock(mutex_);
    const Bytes bytes = world_->save();
    return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  void restore(const py::bytes& snapshot) {
    const std::string bytes = snapshot.cast<std::string>();
    const Locked lock(mutex_);
    world_->restore(Bytes(bytes.begin(), bytes.end()));
  }

  /// call(World&) under the lock.
  template <class Call>
  auto with(Call call) {
    const Locked lock(mutex_);
    return call(*world_);
  }

 private:
  template <class Which>
  Points named(Which which) {
    const Locked lock(mutex_);
    const Model& model = *world_->model();
    const Points& of = *which(world_->state());
    Points all(3, 0);
    for (const Ragdoll& r : model.ragdolls) {
      const int n = model.skeletonOf(r).named;
      all.conservativeResize(3, all.cols() + n);
      all.rightCols(n) = of.middleCols(r.first, n);
    }
    return all;
  }

  std::string fullNameOf(const BodyRef& ref, const std::string& body) const {
    if (body.find('/') != std::string::npos) return body;
    return world_->model()->ragdolls[ref.ragdoll].name + "/" + body;
  }

  std::mutex mutex_;
  std::unique_ptr<World> world_;
  std::optional<ContactReport> contacts_;  ///< of the last step(...), once it has been asked for
  std::vector<ImuSample> samples_;
};

std::vector<std::string> ragdollNames(const World& world) {
  std::vector<std::string> names;
  for (const Ragdoll& r : world.model()->ragdolls) names.push_back(r.name);
  return names;
}

using WorldType = py::class_<PyWorld>;

void addActions(WorldType& type) {
  type.def("step", &PyWorld::step, py::arg("steps") = 1,
           "Makes so many steps. Other Python threads go on meanwhile; Ctrl-C ends it between two "
           "steps.")
      .def("reset", [](PyWorld& w) { w.with([](World& world) { world.reset(); }); },
           "Back to the scene's start: its pokes, its pins.")
      .def("save", &PyWorld::save,
           "The moment as bytes: restored into a world of the same scene it goes on to the same "
           "bits.")
      .def("restore", &PyWorld::restore, py::arg("snapshot"),
           "Goes on from what save() gave. Error, and nothing has changed, if it is something else.")
      .def("poke", &PyWorld::poke, py::arg("body"), py::arg("force"), py::arg("duration") = 0.0,
           py::arg("point") = py::make_tuple(0, 0, 0), py::arg("at") = py::none(),
           "A force [N] (3,), world, on a particle or segment ('head', 'ragdoll/torso') for "
           "duration [s] (0: one step, -1: until cleared), off the body's own point by point [m] "
           "(3,), world axes, from the time at [s] on, or from now. Returns its first step.")
      .def("clear_pokes", [](PyWorld& w) { return w.with([](World& world) { return world.clearPokes(); }); },
           "Ends all pokes that act or are to come; returns how many.")
      .def("pull",
           [](PyWorld& w, const std::string& body, const py::object& target) {
             const Vec3 to = vectorFrom(target, "target");
             w.with([&](World& world) { world.pull(body, to); });
           },
           py::arg("body"), py::arg("target"),
           "Drags a particle to the target [m] (3,) by a spring, until release().")
      .def("release",
           [](PyWorld& w, const std::string& body) { w.with([&](World& world) { world.release(body); }); },
           py::arg("body"), "Ends pull().")
      .def("detach",
           [](PyWorld& w, const std::string& body) { w.with([&](World& world) { world.detach(body); }); },
           py::arg("body"), "Lets go of a particle that a pin holds.")
      .def("frame", &PyWorld::frame, py::arg("name"),
           "Where one of `frames` is: (position [m] (3,), orientation (4,) as x, y, z, w), world.");
}

void addWorldProperties(WorldType& type) {
  const auto property = [&type](const char* name, auto get, const char* about) {
    type.def_property_readonly(name, [get](PyWorld& w) { return w.with(get); }, about);
  };
  type.def_property_readonly("positions", &PyWorld::positions,
                             "Of the particles [m], world: (n, 3) float64, a copy.")
      .def_property_readonly("velocities", &PyWorld::velocities,
                             "Of the particles [m/s], world: (n, 3) float64, a copy.")
      .def_property_readonly("asleep", &PyWorld::asleep, "Per ragdoll: whether it is at rest. (r,) bool")
      .def_property_readonly(
          "contacts", &PyWorld::contacts,
          "What touched in the last step(...), a structured array: ragdoll, body, other; position "
          "[m] (3,), normal (3,) towards the body, depth [m], force [N] (3,) on the body, mean over "
          "the steps, peak_force [N] of a step, impulse [N s], slip [m/s].")
      .def_property_readonly(
          "imu", &PyWorld::imu,
          "Samples of the scene's sensors that ended in the last step(...), a structured array: "
          "time [s], sensor, acceleration [m/s^2] (3,) (specific force) and angular_velocity "
          "[rad/s] (3,) in the sensor's frame, orientation (4,) as x, y, z, w.")
      .def_property_readonly("report", &PyWorld::report, "What the last step tells of itself.");
  property("particles", [](World& w) { return particleNames(*w.model()); },
           "Their names, in the order of `positions`; of ragdolls after the first '<ragdoll>/...'.");
  property("ragdolls", [](World& w) { return ragdollNames(w); }, "Names.");
  property("frames", [](World& w) { return w.frameNames(); }, "Names that frame() takes.");
  property("time", [](World& w) { return w.state().time; }, "[s] simulated since the start.");
  property("steps", [](World& w) { return w.state().step; }, "Made since the start.");
  property("step_length", [](World& w) { return w.stepLength(); }, "[s]");
  property("hash", [](World& w) { return hashText(hash(w.state())); },
           "Of positions and velocities, to the bit, as `ragdoll_lab run --summary` prints it.");
  property("energy",
           [](World& w) {
             return py::make_tuple(kineticEnergy(*w.model(), w.state()),
                                   potentialEnergy(*w.model(), w.state()));
           },
           "(kinetic, potential) [J]; potential: of gravity, 0 at the origin.");
  property("scene", [](World& w) { return w.scene()->text; },
           "As YAML text that stands alone, models and settings included.");
  property("warnings", [](World& w) { return w.model()->warnings; },
           "What the checks of the scene found doubtful, and mended.");
}

}  // namespace

void addWorld(py::module& module) {
  WorldType type(
      module, "World",
      "One scene that is stepped.\n\nscene: a scene's name ('stairs'), a path, or YAML text. "
      "solver: changes its settings, {'preset': 'fast', 'step': 0.005}. settings: others, "
      "{'gravity': [0, 0, -1.6], 'self_collision': True}. What follows a TF frame stays where "
      "the scene puts it. Raises Error with file, line and "
      "key. A world may be used from several threads; what they do is done in turn.");
  type.def(py::init<py::object, py::object, py::object>(), py::arg("scene"),
           py::arg("solver") = py::none(), py::arg("settings") = py::none());
  addActions(type);
  addWorldProperties(type);
}

}  // namespace ragdoll::python
