// Thousands of damaged scenes, models and snapshots from a seeded generator: each is refused with a
// message that names it, or taken for what it says. What the fuzzers (test/fuzz/) do for hours.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/share.h"
#include "support/hostile.h"

namespace ragdoll {
namespace {

using test::Taken;

/// Damages texts and bytes, always the same ones for the same seed.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t n) { return random_() % n; }  // the same on every library

  std::string text(std::string text) {
    for (std::size_t i = below(3) + 1; i > 0; --i) changeText(text);
    return text;
  }

  std::vector<std::uint8_t> bytes(std::vector<std::uint8_t> bytes) {
    for (std::size_t i = below(4) + 1; i > 0 && bytes.size() > 30; --i) {
      const std::size_t at = below(bytes.size());
      const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      switch (below(5)) {
        case 0:
          bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
          break;
        case 1:
          bytes[at] = static_cast<std::uint8_t>(below(2) ? 0xff : below(256));
          break;
        case 2:  // a size or a number that is nothing of the sort
          for (std::size_t k = at; k < std::min(at + 8, bytes.size()); ++k)
            bytes[k] = static_cast<std::uint8_t>(below(2) ? 0xff : 0x7f);
          break;
        case 3:
          bytes.erase(here);
          break;
        default:
          bytes.insert(here, static_cast<std::uint8_t>(below(256)));
      }
    }
    return bytes;
  }

 private:
  void changeText(std::string& text) {
    static const std::vector<std::string> words = {
        "nan", ".inf", "-1", "0", "1e9", "1e-320", "1e308", "-1e308", "1e999", "2147483648",
        "18446744073709551616", "~", "{}", "[]", "[0, 0, 0]", "true", "''", "\"\\0\"", "human",
        "*a", "&a", "!!binary x", "? ", "count: 1e9", "count: 10000", "model: fall", "\t", "\n  ",
        ": ", "- ", "#", "|", ">", "%", "@", "`", "\x80", "head", "torso", "{x: {x: {x: 0}}}"};
    if (text.empty()) text = "x";
    const std::size_t at = below(text.size());
    switch (below(6)) {
      case 0:
        text.replace(at, below(10), words[below(words.size())]);
        break;
      case 1:
        replaceWord(text, at, words[below(words.size())]);
        break;
      case 2:
        text.erase(at, below(20));
        break;
      case 3:
        text.insert(below(text.size()), text.substr(at, below(200)));
        break;
      case 4: {  // a line more, or less
        const std::size_t begin = text.rfind('\n', at) + 1;
        const std::string line = text.substr(begin, text.find('\n', at) - begin + 1);
        below(2) ? text.insert(begin, line) : text.erase(begin, line.size());
        break;
      }
      default:
        text[at] = static_cast<char>(text[at] ^ (1 << below(7)));
    }
  }

  /// A whole key or value makes way.
  static void replaceWord(std::string& text, std::size_t at, const std::string& word) {
    const char* ends = " ,:[]{}\n";
    const std::size_t begin = text.find_last_of(ends, at) + 1;
    text.replace(begin, text.find_first_of(ends, std::max(begin, at)) - begin, word);
  }

  std::mt19937 random_;
};

std::string contentOf(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Mutations, OfScenesAreRefusedByNameOrTaken) {
  const std::vector<std::string> scenes = {contentOf(findScene("between_objects")),
                                           contentOf(findScene("crowd")), loadScene("hang").text,
                                           test::snapshotScene().text};
  Mutator mutator(20250705);
  int accepted = 0;
  constexpr int kCount = 4000;
  for (int i = 0; i < kCount; ++i) {
    const std::string text = mutator.text(scenes[mutator.below(scenes.size())]);
    const Taken outcome = test::takeScene(text);
    ASSERT_EQ(outcome.broken, "") << "mutation " << i << ":\n" << text;
    accepted += outcome.accepted;
  }
  EXPECT_GT(accepted, kCount / 20);  // not all of them end at the parser
  EXPECT_LT(accepted, kCount * 19 / 20);
}

TEST(Mutations, OfModelsAreRefusedByNameOrTaken) {
  std::vector<std::string> models;
  for (const char* name : {"human", "human_lumped", "human_thesis"})
    models.push_back(contentOf(findModel(name, ".", "")));
  Mutator mutator(20250706);
  int accepted = 0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const std::string text = mutator.text(models[mutator.below(models.size())]);
    const Taken outcome = test::takeModel(text);
    ASSERT_EQ(outcome.broken, "") << "mutation " << i << ":\n" << text;
    accepted += outcome.accepted;
  }
  EXPECT_GT(accepted, kCount / 20);
  EXPECT_LT(accepted, kCount * 19 / 20);
}

TEST(Mutations, OfSnapshotsAreRefusedOrGoOn) {
  const Model model = buildModel(test::snapshotScene());
  const std::vector<std::uint8_t> good = test::snapshotAfter(model, 20);
  ASSERT_TRUE(test::takeSnapshot(model, good).accepted);
  Mutator mutator(20250707);
  int accepted = 0;
  constexpr int kCount = 4000;
  for (int i = 0; i < kCount; ++i) {
    std::vector<std::uint8_t> bytes = mutator.bytes(good);
    test::sealSnapshot(bytes);
    const Taken outcome = test::takeSnapshot(model, bytes);
    ASSERT_EQ(outcome.broken, "") << "mutation " << i;
    accepted += outcome.accepted;
  }
  EXPECT_GT(accepted, kCount / 20);
  EXPECT_LT(accepted, kCount * 19 / 20);
}

}  // namespace
}  // namespace ragdoll
