#include "ragdoll_sim/io/share.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "document.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool isFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

bool isFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// The names of the YAML files in the folder called `kind` of every share directory.
std::string available(const std::string& kind) {
  std::set<std::string> names;
  for (const std::string& share : shareDirectories()) {
    std::error_code ignored;
    for (fs::directory_iterator file(fs::path(share) / kind, ignored), end; file != end;
         file.increment(ignored)) {
      if (file->path().extension() == ".yaml") names.insert(file->path().stem().string());
      if (ignored) break;
    }
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none was found" : list;
}

/// share/kind/name.yaml of the first share directory that has it, else "".
std::string shared(const std::string& kind, const std::string& name) {
  for (const std::string& share : shareDirectories()) {
    const fs::path path = fs::path(share) / kind / (name + ".yaml");
    if (isFile(path)) return path.string();
  }
  return "";
}

bool isBareName(const std::string& name) {
  return name.find('/') == std::string::npos && fs::path(name).extension() != ".yaml";
}

}  // namespace

std::vector<std::string> shareDirectories() {
  std::vector<fs::path> candidates;
  if (const std::string chosen = environment("RAGDOLL_SHARE_DIR"); !chosen.empty()) {
    candidates.emplace_back(chosen);
  }
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  candidates.push_back(program / "../../share/ragdoll_sim");
  candidates.push_back(program / "../share/ragdoll_sim");
#ifdef RAGDOLL_SHARE_DIR
  candidates.emplace_back(RAGDOLL_SHARE_DIR);
#endif
#ifdef RAGDOLL_INSTALL_SHARE_DIR
  candidates.emplace_back(RAGDOLL_INSTALL_SHARE_DIR);
#endif
  std::istringstream packages(environment("ROS_PACKAGE_PATH"));
  for (std::string entry; std::getline(packages, entry, ':');) {
    if (entry.empty()) continue;
    candidates.push_back(fs::path(entry) / "ragdoll_sim");
    candidates.emplace_back(entry);
  }
  std::vector<std::string> folders;
  for (const fs::path& candidate : candidates) {
    if (!isFolder(candidate / "models")) continue;
    const std::string folder = fs::weakly_canonical(candidate, ignored).string();
    if (std::find(folders.begin(), folders.end(), folder) == folders.end())
      folders.push_back(folder);
  }
  return folders;
}

std::string findScene(const std::string& scene) {
  if (scene.empty()) throw Error("scene", "is empty; a file or one of: " + available("scenes"));
  if (isFile(scene)) return scene;
  if (isBareName(scene)) {
    if (const std::string path = shared("scenes", scene); !path.empty()) return path;
    throw Error(io::quoted(scene), "no such scene; a file or one of: " + available("scenes"));
  }
  std::error_code ignored;
  if (fs::path(scene).is_relative() && !fs::exists(scene, ignored))
    throw Error(scene, "no such file in " + fs::current_path(ignored).string() +
                           "; a path, or a scene's name: " + available("scenes"));
  return scene;
}

std::string findModel(const std::string& model, const std::string& folder,
                      const std::string& where) {
  if (isBareName(model)) {
    if (const std::string path = shared("models", model); !path.empty()) return path;
    throw Error(where, "there is no model " + io::quoted(model) +
                           "; a file (*.yaml), a mapping or one of: " + available("models"));
  }
  const fs::path path = fs::path(model).is_absolute() ? fs::path(model) : fs::path(folder) / model;
  if (!isFile(path)) {
    throw Error(where, "there is no file " + io::quoted(model) + " (a path is relative to the " +
                           "scene's folder); known models: " + available("models"));
  }
  return path.string();
}

}  // namespace ragdoll
