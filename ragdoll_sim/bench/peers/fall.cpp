#include <cmath>
#include <cstdio>

#include "comparisons.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "timing.h"

namespace ragdoll::peers {
namespace {

constexpr int kFalls = 15;
constexpr double kSeconds = 8;        ///< of a fall
constexpr double kFlight = 0.4;       ///< [s] in which nothing is touched yet
constexpr double kTimedSeconds = 2;   ///< of the fall whose cost is measured
constexpr double kImpact = 0.6;       ///< [s] from which on all touch the floor
constexpr double kStill = 0.05;       ///< [m/s] below which a body counts as at rest
constexpr double kJitterSeconds = 1;  ///< at the end
constexpr double kRise = 1e-3;        ///< [J] of energy that is worth a note
constexpr double kNothing = 1e-4;     ///< of a figure's unit: shown as 0
constexpr int kRounds = 9;
constexpr double kDegrees = 180 / M_PI;

struct Setting {
  const Engine* engine;
  int rate;  ///< [Hz]
};

/// Of one fall, the largest of all steps where nothing else is said.
struct Fall {
  double ballistic_mm = 0;  ///< centre of mass against the parabola after kFlight
  double gap_mm = 0, penetration_mm = 0, limit_deg = 0;
  double rise_J = 0;       ///< energy above its start
  double rest_s = 0;       ///< when it was last faster than kStill
  double jitter_mm_s = 0;  ///< largest speed in the last kJitterSeconds
  int resets = 0;
};

/// No damping anywhere: what is measured is the solver's.
Scene scene(int fall) {
  const double about = fall * 137.5, tilt = 10 + 5 * fall;  // degrees, all around
  Scene result = parseScene(
      "ragdolls: [{name: ragdoll, model: human, position: [0, 0, 2.2]}]\n"
      "obstacles: [{type: plane, friction: 0.5}]\n",
      "peers");
  result.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(
      tilt / kDegrees, Vec3(std::cos(about / kDegrees), std::sin(about / kDegrees), 0)));
  return result;
}

Fall run(const Setting& setting, int number) {
  const auto simulation = setting.engine->make(scene(number), 1.0 / setting.rate, true, false);
  simulation->settle();
  const double start = simulation->energy();
  const Vec3 from = simulation->centreOfMass();
  Fall fall;
  const int steps = static_cast<int>(kSeconds * setting.rate);
  for (int i = 1; i <= steps; ++i) {
    simulation->step();
    simulation->settle();
    const double time = 1.0 * i / setting.rate;
    if (i == static_cast<int>(std::lround(kFlight * setting.rate)))
      fall.ballistic_mm =
          1e3 * (simulation->centreOfMass() - from + Vec3(0, 0, 0.5 * 9.81 * time * time)).norm();
    fall.gap_mm = std::max(fall.gap_mm, 1e3 * simulation->gap());
    fall.penetration_mm = std::max(fall.penetration_mm, 1e3 * simulation->penetration());
    fall.limit_deg = std::max(fall.limit_deg, kDegrees * simulation->limitViolation());
    fall.rise_J = std::max(fall.rise_J, simulation->energy() - start);
    const double speed = simulation->speed();
    if (!(speed < kStill)) fall.rest_s = time;
    if (time > kSeconds - kJitterSeconds)
      fall.jitter_mm_s = std::max(fall.jitter_mm_s, 1e3 * speed);
  }
  fall.resets = simulation->resets();
  return fall;
}

struct Cost {
  std::vector<double> flight, contact;  ///< [s] of one step, a round each
};

/// [s] of CPU time of one step in the air and after the impact, of one fall.
void time(const Setting& setting, Cost& cost) {
  const auto simulation = setting.engine->make(scene(4), 1.0 / setting.rate, true, false);
  double flight = 0, contact = 0;
  int flying = 0, lying = 0;
  const int steps = static_cast<int>(kTimedSeconds * setting.rate);
  for (int i = 1; i <= steps; ++i) {
    const double at = 1.0 * i / setting.rate;
    const double begin = cpuTime();
    simulation->step();
    const double spent = cpuTime() - begin;
    if (at > 0.1 && at <= kFlight) flight += spent, ++flying;
    if (at > kImpact) contact += spent, ++lying;
  }
  cost.flight.push_back(flight / flying);
  cost.contact.push_back(contact / lying);
}

std::string cell(double value) { return value < kNothing ? "0" : number(value); }

/// "median / worst" of one figure.
std::string spread(const std::vector<Fall>& falls, double Fall::*figure) {
  std::vector<double> values;
  double worst = 0;
  for (const Fall& fall : falls) {
    values.push_back(fall.*figure);
    worst = std::isfinite(fall.*figure) ? std::max(worst, fall.*figure) : INFINITY;
  }
  return cell(median(values)) + " / " + cell(worst);
}

}  // namespace

void compareFall(const std::vector<Engine>& engines) {
  std::vector<Setting> settings;
  for (const Engine& engine : engines)
    for (const int rate : {60, 120, 240}) settings.push_back({&engine, rate});
  std::vector<Cost> costs(settings.size());
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t i = 0; i < settings.size(); ++i) time(settings[i], costs[i]);

  std::printf(
      "### Fall\n\n| engine | step | us / step in flight | after impact | centre of mass in flight "
      "[mm] | joint gap [mm] | penetration [mm] | limits [deg] | at rest after [s] | jitter [mm/s] "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  std::string notes;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const std::string name =
        settings[i].engine->name + " | 1/" + std::to_string(settings[i].rate) + " s";
    std::vector<Fall> falls;
    int resets = 0;
    double rise = 0;
    for (int n = 0; n < kFalls; ++n) {
      falls.push_back(run(settings[i], n));
      resets += falls.back().resets;
      rise = std::max(rise, falls.back().rise_J);
    }
    std::printf("| %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", name.c_str(),
                number(1e6 * median(costs[i].flight)).c_str(),
                number(1e6 * median(costs[i].contact)).c_str(), cell(falls[0].ballistic_mm).c_str(),
                spread(falls, &Fall::gap_mm).c_str(), spread(falls, &Fall::penetration_mm).c_str(),
                spread(falls, &Fall::limit_deg).c_str(), spread(falls, &Fall::rest_s).c_str(),
                spread(falls, &Fall::jitter_mm_s).c_str());
    std::fflush(stdout);
    if (rise > kRise || resets > 0)
      notes += name + ": energy rose by " + number(rise) + " J at most, " + std::to_string(resets) +
               " silent restarts\n";
  }
  std::printf("\n%s\n", notes.c_str());
}

}  // namespace ragdoll::peers
