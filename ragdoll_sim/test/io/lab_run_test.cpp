// The program ragdoll_lab as another program sees it: output, exit status, messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "support/lab_program.h"

#ifdef RAGDOLL_LAB

namespace ragdoll {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using test::Outcome;

class LabRun : public test::LabProgram {
 protected:
  std::string csv() const { return (folder / "run.csv").string(); }

  std::vector<std::vector<std::string>> rows() const {
    std::vector<std::vector<std::string>> result;
    std::ifstream file(csv());
    for (std::string line; std::getline(file, line);) {
      result.emplace_back();
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) result.back().push_back(cell);
    }
    return result;
  }
};

TEST_F(LabRun, CsvHasARowPerTickAndAColumnPerCoordinate) {
  ASSERT_EQ(lab("run fall --seconds 0.5 --csv " + csv()).status, 0);
  const auto table = rows();
  ASSERT_EQ(table.size(), 1 + 31u);  // header, ticks 0 ... 30
  for (const auto& row : table) EXPECT_EQ(row.size(), 2 + 3 * 16u);
  EXPECT_EQ(table[0][0], "step");
  EXPECT_EQ(table[0][1], "time");
  EXPECT_EQ(table[0][2], "head.x");
  EXPECT_EQ(table[0][4], "head.z");
  EXPECT_EQ(table[1][0], "0");
  EXPECT_EQ(table[1][1], "0");
  for (std::size_t i = 1; i < table.size(); ++i) {
    EXPECT_NEAR(std::stod(table[i][1]), static_cast<double>(i - 1) / 60, 1e-12);
  }
}

TEST_F(LabRun, RowIsTheFirstStepAtOrAfterItsTick) {
  ASSERT_EQ(
      lab("run weightless --seconds 0.1 --rate 60 --set solver.step=0.01 --csv " + csv()).status,
      0);
  std::vector<std::string> steps;
  for (const auto& row : rows()) steps.push_back(row[0]);
  // Ticks at 0, 16.7, 33.3, 50, 66.7, 83.3 and 100 ms.
  EXPECT_THAT(steps, ElementsAre("step", "0", "2", "4", "5", "7", "9", "10"));
}

TEST_F(LabRun, CsvFollowsFreeFallToTheLastDigits) {
  std::ofstream(folder / "dot.yaml")
      << "ragdolls:\n  - position: [0, 0, 10]\n    model: {particles: "
         "{p: {position: [0, 0, 0], mass: 2}}}\n";
  ASSERT_EQ(lab("run " + (folder / "dot.yaml").string() +
                " --seconds 1 --set solver.step=0.01 --rate 100 --csv " + csv())
                .status,
            0);
  const auto table = rows();
  ASSERT_EQ(table.size(), 102u);
  const auto& last = table.back();
  ASSERT_EQ(last.size(), 5u);
  EXPECT_NEAR(std::stod(last[4]), 10 - 9.81 / 2, 9.81 * 0.01);  // any first-order scheme
  const double third = std::stod(table[4][4]);
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.17g", third);
  EXPECT_EQ(table[4][4], digits);
}

TEST_F(LabRun, LaterRagdollsArePrefixed) {
  ASSERT_EQ(lab("run two --seconds 0 --csv " + csv()).status, 0);
  const auto table = rows();
  ASSERT_EQ(table.size(), 2u);
  ASSERT_EQ(table[0].size(), 2 + 2 * 48u);
  EXPECT_EQ(table[0][2], "head.x");
  EXPECT_EQ(table[0][2 + 48], "ben/head.x");
}

TEST_F(LabRun, ContactsAddUpToTheWeight) {
  // Over the last tick of a body that lies still: the mean force is its weight.
  ASSERT_EQ(lab("run fall --seconds 8 --rate 2 --contacts " + csv()).status, 0);
  const auto table = rows();
  ASSERT_GT(table.size(), 10u);
  EXPECT_EQ(table[0].size(), 17u);
  EXPECT_EQ(table[0][3], "other");
  double force = 0;
  for (const auto& row : table) {
    ASSERT_EQ(row.size(), 17u);
    if (row[0] != "8") continue;
    EXPECT_EQ(row[1], "ragdoll");
    EXPECT_EQ(row[3], "plane_0");
    force += std::stod(row[13]);
  }
  EXPECT_NEAR(force, 75 * 9.81, 1e-4 * 75 * 9.81);
}

