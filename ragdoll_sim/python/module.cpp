// import ragdoll: worlds and crowds for python (python/ragdoll has the package around this module).
#include <algorithm>
#include <filesystem>
#include <set>

#include "common.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/share.h"

namespace ragdoll::python {
namespace {

/// Names of the files that come with the package in this folder.
std::vector<std::string> shipped(const std::string& folder) {
  namespace fs = std::filesystem;
  std::set<std::string> names;
  for (const std::string& share : shareDirectories()) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(fs::path(share) / folder, none))
      if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  }
  return {names.begin(), names.end()};
}

}  // namespace
}  // namespace ragdoll::python

PYBIND11_MODULE(_ragdoll, module) {
  using namespace ragdoll::python;
  py::register_exception<ragdoll::Error>(module, "Error");
  module.attr("Error").attr("__module__") = "ragdoll";
  module.def("scenes", [] { return shipped("scenes"); }, "Names of the scenes that come with it.");
  module.def("models", [] { return shipped("models"); }, "Names of the models that come with it.");
  addWorld(module);
  addCrowd(module);
  addFall(module);
}
