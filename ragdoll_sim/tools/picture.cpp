#include "picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace ragdoll::lab {
namespace {

/// As many as there are families: Okabe and Ito's, and others that stand apart from them.
constexpr std::array<const char*, 11> kColours = {"#e69f00", "#b05a00", "#f0c060", "#8c6d46",
                                                  "#0072b2", "#56b4e9", "#cc79a7", "#7f3f98",
                                                  "#009e73", "#d55e00", "#404040"};

/// Text in gnuplot's single quotes, without its markup.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

bool drawable(const Measurement& m) { return m.finite && m.error > 0 && m.cost > 0; }

/// A family is a curve along its steps; adaptive ones are one along their tolerances.
std::string curveOf(const Configuration& configuration) {
  const SolverSpec& solver = configuration.solver;
  if (solver.tolerance > 0)
    return methodName(solver.method) + std::string(solver.events ? kWithEvents : "") +
           " to a tolerance";
  return configuration.family;
}

std::vector<std::string> curveNames(const Survey& survey) {
  std::vector<std::string> names;
  for (const Measurement& m : survey.rows) {
    const std::string name = curveOf(m.configuration);
    if (m.configuration.is_preset || !drawable(m)) continue;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

/// A data block of cost [us], error [m] and name of the rows that `wanted` picks.
template <class Wanted>
std::string block(const std::string& name, const Survey& survey, Wanted wanted) {
  std::ostringstream out;
  out.precision(9);
  out << "$" << name << " << EOD\n";
  for (const Measurement& m : survey.rows)
    if (drawable(m) && wanted(m))
      out << m.cost * 1e6 << " " << m.error << " \"" << m.configuration.family << "\"\n";
  out << "EOD\n";
  return out.str();
}

std::string frontBlock(const Survey& survey) {
  std::vector<Measurement> front;
  for (const Measurement& m : survey.rows)
    if (m.best && drawable(m)) front.push_back(m);
  std::sort(front.begin(), front.end(),
            [](const Measurement& a, const Measurement& b) { return a.cost < b.cost; });
  std::ostringstream out;
  out.precision(9);
  out << "$front << EOD\n";
  for (const Measurement& m : front) out << m.cost * 1e6 << " " << m.error << "\n";
  out << "EOD\n";
  return out.str();
}

bool runGnuplot(const std::string& script, const std::string& file) {
  std::filesystem::remove(file);
  FILE* gnuplot = popen("gnuplot 2>/dev/null", "w");
  if (gnuplot == nullptr) return false;
  std::fwrite(script.data(), 1, script.size(), gnuplot);
  const bool well = pclose(gnuplot) == 0;
  return well && std::filesystem::exists(file) && std::filesystem::file_size(file) > 0;
}

}  // namespace

std::string plotScript(const Survey& survey, const std::string& title, const std::string& terminal,
                       const std::string& file) {
  std::ostringstream out;
  const std::vector<std::string> names = curveNames(survey);
  for (std::size_t i = 0; i < names.size(); ++i)
    out << block("curve" + std::to_string(i), survey, [&](const Measurement& m) {
      return !m.configuration.is_preset && curveOf(m.configuration) == names[i];
    });
  out << block("presets", survey, [](const Measurement& m) { return m.configuration.is_preset; })
      << frontBlock(survey);
  out << "set terminal " << terminal << " size 1000,600 font 'sans,12' background 'white'\n"
      << "set output " << quoted(file) << "\n"
      << "set title " << quoted(title) << " noenhanced\n"
      << "set logscale xy\nset format x '10^{%L}'\nset format y '10^{%L}'\n"
      << "set xlabel 'CPU time per simulated second [us]'\n"
      << "set ylabel 'error [m], RMS over particles'\n"
      << "set grid lc rgb '#dddddd'\nset key outside right center\nset "
         "border lc rgb '#444444'\n";
  out << "u = " << survey.reference.uncertainty << "\n";
  out << "plot $front using 1:2 with steps lw 8 lc rgb '#d8d8d8' title 'Pareto front'";
  for (std::size_t i = 0; i < names.size(); ++i)
    out << ", \\\n  $curve" << i << " using 1:2 with linespoints lw 1.5 pt 7 ps 0.6 lc rgb '"
        << kColours[i % kColours.size()] << "' title " << quoted(names[i]) << " noenhanced";
  if (survey.reference.uncertainty > 0)
    out << ", \\\n  u with lines dt 2 lc rgb '#888888' title 'reference is unsure below'";
  out << ", \\\n  $presets using 1:2 with points pt 5 ps 1 lc rgb 'black' title 'presets'"
      << ", \\\n  $presets using 1:2:3 with labels left offset 0.8,0.4 textcolor rgb 'black' "
         "notitle\n";
  return out.str();
}

std::string draw(const Survey& survey, const std::string& title, const std::string& base) {
  const std::string missing =
      "no picture: gnuplot is not there (Debian, Ubuntu: apt-get install gnuplot-nox)";
  if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) return missing;
  if (curveNames(survey).empty()) return "no picture: nothing has an error above zero";
  for (const auto& [terminal, ending] : {std::pair("pngcairo", ".png"), std::pair("svg", ".svg")})
    if (!runGnuplot(plotScript(survey, title, terminal, base + ending), base + ending))
      return "no picture: gnuplot could not draw " + base + ending;
  return "";
}

}  // namespace ragdoll::lab
