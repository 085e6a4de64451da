// Texts that are not scenes at all end in an Error, quickly, whatever they hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>

#include "errors_of_text.h"

namespace ragdoll {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(HostileText, EmptyOrNoMapping) {
  EXPECT_THAT(errorOfText(""), StartsWith("scene.yaml:1: the text is empty"));
  EXPECT_THAT(errorOfText("# nothing\n"), StartsWith("scene.yaml:1: the text is empty"));
  EXPECT_THAT(errorOfText("---\n"), HasSubstr("a mapping (key: value) is expected"));
  EXPECT_THAT(errorOfText("just words"), StartsWith("scene.yaml:1: is 'just words'; a mapping"));
  EXPECT_THAT(errorOfText("- a\n- b\n"), StartsWith("scene.yaml:1: is a list; a mapping"));
  EXPECT_THAT(errorOfText("[1, 2]: 3\n"), HasSubstr("a key is expected to be a name"));
}

TEST(HostileText, BrokenYaml) {
  EXPECT_THAT(errorOfText("ragdolls: [\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(errorOfText("gravity: [0, 0, 0]\n\tcoat: none\n"), StartsWith("scene.yaml:2"));
  EXPECT_THAT(errorOfText("a: *nobody\n"), HasSubstr("scene.yaml:1"));
}

// Before 0.7 yaml-cpp took all memory for some of these, and read past its last token for others.
TEST(HostileText, EndsInTheMiddle) {
  EXPECT_THAT(errorOfText("ragdolls: []\na: [b:]\n"),
              StartsWith("scene.yaml:2: ':' before ']'; a space is expected between them"));
  EXPECT_THAT(errorOfText("ragdolls: {a:"), StartsWith("scene.yaml:"));
  EXPECT_THAT(errorOfText("ragdolls: [{model:"), HasSubstr("not valid YAML: end of map"));
  EXPECT_THAT(errorOfText("ragdolls: [&a"), HasSubstr("not valid YAML: end of sequence"));
  EXPECT_THAT(errorOfText("!tag"), HasSubstr("a mapping (key: value) is expected"));
  EXPECT_THAT(errorOfText("ragdolls: [human: ]\n"), HasSubstr("ragdolls[0]"));  // valid YAML
}

TEST(HostileText, EveryTwoCharactersAtTheEnd) {
  const std::string all = "[]{}:,-?&*!|>'\"%#@ \n\t\ra~.\xff";
  for (const std::string begin : {"", "a: ", "a: [", "a: {b", "- ", "--- ", "ragdolls: [{model"}) {
    for (const char first : all) {
      for (const char second : all) {
        const std::string text = begin + first + second;
        EXPECT_THAT(errorOfText(text), StartsWith("scene.yaml:")) << text;
      }
    }
  }
}

TEST(HostileText, SeveralDocuments) {
  EXPECT_THAT(errorOfText("ragdolls: [{model: human}]\n---\nragdolls: []\n"),
              StartsWith("scene.yaml:3: a second YAML document"));
}

TEST(HostileText, Binary) {
  EXPECT_THAT(errorOfText(std::string("ragdolls:\n\0\x01\x02", 13)),
              StartsWith("scene.yaml:2: not a text file"));
}

TEST(HostileText, DeepNesting) {
  EXPECT_THAT(errorOfText("a: " + std::string(100000, '[')), StartsWith("scene.yaml:1"));
  EXPECT_THAT(errorOfText("a: " + std::string(100000, '{')), StartsWith("scene.yaml:1"));
  std::string stairs;
  for (int i = 0; i < 1000; ++i) stairs += std::string(i, ' ') + "a:\n";
  EXPECT_THAT(errorOfText(stairs), HasSubstr("nested deeper than"));
}

TEST(HostileText, AliasBomb) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 30; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last;
    for (int k = 0; k < 9; ++k) bomb += ", " + last;
    bomb += "]\n";
  }
  EXPECT_THAT(errorOfText("ragdolls: [{model: human}]\n" + bomb), HasSubstr("a0: unknown key"));
  EXPECT_THAT(errorOfText("a: &a [*a]\n"), StartsWith("scene.yaml:1: an alias inside itself"));
}

TEST(HostileText, TooLarge) {
  EXPECT_THAT(errorOfText("# " + std::string(5 << 20, 'x')), HasSubstr("larger than 4 MiB"));
  std::string many = "ragdolls: [";
  for (int i = 0; i < 600000; ++i) many += "1,";
  EXPECT_THAT(errorOfText(many + "]"), HasSubstr("more than 500000 values"));
}

TEST(HostileText, TooManyOfAKind) {
  std::string many = "ragdolls: [{model: human}]\nobstacles:\n";
  for (int i = 0; i < 10001; ++i) many += "- {type: plane}\n";
  EXPECT_THAT(errorOfText(many),
              StartsWith("scene.yaml:2: obstacles: has 10001 items; at most 10000"));
  std::string particles = "      particles:\n";
  for (int i = 0; i < 1001; ++i) {
    particles += "        p" + std::to_string(i) + ": {position: [0, 0, 0], mass: 1}\n";
  }
  EXPECT_THAT(errorOfText(sceneWithModel(particles)),
              StartsWith("scene.yaml:4: ragdolls[0].model.particles: has 1001 keys; at most 1000"));
}

std::string particles(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    text += "p" + std::to_string(i) + ": {position: [" + std::to_string(i % 10) + ", " +
            std::to_string(i / 10 % 10) + ", " + std::to_string(i / 100) + "], mass: 1}";
  }
  return "{" + text + "}";
}

