// What the classes of the python module share: arguments in, arrays out, waiting without the GIL.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <mutex>
#include <string>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll::python {

namespace py = pybind11;

/// The scene that a name, a path or YAML text means, with solver.<key> and other settings changed.
/// `solver` and `settings`: a mapping or None. source: what the user gave, empty for a text.
Scene sceneFrom(const py::object& scene, const py::object& solver, const py::object& settings,
                std::string* source = nullptr);

/// Three finite numbers. Throws Error that names the argument.
Vec3 vectorFrom(const py::object& value, const char* name);

/// A poke without a body and a start. Throws Error that names the argument: force [N] and point [m]
/// are three finite numbers, duration is [s] >= 0 or -1, until cleared.
Poke pokeFrom(const py::object& force, double duration, const py::object& point);

/// [s] now, where `at` is None. Throws Error unless it is finite.
double timeFrom(const py::object& at, double now);

/// (n, 3), a copy.
py::array_t<double> toArray(const Points& points);
py::array_t<double> toArray(const Vec3& v);

std::string hashText(std::uint64_t hash);  ///< 16 hex digits

/// steps as python gave them. Throws Error unless in 0 ... 1e12.
std::uint64_t stepsFrom(const py::int_& steps);

/// Makes `steps` steps without the GIL; looks for Ctrl-C some times a second. advance(n): makes n
/// steps; how many at once is up to the time that they take.
template <class Advance>
void runSteps(std::uint64_t steps, Advance advance);

/// Holds a mutex; waits for it without the GIL, so that a thread that steps can end.
class Locked {
 public:
  explicit Locked(std::mutex& mutex) : lock_(mutex, std::try_to_lock) {
    if (lock_.owns_lock()) return;
    const py::gil_scoped_release release;
    lock_.lock();
  }

 private:
  std::unique_lock<std::mutex> lock_;
};

void addWorld(py::module& module);
void addCrowd(py::module& module);
void addFall(py::module& module);

}  // namespace ragdoll::python

#include "run_steps.h"
