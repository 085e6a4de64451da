// The stability matrix judges by its laws, and ragdoll_lab extremes prints what it found.
#include <gmock/gmock.h>

#include <cmath>

#include "extreme_random.h"
#include "extreme_scenes.h"
#include "extreme_text.h"
#include "extreme_verdict.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "support/error_of.h"
#include "support/lab_program.h"

namespace ragdoll::lab {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const ExtremeMethod kThesis{"jakobsen", preset("thesis"), false};
const ExtremeMethod kDefault{"shake", preset("balanced"), true};

Extreme falling() {
  Extreme e;
  e.scene = humanScene("position: [0, 0, 10]", "");
  e.seconds = 1;
  return e;
}

TEST(ExtremeVerdict, AFreeFallKeepsEveryLaw) {
  const Verdict verdict = judge(falling(), kDefault);
  EXPECT_TRUE(verdict.kept());
  EXPECT_NEAR(verdict.speed, 9.81, 1e-9);
  EXPECT_EQ(verdict.guard.guarded, 0u);
}

TEST(ExtremeVerdict, EachLawIsBrokenByWhatBreaksIt) {
  const auto broken = [](const std::function<void(Extreme&)>& change) {
    Extreme e = falling();
    change(e);
    const Verdict verdict = judge(e, kDefault);
    return verdict.broken.size() == 1 ? verdict.broken[0] : "";
  };
  EXPECT_THAT(broken([](Extreme& e) { e.laws.speed = 9.8; }), StartsWith("speed 9.81"));
  EXPECT_THAT(broken([](Extreme& e) { e.laws.rest = true; }), "no rest");
  // The feet, 0.94 m below the hips, have fallen 4.9 m.
  EXPECT_THAT(broken([](Extreme& e) { e.laws.lowest = 5; }), StartsWith("fell through 4."));
  // The second half of the fall, 3/4 of g / 2, and what was left of the first.
  EXPECT_THAT(broken([](Extreme& e) { e.laws.drift = 1; }), StartsWith("drift 3.7"));
  EXPECT_THAT(broken([](Extreme& e) {
                e.scene = humanScene("position: [0, 0, 0.5]", kFloor);
                e.laws.joined = 0;
                e.laws.energy_rise = kUnbounded;
              }),
              StartsWith("depth 0."));
}

TEST(ExtremeVerdict, AForceIsWorkAndNoRiseOfEnergy) {
  Extreme e = falling();
  e.scene = humanScene("position: [0, 0, 0]",
                       "gravity: [0, 0, 0]\npokes: [{at: 0, body: torso, force: [100, 0, 0]}]\n");
  EXPECT_TRUE(judge(e, kDefault).kept());
}

TEST(ExtremeVerdict, RelaxationStretchesUnderAHeavyEnd) {
  Extreme e;
  e.scene = chainScene({1, 1, 1, 10}, 0.1, 0);  // the guard lets it be
  e.seconds = 3;
  EXPECT_TRUE(judge(e, kDefault).kept());
  const Verdict relaxed = judge(e, kThesis);
  ASSERT_EQ(relaxed.broken.size(), 1u);
  EXPECT_THAT(relaxed.broken[0], StartsWith("sticks"));
}

TEST(ExtremeVerdict, SweepsAreTestedWhereThereAreSweeps) {
  Extreme e = falling();
  e.sweeps = 1;
  EXPECT_FALSE(judge(e, kDefault).tested);
  EXPECT_TRUE(judge(e, kThesis).tested);
}

TEST(ExtremeScenes, RandomOnesDependOnTheirSeedAlone) {
  EXPECT_EQ(randomExtreme(7).scene.text, randomExtreme(7).scene.text);
  EXPECT_NE(randomExtreme(7).scene.text, randomExtreme(8).scene.text);
  EXPECT_EQ(randomPile(7).scene.text, randomPile(7).scene.text);
  EXPECT_NE(randomPile(7).scene.text, randomPile(8).scene.text);
}

TEST(ExtremeScenes, ScalingKeepsTheShape) {
  Scene small = humanScene("position: [0, 0, 0]", "");
  const Model before = buildModel(small);
  scaleModel(small, 0.1, 2);
  const Model after = buildModel(small);
  EXPECT_LT((after.skeletons[0].rest - 0.1 * before.skeletons[0].rest).norm(), 1e-12);
  EXPECT_NEAR(after.skeletons[0].M.sum(), 2 * before.skeletons[0].M.sum(), 1e-9);
}

TEST(ExtremeText, TablesStandBetweenTheirMarks) {
  EXPECT_EQ(
      withTables("a\n<!-- extremes -->\nold\n<!-- /extremes -->\nb\n", "extremes", "new\n", "f.md"),
      "a\n<!-- extremes -->\nnew\n\n<!-- /extremes -->\nb\n");
  EXPECT_THAT(test::errorOf([] { withTables("no marks", "extremes", "new", "f.md"); }),
              AllOf(StartsWith("f.md"), HasSubstr("<!-- extremes -->")));
}

#ifdef RAGDOLL_LAB

class LabExtremes : public test::LabProgram {};

TEST_F(LabExtremes, PrintsTheMatrixAndWritesItIntoADocument) {
  const std::string document = file("doc.md", "# Head\n<!-- extremes -->\n<!-- /extremes -->\n");
  const test::Outcome outcome =
      lab("extremes --only 'at rest' --random 1 --piles 1 --seed 3 --write " + document);
  ASSERT_EQ(outcome.status, 0) << outcome.output << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("jakobsen"), HasSubstr("100 kg on 10 links"), HasSubstr("0 of 1")));
  EXPECT_THAT(test::contentOf(document), AllOf(StartsWith("# Head\n"), HasSubstr("### mass ratio"),
                                               HasSubstr("| 100 kg on 10 links")));
}