TEST_F(LabRun, ImuHasARowPerSample) {
  const std::string scene = (folder / "sensed.yaml").string();
  std::ofstream(scene) << "ragdolls: [{model: human, position: [0, 0, 5]}]\n"
                          "sensors: [{name: back, type: imu, segment: torso, rate: 40}]\n";
  ASSERT_EQ(lab("run " + scene + " --seconds 0.5 --imu " + csv()).status, 0);
  const auto table = rows();
  ASSERT_EQ(table.size(), 1 + 20u);
  EXPECT_EQ(table[0].size(), 12u);
  EXPECT_EQ(table[1][1], "ragdoll/back");
  EXPECT_NEAR(std::stod(table[20][0]), 0.5, 1e-12);
  for (std::size_t i = 1; i < table.size(); ++i)
    for (int axis = 2; axis < 8; ++axis) EXPECT_NEAR(std::stod(table[i][axis]), 0, 1e-9);
  const Outcome none = lab("run fall --imu " + csv());
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.errors, HasSubstr("--imu: the scene has no sensors"));
}

TEST_F(LabRun, SummaryHasItsKeysAndTellsTheTruth) {
  const Outcome outcome = lab("run fall --seconds 1 --summary");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const auto summary = nlohmann::json::parse(outcome.output);
  std::set<std::string> keys;
  for (const auto& item : summary.items()) keys.insert(item.key());
  const std::set<std::string> expected = {"steps",
                                          "seconds",
                                          "wall_seconds",
                                          "realtime_factor",
                                          "max_stick_error",
                                          "max_penetration",
                                          "max_limit_violation",
                                          "start_energy_taken",
                                          "error_estimate",
                                          "energy_start",
                                          "energy_end",
                                          "work",
                                          "max_energy_rise",
                                          "guard",
                                          "contact_impulse",
                                          "hic15",
                                          "peak_g",
                                          "peak_force",
                                          "approach_energy",
                                          "asleep",
                                          "trees",
                                          "hash"};
  EXPECT_EQ(keys, expected);
  EXPECT_NEAR(summary["seconds"].get<double>(), 1, 0.02);
  EXPECT_GT(summary["wall_seconds"].get<double>(), 0);
  EXPECT_NEAR(summary["realtime_factor"].get<double>(),
              summary["seconds"].get<double>() / summary["wall_seconds"].get<double>(), 1e-9);
  EXPECT_LT(summary["energy_end"].get<double>(), summary["energy_start"].get<double>());
  EXPECT_EQ(summary["work"], 0.0);
  EXPECT_EQ(summary["hash"].get<std::string>().size(), 16u);
}

TEST_F(LabRun, SaysWhichPairsSelfCollisionLeavesOut) {
  const Outcome outcome = lab("run fall --seconds 0 --set self_collision=true --summary");
  ASSERT_EQ(outcome.status, 0);
  EXPECT_NO_THROW(nlohmann::json::parse(outcome.output));
  EXPECT_THAT(outcome.errors, HasSubstr("ragdoll_lab: self collision of 'human': 159 pairs"));
  EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("(--pairs lists them)"));
  const Outcome listed = lab("run fall --seconds 0 --set self_collision=true --pairs");
  EXPECT_THAT(listed.errors, HasSubstr("left_shoulder-right_shoulder with neck-head"));
  EXPECT_EQ(lab("run fall --seconds 0").errors, "");
}

