#include "tuning.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "other_start.h"
#include "quantity.h"
#include "ragdoll_sim/core/build_model.h"
#include "survey_text.h"

namespace ragdoll::lab {
namespace {

constexpr int kBisections = 3;   ///< of a factor of two in the step: to within 9 %
constexpr double kExpected = 3;  ///< times the largest error measured

double wrongness(const Target& target, const Measurement& m) {
  if (!m.finite) return INFINITY;
  return target.error > 0 ? m.expected / target.error : m.cost / target.budget;
}

bool meets(const Target& target, const Measurement& m) { return wrongness(target, m) <= 1; }

/// What is worth most among those that meet the target.
double price(const Target& target, const Measurement& m) {
  return target.error > 0 ? m.cost : m.expected;
}

/// Best first: those that meet the target by price, then the others by how far they are off it.
/// Within a family a longer step is the cheaper one: that is known better than times can be
/// measured.
bool better(const Target& target, const Measurement& a, const Measurement& b) {
  if (meets(target, a) != meets(target, b)) return meets(target, a);
  if (meets(target, a)) {
    if (target.error > 0 && a.configuration.family == b.configuration.family)
      return a.configuration.solver.step > b.configuration.solver.step;
    return price(target, a) < price(target, b);
  }
  return wrongness(target, a) < wrongness(target, b);
}

class Tuner {
 public:
  Tuner(const Model& model, const Target& target, const SurveyOptions& options,
        const Reference& reference, const std::vector<OtherStart>& others)
      : model_(model), target_(target), options_(options), reference_(reference), others_(others) {}

  /// What is to be expected; in_any_case: else the other starts are left out of what does not meet
  /// the target without them.
  void measureOthers(Measurement& m, bool in_any_case = false) const {
    const double times = others_.empty() ? 1 : kExpected;
    m.others = 0;
    m.expected = times * m.error;
    for (const OtherStart& other : others_) {
      if (!in_any_case && !meets(target_, m)) return;
      m.others = std::max({m.others, other.reference.uncertainty,
                           errorAgainst(other.model, m.configuration.solver, other.reference)});
      m.expected = times * std::max(m.error, m.others);
    }
  }

  /// The families' neighbours on the grid between which the target is crossed, refined.
  void refine(std::vector<Measurement>& rows, Progress& progress) const {
    const std::vector<Measurement> grid = rows;
    for (std::size_t i = 0; i + 1 < grid.size(); ++i) {
      const Measurement &coarse = grid[i], &fine = grid[i + 1];
      if (coarse.configuration.family != fine.configuration.family) continue;
      if (meets(target_, coarse) == meets(target_, fine)) continue;
      if (!mayWin(coarse, fine, rows)) continue;
      progress.show(static_cast<double>(i) / static_cast<double>(grid.size()), "refining");
      bisect(coarse, fine, rows);
    }
  }

 private:
  int stepsOf(const Measurement& m) const {
    return stepsIn(options_.window, m.configuration.solver.step);
  }

  Measurement measure(Configuration configuration, int steps) const {
    configuration.solver.step = options_.window / steps;
    Measurement m = measureAccuracy(model_, configuration, reference_, options_.horizon);
    measureCost(model_, options_.horizon, m);
    measureOthers(m);
    return m;
  }

  /// Could a step between the two beat the best so far? Halfway cost is no less than the coarse
  /// step's, halfway error no less than the fine step's.
  bool mayWin(const Measurement& coarse, const Measurement& fine,
              const std::vector<Measurement>& rows) const {
    for (const Measurement& m : rows) {
      if (!meets(target_, m)) continue;
      const double bound = target_.error > 0 ? coarse.cost : fine.error;
      if (price(target_, m) < bound) return false;
    }
    return true;
  }

  void bisect(const Measurement& coarse, const Measurement& fine,
              std::vector<Measurement>& rows) const {
    int low = stepsOf(coarse), high = stepsOf(fine);
    const bool fine_meets = meets(target_, fine);
    for (int i = 0; i < kBisections && high - low > 1; ++i) {
      const int middle = static_cast<int>(std::lround(std::sqrt(1.0 * low * high)));
      const Measurement m = measure(coarse.configuration, std::clamp(middle, low + 1, high - 1));
      rows.push_back(m);
      (meets(target_, m) == fine_meets ? high : low) = stepsOf(m);
    }
  }