TEST_F(LabExtremes, EachRunHasItsOwnMarks) {
  const std::string matrix = "<!-- extremes -->\n| kept |\n<!-- /extremes -->\n";
  const std::string document = file("doc.md", matrix +
                                                  "<!-- random-only -->\n<!-- /random-only -->\n"
                                                  "<!-- guard-cost -->\n<!-- /guard-cost -->\n");
  ASSERT_EQ(
      lab("extremes --random-only --random 1 --piles 1 --method shake --write " + document).status,
      0);
  ASSERT_EQ(lab("extremes --guard-cost 1 --write " + document).status, 0);
  const std::string written = test::contentOf(document);
  EXPECT_THAT(written, StartsWith(matrix));
  EXPECT_THAT(written,
              HasSubstr("<!-- random-only -->\n\n### random scenes\n\n| method | scenes |"));
  EXPECT_THAT(written, HasSubstr("| shake | 1 | 0 |"));
  EXPECT_THAT(written, HasSubstr("| weightless | shake |"));
  EXPECT_THAT(written, HasSubstr("| 1:1e+06, swung | shake |"));
}

TEST_F(LabExtremes, SaysWhatIsWrongWithItsOptions) {
  for (const char* wrong :
       {"--random -1", "--piles -1", "--seed -1", "--seed 4294967000", "--guard-cost=0"}) {
    const test::Outcome outcome = lab(std::string("extremes --quick ") + wrong);
    EXPECT_EQ(outcome.status, 2) << wrong;
    EXPECT_THAT(outcome.errors, HasSubstr(std::string(wrong).substr(0, 6))) << wrong;
  }
  const test::Outcome none = lab("extremes --only nowhere --random 1");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.errors, HasSubstr("--only: no test's name contains 'nowhere'"));
  const test::Outcome outcome = lab("extremes --write " + file("doc.md", "nothing"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("doc.md: has no lines"));
  EXPECT_EQ(lab("extremes stairs").status, 2);  // takes no scene
}

#endif  // RAGDOLL_LAB

}  // namespace
}  // namespace ragdoll::lab