TEST_F(LabRun, WorkIsForceTimesWay) {
  // One free particle of 2 kg, 10 N for 1 s without gravity: v = 5 m/s, work = 25 J = its energy.
  std::ofstream(folder / "dot.yaml") << "gravity: [0, 0, 0]\nragdolls: [{model: {particles: {p: "
                                        "{position: [0, 0, 0], mass: 2}}}}]\n"
                                        "pokes: [{body: p, force: [10, 0, 0], duration: 1}]\n";
  const Outcome outcome = lab("run " + (folder / "dot.yaml").string() +
                              " --seconds 2 --set solver.step=0.001 --summary");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const auto summary = nlohmann::json::parse(outcome.output);
  EXPECT_NEAR(summary["work"].get<double>(), 25, 0.05);
  EXPECT_NEAR(summary["energy_end"].get<double>(), 25, 0.05);
  EXPECT_LT(summary["max_energy_rise"].get<double>(), 0.05);
}

TEST_F(LabRun, SameRunSameHash) {
  const auto hash = [&](const std::string& arguments) {
    return nlohmann::json::parse(lab("run " + arguments + " --summary").output)["hash"]
        .get<std::string>();
  };
  EXPECT_EQ(hash("stairs --seconds 3"), hash("stairs --seconds 3"));
  EXPECT_NE(hash("stairs --seconds 3"), hash("stairs --seconds 3 --set solver.step=0.01"));
}

TEST_F(LabRun, HelpEverywhere) {
  const Outcome program = lab("--help"), command = lab("run --help");
  EXPECT_EQ(program.status, 0);
  EXPECT_THAT(program.output, HasSubstr("run"));
  EXPECT_EQ(command.status, 0);
  EXPECT_THAT(command.output, AllOf(HasSubstr("--csv"), HasSubstr("--set")));
}

TEST_F(LabRun, BadInputEndsWithStatusTwoAndOneLine) {
  std::ofstream(folder / "bad.yaml") << "ragdolls:\n  - {model: human, postion: [0, 0, 1]}\n";
  const std::string bad = (folder / "bad.yaml").string();
  std::ofstream(folder / "sensor.yaml")
      << "ragdolls: [{model: human}]\nsensors:\n  - {name: head, type: imu, segment: head}\n";
  const std::string sensor = (folder / "sensor.yaml").string();
  std::ofstream(folder / "own.yaml")
      << "ragdolls: [{model: human}]\nobstacles:\n  - {type: plane, frame: ragdoll/head}\n";
  const std::string own = (folder / "own.yaml").string();
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"run " + own, "'ragdoll/head' is one of the ragdolls' own"},
      {"", "subcommand"},
      {"walk", "walk"},
      {"run", "scene"},
      {"run nowhere", "stairs"},
      {"run " + bad, bad + ":2: ragdolls[0].postion: unknown key"},
      {"run fall --imu /tmp/imu.csv", "--imu: the scene has no sensors"},
      {"run fall --contacts /nowhere/run.csv", "/nowhere/run.csv"},
      {"run fall --set solver.step", "key=value"},
      {"run fall --set solver.step=no", "solver.step"},
      {"run fall --seconds -1", "--seconds"},
      {"run fall --seconds nan", "--seconds"},
      {"run fall --seconds soon", "--seconds"},
      {"run fall --rate 0", "--rate"},
      {"run fall --rate 1e300 --seconds 0", "--rate"},
      {"run fall --seconds 1e300", "1e12 steps"},
      {"run fall --csv /nowhere/run.csv", "/nowhere/run.csv"},
      {"run fall --csv /tmp/a.csv --imu /tmp/a.csv",
       "--imu: is /tmp/a.csv, as --csv is; it must be another file"},
      {"run fall --contacts /tmp/a.csv --csv /tmp/../tmp/a.csv", "as --csv is"},
      {"run fall --fast", "--fast"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Outcome outcome = lab(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.errors, AllOf(StartsWith("ragdoll_lab: "), HasSubstr(expected)))
        << arguments;
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_EQ(outcome.output, "") << arguments;
  }
  // After what loading warns of: that the bone has no twist.
  const Outcome outcome = lab("run " + sensor);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.errors, HasSubstr(sensor + ":3: sensors[0].name: 'ragdoll/head' is a frame"));
}

}  // namespace
}  // namespace ragdoll

#endif  // RAGDOLL_LAB