TEST(HostileText, AliasesThatRepeatParts) {
  std::string many = "ragdolls:\n- {name: r, model: {particles: &p " + particles(1000) + "}}\n";
  for (int i = 0; i < 300; ++i)
    many += "- {name: r" + std::to_string(i) + ", model: {particles: *p}}\n";
  EXPECT_THAT(errorOfText(many), StartsWith("scene.yaml:202: ragdolls[200].model: makes more than "
                                            "200000 parts"));
  std::string places;
  for (int i = 0; i < 100; ++i) places += ", p" + std::to_string(i) + ": [0, 0, 0]";
  EXPECT_THAT(errorOfText("ragdolls:\n- {model: human, count: 2000, place: {x: [0, 0, 0]" + places +
                          "}}\n"),
              StartsWith("scene.yaml:2: ragdolls[0]: places more than 100000 particles"));
}

TEST(HostileText, RigidGroupOfManyPairs) {
  std::string members;
  for (int i = 0; i < 100; ++i) members += (i > 0 ? ", p" : "p") + std::to_string(i);
  EXPECT_THAT(errorOfText(sceneWithModel("      particles: " + particles(100) +
                                         "\n      segments: {all: {particles: [" + members +
                                         "], mass: 1, com: [0, 0, 0], inertia: [1, 1, 1, 0, 0, 0]}}")),
              HasSubstr("segments.all: the particles of rigid groups up to 'all' make 4950 pairs"));
}

TEST(HostileText, MatricesThatNoMachineHolds) {
  std::string scene = "ragdolls: [{name: r, count: 400, model: {particles: " + particles(300) +
                      ", sticks: [[p0, p1]";
  for (int i = 1; i < 299; ++i)
    scene += ", [p" + std::to_string(i) + ", p" + std::to_string(i + 1) + "]";
  scene += "]}}]\npins: [r_0/p0";
  for (int i = 1; i < 300; ++i) scene += ", r_" + std::to_string(i) + "/p" + std::to_string(i);
  EXPECT_THAT(errorOfText(scene + "]\n"), StartsWith("scene.yaml: ragdoll 'r_93': is too much"));
}

TEST(HostileText, LongValueIsShortenedInTheMessage) {
  const std::string error = errorOfText("coat: " + std::string(100000, 'x') + "\nragdolls: 1\n");
  EXPECT_THAT(error, HasSubstr("xxx...'"));
  EXPECT_LT(error.size(), 300u);
}

TEST(HostileText, FilesThatAreNone) {
  EXPECT_THAT(errorOf([] { loadScene("/nowhere/scene.yaml"); }), HasSubstr("no such file"));
  EXPECT_THAT(errorOf([] { loadScene("/"); }), HasSubstr("not a regular file"));
  EXPECT_THAT(errorOf([] { loadScene("/dev/zero"); }), HasSubstr("not a regular file"));
  EXPECT_THAT(errorOf([] { loadScene("stiars"); }), HasSubstr("stairs"));
  EXPECT_THAT(errorOf([] { loadScene(""); }), HasSubstr("stairs"));
}

TEST(HostileText, RandomDamageNeverCrashes) {
  const std::string good = loadScene("between_objects").text;
  std::mt19937 random(20240607);
  const std::string alphabet = "[]{},:-&*!|>'\"%@`#?~ \n\t0.eax\x80\xff";
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string text = good;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < changes; ++i) {
      const std::size_t at = random() % text.size();
      const std::size_t length = random() % 8;
      if (random() % 2) {
        text.replace(at, length, 1, alphabet[random() % alphabet.size()]);
      } else {
        text.resize(std::max<std::size_t>(1, at));
      }
    }
    refused += !errorOfText(text).empty();
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace ragdoll
