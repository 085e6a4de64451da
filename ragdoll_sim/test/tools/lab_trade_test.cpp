// ragdoll_lab trade and ragdoll_lab tune as a user sees them.
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/lab_program.h"

#ifdef RAGDOLL_LAB

namespace ragdoll {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kPendulum =
    "ragdolls: [{name: r, model: {particles: {a: {position: [0, 0, 0], mass: 1}, "
    "b: {position: [1, 0, 0], mass: 1}}, sticks: [[a, b]]}}]\npins: [r/a]\n";

class LabTrade : public test::LabProgram {
 protected:
  std::string pendulum() const { return file("pendulum.yaml", kPendulum); }

  std::vector<std::vector<std::string>> csv() const {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(test::contentOf(folder / "trade.csv"));
    for (std::string line; std::getline(lines, line);) {
      rows.emplace_back();
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
      if (line.back() == ',') rows.back().emplace_back();
    }
    return rows;
  }
};

TEST_F(LabTrade, WritesATableACsvAndPictures) {
  const Outcome outcome =
      lab("trade " + pendulum() + " --dearest 0.003 --out " + (folder / "new/deep").string());
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("reference: rk"), HasSubstr("jakobsen 10"),
                                    HasSubstr("thesis = jakobsen 10"), HasSubstr("\n* ")));
  EXPECT_TRUE(std::filesystem::exists(folder / "new/deep/trade.csv"));
  if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot-nox";
  EXPECT_EQ(outcome.errors, "");  // no progress bar where stderr is a file
  EXPECT_THAT(test::contentOf(folder / "new/deep/trade.png"), HasSubstr("PNG"));
  EXPECT_THAT(test::contentOf(folder / "new/deep/trade.svg"),
              AllOf(HasSubstr("<svg"), HasSubstr("jakobsen 10"), HasSubstr("thesis"),
                    HasSubstr("rk to a tolerance"), Not(HasSubstr("rk to 0.01"))));
}

TEST_F(LabTrade, CsvShowsTheOrderOfEachMethod) {
  ASSERT_EQ(lab("trade " + pendulum() + " --dearest 0.02 --out " + folder.string()).status, 0);
  const auto rows = csv();
  ASSERT_GT(rows.size(), 10u);
  EXPECT_EQ(rows[0].size(), 20u);
  double jakobsen[2] = {}, shake[2] = {};
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), rows[0].size());
    const auto is = [&](const char* family, double rate) {
      return row[0] == family && std::abs(std::stod(row[3]) * rate - 1) < 1e-9;
    };
    if (row[0].rfind("rk to ", 0) == 0) {
      EXPECT_EQ("rk to " + row[17], row[0]);
    }
    if (row[0].rfind("rk with events to ", 0) == 0) {
      EXPECT_EQ("rk with events to " + row[17], row[0]);
    }
    for (const int i : {0, 1}) {
      if (is("jakobsen 10", 960 << i)) jakobsen[i] = std::stod(row[8]);
      if (is("shake", 960 << i)) shake[i] = std::stod(row[8]);
    }
  }
  EXPECT_NEAR(jakobsen[0] / jakobsen[1], 2, 0.1);
  EXPECT_NEAR(shake[0] / shake[1], 4, 0.2);
}

/// A poke of one and a half steps of 1/30 s would be rounded to two: no error that rk controls.
TEST_F(LabTrade, StepsWithinAToleranceFitThePokes) {
  const std::string poked =
      file("poked.yaml", std::string(kPendulum) +
                             "pokes: [{at: 0, body: r/b, force: [0, 50, 0], duration: 0.05}]\n");
  ASSERT_EQ(lab("trade " + poked + " --dearest 0.02 --out " + folder.string()).status, 0);
  int seen = 0;
  for (const auto& row : csv()) {
    if (row[0].rfind("rk to ", 0) != 0 && row[0].rfind("rk with events to ", 0) != 0) continue;
    ++seen;
    EXPECT_NEAR(std::stod(row[3]) * 60, 1, 1e-9) << row[0];
    EXPECT_LT(std::stod(row[8]), std::stod(row[17])) << row[0];
  }
  EXPECT_GE(seen, 7);
}

TEST_F(LabTrade, JointDampingBelongsToTheSceneForEveryMethod) {
  // Two swinging links: without their damping each method would end elsewhere than the reference.
  const std::string chain =
      file("chain.yaml",
           "ragdolls: [{name: r, model: {particles: {a: {position: [0, 0, 0], mass: 1}, "
           "b: {position: [1, 0, 0], mass: 1}, c: {position: [1, 0, 1], mass: 1}}, "
           "sticks: [[a, b], [b, c]]}}]\npins: [r/a]\nsolver: {joint_damping: 2}\n");
  ASSERT_EQ(lab("trade " + chain + " --dearest 0.005 --out " + folder.string()).status, 0);
  double finest = 1;
  for (const auto& row : csv())
    if (row[0] == "rk" || row[0] == "shake") finest = std::min(finest, std::stod(row[8]));
  EXPECT_LT(finest, 1e-3);
  EXPECT_THAT(lab("tune " + chain + " --error 1cm --dearest 0.005").output,
              HasSubstr("joint_damping: 2"));
}