  const Model& model_;
  const Target& target_;
  const SurveyOptions& options_;
  const Reference& reference_;
  const std::vector<OtherStart>& others_;
};

std::string number(const char* pattern, double value) {
  char text[80];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// [m] What is said of any start.
double promiseOf(const Choice& choice, const Target& target) {
  return choice.met && target.error > 0 ? target.error : choice.measurement.expected;
}

/// Of the error that is asked for: how sure the other starts' references are.
constexpr double kReferenceShareOfError = 0.01;
constexpr double kAgreementForBudget = 1e-6;  ///< [m] where no error is asked for

}  // namespace

std::vector<OtherStart> otherStarts(const Scene& scene, int count, const Target& target,
                                    const SurveyOptions& options, Progress& progress) {
  const double agreement =
      target.error > 0 ? kReferenceShareOfError * target.error : kAgreementForBudget;
  std::vector<OtherStart> starts;
  for (int i = 0; i < count; ++i) {
    Model model = buildModel(withOtherStart(scene, static_cast<unsigned>(i + 1)));
    Reference reference = makeReference(
        model, options.horizon, options.window,
        [&](double share) { progress.show((i + share) / count, "other starts"); }, agreement);
    starts.push_back({std::move(model), std::move(reference)});
  }
  return starts;
}

Choice tune(const Model& model, const Target& target, const SurveyOptions& options,
            const std::vector<OtherStart>& others, Progress& progress) {
  SurveyOptions without_presets = options;
  without_presets.presets = false;
  Survey all = survey(model, without_presets, progress);
  const Tuner tuner(model, target, options, all.reference, others);
  for (Measurement& m : all.rows) tuner.measureOthers(m);
  tuner.refine(all.rows, progress);
  Choice choice;
  choice.others = static_cast<int>(others.size());
  // Families first, then the best of each: "better" is no order across three of two families.
  std::map<std::string, Measurement> best;
  for (const Measurement& m : all.rows) {
    const auto [known, is_new] = best.emplace(m.configuration.family, m);
    if (!is_new && better(target, m, known->second)) known->second = m;
  }
  choice.measurement =
      std::min_element(best.begin(), best.end(), [&](const auto& a, const auto& b) {
        return better(target, a.second, b.second);
      })->second;
  tuner.measureOthers(choice.measurement, true);
  choice.horizon = options.horizon;
  choice.reference = std::move(all.reference);
  // What the reference cannot tell apart is not met.
  choice.met = meets(target, choice.measurement) &&
               (target.error == 0 || choice.reference.uncertainty <= target.error);
  return choice;
}

std::string toText(const Choice& choice, const Target& target, const std::string& scene) {
  const Measurement& m = choice.measurement;
  const Reference& reference = choice.reference;
  const bool windows = reference.windows.size() > 1;
  std::string text;
  if (!choice.met) text += "# The target is not met; this comes closest.\n";
  text += toSection(m.configuration.solver);
  text += "  # Measured on scene " + scene + " by ragdoll_lab tune, asked for ";
  text += target.error > 0 ? "an error of " + lengthText(target.error)
                           : "a cost of " + timeText(target.budget) + " per simulated second";
  text += ":\n  # error " + lengthText(std::max(m.error, reference.uncertainty)) +
          ", RMS over particles after " + number("%g s", reference.window) +
          (windows ? ", mean over windows" : "") + "; the reference is sure to " +
          lengthText(reference.uncertainty) + "\n";
  if (m.others > 0)
    text += "  # from " + std::to_string(choice.others) + " other starts at most " +
            lengthText(m.others) + "; below " + lengthText(promiseOf(choice, target)) +
            " is expected from any\n";
  text += "  # cost " + timeText(m.cost) + " of CPU time per simulated second, " +
          number("%.3g", m.ratio) + " of preset thesis\n";
  text += "  # largest stretch " + number("%.2g", m.stretch) + ", penetration " +
          number("%.2g m", m.penetration) + ", limit violation " +
          number("%.2g rad", m.limit_violation) + ", rise of energy " +
          number("%.2g J", m.energy_rise) + "\n";
  return text;
}

}  // namespace ragdoll::lab
