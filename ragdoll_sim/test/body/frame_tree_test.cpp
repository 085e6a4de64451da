#include "ragdoll_sim/body/frame_tree.h"

#include <gtest/gtest.h>

#include <map>

#include "human_model.h"

namespace ragdoll::test {
namespace {

/// child -> parent by name; the world is "".
std::map<std::string, std::string> edges(const FrameTree& tree) {
  std::map<std::string, std::string> result;
  for (const FrameSpec& f : tree.frames)
    result[f.name] = f.parent < 0 ? "" : tree.frames[f.parent].name;
  return result;
}

Skeleton chain(int n) {
  Skeleton s;
  s.name = "chain";
  s.rest.resize(3, n);
  s.radius = Eigen::VectorXd::Constant(n, 0.02);
  for (int i = 0; i < n; ++i) {
    s.particles.push_back("p" + std::to_string(i));
    s.rest.col(i) = Vec3(0.1 * i, 0, 0);
    if (i) s.sticks.push_back({i - 1, i, 0.1});
  }
  s.named = static_cast<int>(s.particles.size());
  return s;
}

TEST(FrameTree, HumanHasTheAgreedTree) {
  std::map<std::string, std::string> expected = {
      {"pelvis", ""}, {"neck", "pelvis"}, {"head", "neck"}};
  for (const std::string side : {"left_", "right_"}) {
    expected[side + "hip"] = expected[side + "leg"] = "pelvis";
    expected[side + "knee"] = side + "leg";
    expected[side + "foot"] = side + "knee";
    expected[side + "shoulder"] = "neck";
    expected[side + "elbow"] = side + "shoulder";
    expected[side + "hand"] = side + "elbow";
  }
  const FrameTree tree = buildFrameTree(humanSkeleton());
  EXPECT_TRUE(tree.human);
  EXPECT_EQ(tree.frames.size(), 17u);
  EXPECT_EQ(edges(tree), expected);
}

TEST(FrameTree, HumanFramesTurnWithTheirSegments) {
  const FrameTree tree = buildFrameTree(humanSkeleton());
  const std::map<std::string, std::string> expected = {{"pelvis", "pelvis"},
                                                       {"left_hip", "pelvis"},
                                                       {"neck", "torso"},
                                                       {"head", "head"},
                                                       {"left_shoulder", "left_upper_arm"},
                                                       {"left_elbow", "left_forearm"},
                                                       {"left_hand", "left_forearm"},
                                                       {"right_leg", "right_thigh"},
                                                       {"right_knee", "right_shank"},
                                                       {"right_foot", "right_shank"}};
  for (const auto& [frame, part] : expected)
    EXPECT_EQ(tree.parts[tree.frames[tree.frame(frame)].part].name, part) << frame;
}

TEST(FrameTree, HumanNeedsNoSegmentsNorJoints) {
  Skeleton s = humanSkeleton();
  const auto with = edges(buildFrameTree(s));
  s.segments.clear();
  s.joints.clear();
  const FrameTree tree = buildFrameTree(s);
  EXPECT_EQ(edges(tree), with);
  EXPECT_GE(tree.part("right_upper_arm"), 0);
  EXPECT_GE(tree.parts[tree.part("right_thigh")].bends, 0);
}

TEST(FrameTree, ExtraParticlesOfAHumanHangOnTheirSticks) {
  Skeleton s = humanSkeleton();
  s.particles.push_back("bag");
  s.named = s.size();
  s.rest.conservativeResize(3, s.size());
  s.rest.col(s.size() - 1) = Vec3(0, -0.2, -0.4);
  s.sticks.push_back({s.particle("right_hand"), s.size() - 1, 0.3});
  const auto tree = edges(buildFrameTree(s));
  EXPECT_EQ(tree.size(), 18u);
  EXPECT_EQ(tree.at("bag"), "right_hand");
}

TEST(FrameTree, ChainIsRootedAtItsFirstParticle) {
  const FrameTree tree = buildFrameTree(chain(4));
  const std::map<std::string, std::string> expected = {
      {"p0", ""}, {"p1", "p0"}, {"p2", "p1"}, {"p3", "p2"}};
  EXPECT_EQ(edges(tree), expected);
  ASSERT_EQ(tree.parts.size(), 3u);
  const int parts[] = {0, 1, 2, 2};  // a frame turns with the bone that begins there
  for (int i = 0; i < 4; ++i) EXPECT_EQ(tree.frames[i].part, parts[i]);
  EXPECT_EQ(tree.parts[1].parent, 0);
}

TEST(FrameTree, LoopsClosePartsButNoFrames) {
  Skeleton s = chain(4);
  s.rest.col(2).y() = s.rest.col(3).y() = 0.1;
  s.sticks.push_back({0, 3, 0.1});
  const FrameTree tree = buildFrameTree(s);
  EXPECT_EQ(tree.frames.size(), 4u);
  EXPECT_EQ(tree.parts.size(), 4u);
}

TEST(FrameTree, LargestGroupIsTheRoot) {
  Skeleton s = chain(5);
  s.rest.col(1).y() = 0.1;
  s.rest.col(3).z() = 0.1;
  s.segments.push_back(segment(s, "body", {"p1", "p2", "p3", "p0"}));
  const auto tree = edges(buildFrameTree(s));
  const std::map<std::string, std::string> expected = {
      {"body", ""}, {"p0", "body"}, {"p1", "body"}, {"p2", "body"}, {"p3", "body"}, {"p4", "p3"}};
  EXPECT_EQ(tree, expected);
}

TEST(FrameTree, GroupOnALineAndLooseParticlesAreFine) {
  Skeleton s = chain(3);
  s.segments.push_back(segment(s, "rod", {"p0", "p1", "p2"}));
  s.particles.push_back("alone");
  s.named = s.size();
  s.rest.conservativeResize(3, 4);
  s.rest.col(3) = Vec3(0, 0, 1);
  const FrameTree tree = buildFrameTree(s);
  EXPECT_EQ(edges(tree).at("alone"), "");
  EXPECT_EQ(tree.frames[tree.frame("alone")].part, -1);
  for (const Part& part : tree.parts) EXPECT_FALSE(part.group);
}

TEST(FrameTree, ParentsComeFirst) {
  for (const Skeleton& s : {humanSkeleton(), chain(6)}) {
    const FrameTree tree = buildFrameTree(s);
    for (std::size_t i = 0; i < tree.frames.size(); ++i)
      EXPECT_LT(tree.frames[i].parent, static_cast<int>(i));
    for (std::size_t i = 0; i < tree.parts.size(); ++i)
      EXPECT_LT(tree.parts[i].parent, static_cast<int>(i));
  }
}

}  // namespace
}  // namespace ragdoll::test
