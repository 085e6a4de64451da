#include "ragdoll_sim/io/summary.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"

namespace ragdoll {

namespace {

nlohmann::json toJson(const TreeFinding& tree) {
  nlohmann::json entry = {{"model", tree.model}, {"pins", tree.pins}};
  if (tree.why_not.empty())
    entry["coordinates"] = tree.coordinates;
  else
    entry["why_not"] = tree.why_not;
  return entry;
}

}  // namespace

std::string toJson(const Summary& s) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(s.hash));
  const nlohmann::json guard = {{"guarded", s.guard.guarded},
                                {"implicit", s.guard.implicit},
                                {"joining", s.guard.joining},
                                {"limited", s.guard.limited},
                                {"rigid", s.guard.rigid},
                                {"unresolved", s.guard.unresolved},
                                {"max_substeps", s.guard.max_substeps},
                                {"fast_fallbacks", s.guard.fast_fallbacks},
                                {"handed_over", s.guard.handed_over},
                                {"tolerance_missed", s.guard.tolerance_missed}};
  nlohmann::json trees = nlohmann::json::array();
  for (const TreeFinding& tree : s.trees) trees.push_back(toJson(tree));
  std::vector<std::pair<std::string, nlohmann::json>> entries = {
      {"steps", s.steps},
      {"seconds", s.seconds},
      {"wall_seconds", s.wall_seconds},
      {"realtime_factor", s.wall_seconds > 0 ? s.seconds / s.wall_seconds : 0.0},
      {"max_stick_error", s.max_stick_error},
      {"max_penetration", s.max_penetration},
      {"max_limit_violation", s.max_limit_violation},
      {"start_energy_taken", s.start_energy_taken},
      {"energy_start", s.energy_start},
      {"energy_end", s.energy_end},
      {"work", s.work},
      {"max_energy_rise", s.max_energy_rise},
      {"error_estimate", s.error_estimate},
      {"guard", guard},
      {"trees", trees},
      {"asleep", s.asleep},
      {"hash", hash}};
  if (s.contact_impulse) {
    const Vec3& p = *s.contact_impulse;
    entries.insert(entries.end() - 2, {"contact_impulse", {p.x(), p.y(), p.z()}});
  }
  for (const auto& [key, values] :
       {std::pair("hic15", &s.hic15), std::pair("peak_g", &s.peak_g),
        std::pair("peak_force", &s.peak_force), std::pair("approach_energy", &s.approach_energy)}) {
    if (values->empty()) continue;
    nlohmann::json regions = nlohmann::json::object();
    for (const auto& [region, value] : *values) regions[region] = value;
    entries.insert(entries.end() - 2, {key, regions});
  }
  std::string text = "{";
  for (const auto& [key, value] : entries) {
    text += (text.size() > 1 ? ",\n  \"" : "\n  \"") + key + "\": " + value.dump();
  }
  return text + "\n}\n";
}

WatchedRun::WatchedRun(const Model& model) : model_(model) {
  summary_.trees = findTrees(model);
  state_ = startState(model, &summary_.start_energy_taken);
  inputs_.pokes = model.pokes;
  summary_.energy_start = energy();
  measure();
}

double WatchedRun::time() const { return static_cast<double>(state_.step) * model_.solver.step; }

double WatchedRun::energy() const {
  const double moving = kineticEnergy(model_, state_) + potentialEnergy(model_, state_);
  return model_.compliant ? moving + springEnergy(model_, state_) : moving;
}

void WatchedRun::step() {
  bool forced = false;
  for (const Poke& poke : inputs_.pokes) {
    if (!isActive(poke, state_.time, model_.solver.step)) continue;
    if (!forced) force_.setZero(3, state_.x.cols());
    forced = true;
    addForce(poke, state_, force_);
  }
  if (forced) before_ = state_.x;

  const auto start = std::chrono::steady_clock::now();
  const StepReport report = ragdoll::step(model_, inputs_, workspace_, state_);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;

  summary_.wall_seconds += wall.count();
  if (forced) summary_.work += force_.cwiseProduct(state_.x - before_).sum();
  summary_.guard.guarded += report.guarded > 0;
  summary_.guard.implicit += static_cast<std::uint64_t>(report.implicit);
  summary_.guard.rigid += static_cast<std::uint64_t>(report.rigid);
  summary_.guard.joining += report.joining > 0;
  summary_.guard.limited += report.limited > 0;
  summary_.guard.unresolved += report.unresolved > 0;
  summary_.guard.fast_fallbacks += static_cast<std::uint64_t>(report.fast_fallbacks);
  summary_.guard.handed_over += static_cast<std::uint64_t>(report.handed_over);
  summary_.guard.tolerance_missed += report.tolerance_missed > 0;
  summary_.error_estimate = std::max(summary_.error_estimate, report.error_estimate);
  summary_.guard.max_substeps = std::max(summary_.guard.max_substeps, report.substeps);
  measure();
}

void WatchedRun::measure() {
  Summary& s = summary_;
  s.finite = s.finite && state_.x.allFinite() && state_.v.allFinite();
  if (!s.finite) return;
  s.max_stick_error = std::max(s.max_stick_error, maxStickError(model_, state_));
  s.max_penetration = std::max(s.max_penetration, maxPenetration(model_, state_));
  s.max_limit_violation = std::max(s.max_limit_violation, maxLimitViolation(model_, state_));
  s.energy_end = energy();
  s.max_energy_rise = std::max(s.max_energy_rise, s.energy_end - (s.energy_start + s.work));
}

Summary WatchedRun::summary() const {
  Summary result = summary_;
  result.steps = state_.step;
  result.seconds = time();
  result.asleep = static_cast<int>(
      std::count_if(state_.asleep.begin(), state_.asleep.end(), [](auto a) { return a != 0; }));
  result.hash = hash(state_);
  return result;
}

}  // namespace ragdoll
