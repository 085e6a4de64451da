// The program ragdoll_lab as another program sees it: output, exit status, messages.
#pragma once

#ifdef RAGDOLL_LAB

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace ragdoll::test {

struct Outcome {
  int status = -1;
  std::string output, errors;
};

inline std::string contentOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs the program in a folder of its own, which ends with the test.
class LabProgram : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  /// `environment` stands before the program: "PATH=/nowhere".
  Outcome lab(const std::string& arguments, const std::string& environment = "") const {
    const std::string errors = (folder / "errors").string();
    const std::string command = environment + " '" RAGDOLL_LAB "' " + arguments + " >'" +
                                (folder / "output").string() + "' 2>'" + errors + "'";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), contentOf(folder / "output"), contentOf(errors)};
  }

  /// A file of that name and text in the folder; its path.
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("ragdoll_lab_test_" + std::to_string(getpid()));
};

}  // namespace ragdoll::test

#endif  // RAGDOLL_LAB