TEST_F(LabTrade, WithoutGnuplotAllButThePicturesIsThere) {
  const Outcome outcome =
      lab("trade " + pendulum() + " --dearest 0.002 --out " + folder.string(), "PATH=/nowhere");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.errors, HasSubstr("gnuplot-nox"));
  EXPECT_GT(csv().size(), 1u);
  EXPECT_FALSE(std::filesystem::exists(folder / "trade.png"));
}

TEST_F(LabTrade, TunePrintsASectionThatLoadsAndKeepsItsWord) {
  // How far below what was asked for depends on costs, which are measured.
  const Outcome outcome = lab("tune " + pendulum() + " --error 1mm --dearest 0.02");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(StartsWith("solver:\n"), HasSubstr("# error "),
                                    HasSubstr("# cost "), HasSubstr("asked for an error of 1 mm")));
  const Scene scene = parseScene(kPendulum + outcome.output);
  EXPECT_NE(scene.solver.method, Method::kJakobsen);
  EXPECT_NO_THROW(buildModel(scene));
  double error = 0;
  char unit[8] = {};
  const std::size_t at = outcome.output.find("# error ");
  ASSERT_EQ(std::sscanf(outcome.output.c_str() + at, "# error %lf %7[a-z]", &error, unit), 2);
  ASSERT_TRUE(unit == std::string("nm") || unit == std::string("um")) << outcome.output;
  EXPECT_LE(error, 1000);
}

TEST_F(LabTrade, TuneKeepsABudget) {
  const Outcome outcome = lab("tune " + pendulum() + " --budget 2ms --dearest 0.02");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("asked for a cost of 2 ms"));
  EXPECT_NO_THROW(buildModel(parseScene(kPendulum + outcome.output)));
}

TEST_F(LabTrade, WhatCannotBeMetIsStatusOneAndTheClosest) {
  for (const std::string target : {"--budget 1ns", "--error 0.000001nm"}) {
    const Outcome outcome = lab("tune " + pendulum() + " --dearest 0.002 " + target);
    EXPECT_EQ(outcome.status, 1) << target;
    EXPECT_THAT(outcome.errors, HasSubstr("cannot be met")) << target;
    EXPECT_THAT(outcome.output, HasSubstr("not met; this comes closest"));
    EXPECT_NO_THROW(buildModel(parseScene(kPendulum + outcome.output)));
  }
}

TEST_F(LabTrade, HelpSaysWhatIsMeant) {
  const Outcome trade = lab("trade --help"), tune = lab("tune --help");
  EXPECT_EQ(trade.status, 0);
  EXPECT_THAT(trade.output, AllOf(HasSubstr("--out"), HasSubstr("--horizon")));
  EXPECT_EQ(tune.status, 0);
  EXPECT_THAT(tune.output,
              AllOf(HasSubstr("--error"), HasSubstr("budget  CPU time"), HasSubstr("status 1")));
}

TEST_F(LabTrade, BadInputIsStatusTwoAndOneLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"trade", "SCENE"},
      {"trade nowhere", "stairs"},
      {"trade fall --horizon -1", "--horizon: is -1; a positive number"},
      {"trade fall --horizon 0", "--horizon: is 0; a positive number"},
      {"trade fall --horizon nan", "--horizon: is nan; a positive number"},
      {"trade fall --horizon 1e300", "--horizon: is 1e+300 s; at most 1000"},
      {"trade fall --window 0", "--window: is 0; a positive number"},
      {"trade fall --dearest 0", "--dearest: is 0; a positive number"},
      {"trade fall --window 0.3", "--window"},
      {"trade fall --out /dev/null/x", "/dev/null/x"},
      {"tune", "SCENE"},
      {"tune fall", "--error"},
      {"tune fall --error 1mm --budget 1ms", "one of"},
      {"tune fall --error 1", "1mm"},
      {"tune fall --budget 5mm", "50us"},
      {"tune fall --error 1mm --horizon 0", "--horizon: is 0; a positive number"},
      {"tune fall --error 1mm --window inf", "--window: is inf; a positive number"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Outcome outcome = lab(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.errors, AllOf(StartsWith("ragdoll_lab: "), HasSubstr(expected)));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_EQ(outcome.output, "") << arguments;
  }
}

}  // namespace
}  // namespace ragdoll

#endif  // RAGDOLL_LAB
