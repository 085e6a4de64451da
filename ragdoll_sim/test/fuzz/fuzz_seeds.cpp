// fuzz_seeds DIR: writes DIR/scene/ and DIR/snapshot/, what the fuzzers start from.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/share.h"
#include "support/hostile.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc != 2) {
    std::cerr << "Usage: fuzz_seeds DIR\n";
    return 2;
  }
  const fs::path scenes = fs::path(argv[1]) / "scene", snapshots = fs::path(argv[1]) / "snapshot";
  fs::create_directories(scenes);
  fs::create_directories(snapshots);
  for (const auto& entry : fs::directory_iterator(fs::path(ragdoll::findScene("fall")).parent_path())) {
    fs::copy_file(entry.path(), scenes / entry.path().filename(), fs::copy_options::overwrite_existing);
    std::ofstream(scenes / (entry.path().stem().string() + "_full.yaml"))
        << ragdoll::loadScene(entry.path().string()).text;
  }
  const fs::path human = ragdoll::findModel("human", ".", "");
  for (const auto& entry : fs::directory_iterator(human.parent_path()))
    fs::copy_file(entry.path(), scenes / entry.path().filename(), fs::copy_options::overwrite_existing);
  const ragdoll::Model model = ragdoll::buildModel(ragdoll::test::snapshotScene());
  for (const int steps : {0, 1, 20, 200}) {
    const auto bytes = ragdoll::test::snapshotAfter(model, steps);
    std::ofstream(snapshots / std::to_string(steps), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  return 0;
}
