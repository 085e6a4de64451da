// Which file a name means.
#include "ragdoll_sim/io/share.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/error_of.h"

namespace ragdoll {
namespace {

namespace fs = std::filesystem;
using test::errorOf;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A folder of its own that is wanted most, with what a share directory has; gone after the test.
class Share : public testing::Test {
 protected:
  Share()
      : root_(fs::canonical(fs::temp_directory_path()) /
              ("ragdoll_share_" + std::to_string(getpid()))) {
    write("models/dot.yaml");
    write("scenes/drop.yaml");
    write("scenes/notes.txt");
    setenv("RAGDOLL_SHARE_DIR", root_.c_str(), 1);
  }
  ~Share() override {
    unsetenv("RAGDOLL_SHARE_DIR");
    fs::remove_all(root_);
  }
  void write(const fs::path& file) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << "\n";
  }
  std::string at(const fs::path& file) const { return (root_ / file).string(); }

  fs::path root_;
};

TEST_F(Share, DirectoryOfTheEnvironmentIsFirstAndThePackagesOwnStays) {
  const std::vector<std::string> all = shareDirectories();
  ASSERT_GE(all.size(), 2u);
  EXPECT_EQ(all[0], root_);
  EXPECT_EQ(std::count(all.begin(), all.end(), fs::canonical(RAGDOLL_SHARE_DIR).string()), 1);
  setenv("RAGDOLL_SHARE_DIR", RAGDOLL_SHARE_DIR "/models/..", 1);  // the same one: it stands once
  const std::vector<std::string> once = shareDirectories();
  EXPECT_EQ(std::count(once.begin(), once.end(), fs::canonical(RAGDOLL_SHARE_DIR).string()), 1);
  setenv("RAGDOLL_SHARE_DIR", at("scenes").c_str(), 1);  // has no models
  EXPECT_EQ(shareDirectories(), once);
}

TEST_F(Share, PackagesOfROSAreLast) {
  const std::string before = std::getenv("ROS_PACKAGE_PATH") ? std::getenv("ROS_PACKAGE_PATH") : "";
  write("workspace/ragdoll_sim/models/far.yaml");
  setenv("ROS_PACKAGE_PATH", (":" + at("nowhere") + ":" + at("workspace")).c_str(), 1);
  EXPECT_EQ(shareDirectories().back(), at("workspace/ragdoll_sim"));
  EXPECT_EQ(findModel("far", ".", "model"), at("workspace/ragdoll_sim/models/far.yaml"));
  setenv("ROS_PACKAGE_PATH", before.c_str(), 1);
}

TEST_F(Share, ANameIsAFileOfTheFirstThatHasIt) {
  EXPECT_EQ(findScene("drop"), at("scenes/drop.yaml"));
  EXPECT_EQ(findModel("dot", "/", "model"), at("models/dot.yaml"));
  const std::string own = fs::canonical(RAGDOLL_SHARE_DIR).string();
  EXPECT_EQ(findScene("fall"), own + "/scenes/fall.yaml");
  write("scenes/fall.yaml");
  EXPECT_EQ(findScene("fall"), at("scenes/fall.yaml"));
}

TEST_F(Share, APathOfAModelIsRelativeToTheFolder) {
  write("elsewhere/rod.yaml");
  EXPECT_EQ(findModel("rod.yaml", at("elsewhere"), "model"), at("elsewhere/rod.yaml"));
  EXPECT_EQ(findModel(at("elsewhere/rod.yaml"), "/", "model"), at("elsewhere/rod.yaml"));
  EXPECT_EQ(findScene(at("scenes/notes.txt")), at("scenes/notes.txt"));  // a file, whatever it is
}

TEST_F(Share, WhatIsNotThereIsToldWithWhatIs) {
  EXPECT_THAT(errorOf([] { findScene("dorp"); }),
              AllOf(HasSubstr("'dorp'"), HasSubstr("crowd, drop, fall"), Not(HasSubstr("notes"))));
  EXPECT_THAT(errorOf([] { findScene(""); }), HasSubstr("drop"));
  EXPECT_THAT(errorOf([] { findScene("here/dorp.yaml"); }),
              AllOf(HasSubstr(fs::current_path().string()), HasSubstr("drop")));
  EXPECT_THAT(errorOf([] { findModel("tod", ".", "scene.yaml:3"); }),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("'tod'"), HasSubstr("dot, human")));
  EXPECT_THAT(errorOf([] { findModel("./tod.yaml", ".", "scene.yaml:3"); }),
              AllOf(HasSubstr("'./tod.yaml'"), HasSubstr("the scene's folder"), HasSubstr("dot")));
}

}  // namespace
}  // namespace ragdoll
