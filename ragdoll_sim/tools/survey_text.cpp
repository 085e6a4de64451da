#include "survey_text.h"

#include "format.h"
#include "quantity.h"

namespace ragdoll::lab {
namespace {

std::string knobs(const SolverSpec& solver) {
  std::string text = methodName(solver.method);
  if (solver.method == Method::kJakobsen) {
    text += format(" %d", solver.sweeps);
    if (solver.integrator != Integrator::kVerlet)
      text += std::string(" ") + integratorName(solver.integrator);
  }
  if (solver.events) text += kWithEvents;
  if (solver.tolerance > 0) text += format(" to %g", solver.tolerance);
  return text;
}

/// Where the windows start that fork, and when they do.
std::string whatForks(const Survey& survey) {
  std::string text;
  for (const Window& w : survey.reference.windows)
    if (w.forks)
      text += format("%s%.4g s (at %.4f s)", text.empty() ? "" : ", ", w.start.time, w.fork_time);
  return text;
}

}  // namespace

std::string whatError(const Survey& survey) {
  const int windows = countOf(survey.reference);
  if (survey.reference.windows.size() == 1) return format("error after %g s", survey.horizon);
  return format("error after %g s, mean over %d windows", survey.reference.window, windows);
}

std::string whatReference(const Survey& survey) {
  const Reference& r = survey.reference;
  std::string text = format("%s, step halved down to %.3g s; it is sure to %s",
                            methodName(r.method), r.finest, lengthText(r.uncertainty).c_str());
  if (r.windows.size() > 1) text += " (mean; " + lengthText(r.worst) + " in the worst window)";
  text += std::string(", ") + methodName(r.other) + " made fine ends " +
          lengthText(r.disagreement) + " away";
  return text;
}

std::string toTable(const Survey& survey, const std::string& scene) {
  std::string text =
      "scene " + scene + ", " + whatError(survey) + "\nreference: " + whatReference(survey) + "\n";
  const std::string forks = whatForks(survey);
  if (!forks.empty())
    text +=
        "windows that fork, left out of all means (starts 1e-10 m apart end 1e-5 m or more "
        "apart), from " +
        forks + "\n";
  text += "\n";
  text +=
      "* configuration                     step       cost   /thesis      error    stretch"
      "  penetration  limits     drift      rise\n";
  text +=
      "                                      [Hz]   [us/s]                  [m]"
      "                  [m]   [rad]       [J]       [J]\n";
  for (const Measurement& m : survey.rows) {
    const Configuration& c = m.configuration;
    const std::string name = c.is_preset ? c.family + " = " + knobs(c.solver) : c.family;
    text += format("%s %-28s %12.6g %10.4g %9.3g ", m.best ? "*" : " ", name.c_str(),
                   1 / c.solver.step, m.cost * 1e6, m.ratio);
    text += m.finite ? format("%s%9.3g", m.error < survey.reference.uncertainty ? "<" : " ",
                              std::max(m.error, survey.reference.uncertainty))
                     : "  diverged";
    text += format(" %10.2g %12.2g %7.2g %9.2g %9.2g\n", m.stretch, m.penetration,
                   m.limit_violation, m.energy_drift, m.energy_rise);
  }
  text += "\n*  on the Pareto front: nothing is both cheaper and more accurate\n";
  text += "<  below what the reference is sure of\n";
  text +=
      "cost: CPU time per simulated second; stretch, penetration, limits and rise (of energy, "
      "above\n"
      "start plus work): largest in one run; drift: energy gained or lost against the reference\n";
  return text;
}

std::string toCsv(const Survey& survey) {
  std::string text =
      "family,preset,method,step,sweeps,integrator,cost_s_per_s,cost_ratio_to_thesis,error_m,"
      "error_uncertainty_m,stretch,penetration_m,limit_violation_rad,energy_drift_J,energy_rise_J,"
      "finite,pareto,tolerance_m,windows,forks_at_s\n";
  std::string forks;
  for (const Window& w : survey.reference.windows)
    if (w.forks) forks += format("%s%.6f", forks.empty() ? "" : " ", w.fork_time);
  for (const Measurement& m : survey.rows) {
    const Configuration& c = m.configuration;
    const SolverSpec& s = c.solver;
    text += format("%s,%s,%s,%.17g,", c.is_preset ? "" : c.family.c_str(),
                   c.is_preset ? c.family.c_str() : "", methodName(s.method), s.step);
    text += s.method == Method::kJakobsen ? format("%d,%s,", s.sweeps, integratorName(s.integrator))
                                          : ",,";
    text += format("%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%d,%d,", m.cost, m.ratio, m.error,
                   survey.reference.uncertainty, m.stretch, m.penetration, m.limit_violation,
                   m.energy_drift, m.energy_rise, m.finite ? 1 : 0, m.best ? 1 : 0);
    if (s.tolerance > 0) text += format("%.9g", s.tolerance);
    text += format(",%d,%s\n", countOf(survey.reference), forks.c_str());
  }
  return text;
}

}  // namespace ragdoll::lab
