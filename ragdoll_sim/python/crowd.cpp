// ragdoll.Crowd: world/crowd.h for python.
#include "ragdoll_sim/world/crowd.h"

#include <cmath>
#include <memory>

#include "common.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::python {
namespace {

class PyCrowd {
 public:
  PyCrowd(const py::object& scenes, int threads, const py::object& solver,
          const py::object& settings) {
    if (py::isinstance<py::str>(scenes) || !py::hasattr(scenes, "__iter__"))
      throw Error("scenes", "is no list; a list of scenes is expected");
    std::vector<Scene> all;
    std::vector<std::pair<py::object, Scene>> known;  // the same object means the same scene
    for (const py::handle& item : scenes) {
      const py::object scene = py::reinterpret_borrow<py::object>(item);
      const Scene* same = nullptr;
      for (const auto& [object, loaded] : known)
        if (object.is(scene)) same = &loaded;
      if (!same) {
        known.emplace_back(scene, sceneFrom(scene, solver, settings));
        same = &known.back().second;
      }
      all.push_back(*same);
    }
    crowd_ = std::make_unique<Crowd>(std::move(all), threads);
  }

  int size() const { return crowd_->size(); }

  void step(const py::int_& steps) {
    runSteps(stepsFrom(steps), [this](std::uint64_t n) {
      const std::lock_guard<std::mutex> lock(mutex_);
      crowd_->step(n);
    });
  }

  void poke(int scene, const std::string& body, const py::object& force, double duration,
            const py::object& point, const py::object& at) {
    if (scene < 0 || scene >= size())
      throw Error("scene", "is " + std::to_string(scene) + "; 0 ... " + std::to_string(size() - 1) +
                               " are there");
    Poke poke = pokeFrom(force, duration, point);
    const Locked lock(mutex_);
    Batch& batch = crowd_->batch(scene);
    poke.start = timeFrom(at, batch.state().time);
    poke.body = batch.find(crowd_->member(scene), body);
    poke.body_name = std::to_string(scene) + "/" + body;
    batch.addPoke(std::move(poke));
  }

  /// get(batch, member) of each scene, as a list.
  template <class Get>
  py::list each(Get get) {
    const Locked lock(mutex_);
    py::list all;
    for (int i = 0; i < size(); ++i) all.append(get(crowd_->batch(i), crowd_->member(i)));
    return all;
  }

  template <class Call>
  auto with(Call call) {
    const Locked lock(mutex_);
    return call(*crowd_);
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Crowd> crowd_;
};

py::array_t<bool> asleepIn(const Batch& batch, int member) {
  py::array_t<bool> array(batch.ragdolls(member));
  for (int i = 0; i < batch.ragdolls(member); ++i)
    array.mutable_data()[i] = batch.state().asleep[batch.firstRagdoll(member) + i] != 0;
  return array;
}

void clearPokes(Crowd& crowd) {
  for (int i = 0; i < crowd.size(); ++i)
    if (crowd.member(i) == 0) crowd.batch(i).clearPokes();
}

using CrowdType = py::class_<PyCrowd>;

void addCrowdProperties(CrowdType& type) {
  const auto property = [&type](const char* name, auto get, const char* about) {
    type.def_property_readonly(name, [get](PyCrowd& c) { return c.each(get); }, about);
  };
  property("positions", [](const Batch& b, int i) { return toArray(b.positions(i)); },
           "Per scene, of its particles [m], world: (n, 3) float64, a copy.");
  property("velocities", [](const Batch& b, int i) { return toArray(b.velocities(i)); },
           "Per scene, of its particles [m/s], world: (n, 3) float64, a copy.");
  property("particles", [](const Batch& b, int i) { return b.names(i); },
           "Per scene: names, in the order of `positions`.");
  property("hashes", [](const Batch& b, int i) { return hashText(b.hash(i)); },
           "Per scene: the hash that World of this scene alone has.");
  property("asleep", asleepIn, "Per scene and ragdoll: whether it is at rest. (r,) bool");
  type.def_property_readonly(
      "time",
      [](PyCrowd& c) { return c.with([](Crowd& crowd) { return crowd.batch(0).state().time; }); },
      "[s] simulated since the start.");
  type.def_property_readonly(
      "step_length",
      [](PyCrowd& c) {
        return c.with([](Crowd& crowd) { return crowd.batch(0).model().solver.step; });
      },
      "[s]");
  type.def_property_readonly(
      "batches", [](PyCrowd& c) { return c.with([](Crowd& crowd) { return crowd.batches(); }); },
      "How many parts it is stepped in.");
}

}  // namespace

void addCrowd(py::module& module) {
  CrowdType type(
      module, "Crowd",
      "Many scenes of any mix, stepped together on so many threads (0: all cores). Scenes "
      "of one body each that differ in body, start and pokes alone share packs of the fast "
      "method. The bits of each are those that World gives it. All have the same length of "
      "step. scenes, solver, settings: as World's; Error likewise.");
  type.def(py::init<py::object, int, py::object, py::object>(), py::arg("scenes"),
           py::arg("threads") = 1, py::arg("solver") = py::none(),
           py::arg("settings") = py::none())
      .def("__len__", &PyCrowd::size)
      .def("step", &PyCrowd::step, py::arg("steps") = 1,
           "Makes so many steps of every scene. Other Python threads go on meanwhile.")
      .def("reset", [](PyCrowd& c) { c.with([](Crowd& crowd) { crowd.reset(); }); },
           "Back to the scenes' start.")
      .def("poke", &PyCrowd::poke, py::arg("scene"), py::arg("body"), py::arg("force"),
           py::arg("duration") = 0.0, py::arg("point") = py::make_tuple(0, 0, 0),
           py::arg("at") = py::none(),
           "As World.poke, in the scene of this number (from 0 on).")
      .def("clear_pokes", [](PyCrowd& c) { c.with([](Crowd& crowd) { clearPokes(crowd); }); },
           "Ends all pokes of all scenes.");
  addCrowdProperties(type);
}

}  // namespace ragdoll::python
