#include "extreme_text.h"

#include <algorithm>
#include <map>

#include "format.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::lab {
namespace {

constexpr std::size_t kNamedSeeds = 10;  ///< of scenes that break a law

/// "ok", "-", or the laws that were broken.
std::string cell(const Verdict& verdict) {
  if (!verdict.tested) return "-";
  if (verdict.kept()) return "ok";
  std::string text;
  for (const std::string& law : verdict.broken) text += (text.empty() ? "" : ", ") + law;
  return text;
}

const Verdict* defaultOf(const Matrix& matrix, const MatrixRow& row) {
  for (std::size_t m = 0; m < matrix.methods.size(); ++m)
    if (matrix.methods[m].is_default) return &row.verdicts[m];
  return nullptr;
}

/// How the step guard acted, for one cell.
std::string guardText(const GuardCounts& guard) {
  if (guard.guarded + guard.limited + guard.unresolved == 0) return "no";
  std::string text = format("%llu steps", static_cast<unsigned long long>(guard.guarded));
  if (guard.max_substeps > 1) text += format(", %d substeps", guard.max_substeps);
  if (guard.implicit > 0)
    text += format(", %llu implicit", static_cast<unsigned long long>(guard.implicit));
  if (guard.rigid > 0) text += format(", %llu rigid", static_cast<unsigned long long>(guard.rigid));
  if (guard.joining > 0)
    text += format(", %llu joining", static_cast<unsigned long long>(guard.joining));
  if (guard.limited > 0)
    text += format(", %llu limited", static_cast<unsigned long long>(guard.limited));
  if (guard.unresolved > 0)
    text += format(", %llu unresolved", static_cast<unsigned long long>(guard.unresolved));
  return text;
}

/// "sticks" of "sticks 0.3": how often each law was broken.
std::string lawCounts(const RandomTally& tally) {
  std::map<std::string, int> counts;
  for (const std::string& law : tally.laws) ++counts[law.substr(0, law.rfind(' '))];
  std::string text;
  for (const auto& [law, count] : counts)
    text += (text.empty() ? "" : ", ") + law + format(" %d", count);
  return text;
}

}  // namespace

std::string toTable(const Matrix& matrix) {
  std::string text = format("%-52s", "test");
  for (const ExtremeMethod& m : matrix.methods) text += format(" %-30s", m.name.c_str());
  text += "  of the default: stretch     rise    depth  rest   us/step  guard\n";
  std::string group;
  for (const MatrixRow& row : matrix.rows) {
    if (row.test.group != group) text += "\n" + (group = row.test.group) + "\n";
    text += format("  %-50s", row.test.name.c_str());
    for (const Verdict& v : row.verdicts) text += format(" %-30s", cell(v).c_str());
    if (const Verdict* v = defaultOf(matrix, row); v && v->tested)
      text += format("                  %8.1e %8.1e %8.1e %5.1f %9.1f  %s", v->stick_error,
                     v->energy_rise, v->depth, v->rest, 1e6 * v->step_time,
                     guardText(v->guard).c_str());
    text += "\n";
  }
  for (const RandomGroup& random : matrix.random) {
    if (random.scenes == 0) continue;
    text += "\n" + random.name + "\n";
    for (std::size_t m = 0; m < matrix.methods.size(); ++m) {
      const RandomTally& t = random.tallies[m];
      const std::string laws = t.broken.empty() ? "" : " (" + lawCounts(t) + ")";
      text +=
          format("  %-10s %zu of %d break a law%s; worst: stretch %.1e, rise %.1e, depth %.1e m",
                 matrix.methods[m].name.c_str(), t.broken.size(), t.scenes, laws.c_str(),
                 t.worst.stick_error, t.worst.energy_rise, t.worst.depth);
      for (std::size_t i = 0; i < std::min<std::size_t>(t.broken.size(), kNamedSeeds); ++i)
        text += format("%s%u", i == 0 ? "; seeds " : ", ", t.broken[i]);
      text += t.broken.size() > kNamedSeeds ? ", ...\n" : "\n";
    }
  }
  return text;
}

std::string toMarkdown(const Matrix& matrix) {
  std::string text, group;
  for (const MatrixRow& row : matrix.rows) {
    if (row.test.group != group) {
      group = row.test.group;
      text += "\n### " + group + "\n\n| test |";
      for (const ExtremeMethod& m : matrix.methods) text += " " + m.name + " |";
      text += " stretch | energy rise | depth m | at rest after s | guard |\n|---|";
      for (std::size_t m = 0; m < matrix.methods.size(); ++m) text += "---|";
      text += "---|---|---|---|---|\n";
    }
    text += "| " + row.test.name + " |";
    for (const Verdict& v : row.verdicts) text += " " + cell(v) + " |";
    const Verdict* v = defaultOf(matrix, row);
    if (v && v->tested) {
      text += format(" %.1e | %.1e | %.1e |", v->stick_error, v->energy_rise, v->depth);
      text += row.test.laws.rest && v->rest >= 0 ? format(" %.1f |", v->rest) : " |";
      text += " " + guardText(v->guard) + " |\n";
    } else {
      text += " | | | | |\n";
    }
  }
  for (const RandomGroup& random : matrix.random) {
    if (random.scenes == 0) continue;
    text +=
        "\n### " + random.name +
        "\n\n| method | scenes | that break a law | laws | worst stretch | energy rise | depth m "
        "|\n|---|---|---|---|---|---|---|\n";
    for (std::size_t m = 0; m < matrix.methods.size(); ++m) {
      const RandomTally& t = random.tallies[m];
      text += format("| %s | %d | %zu | %s | %.1e | %.1e | %.1e |\n",
                     matrix.methods[m].name.c_str(), t.scenes, t.broken.size(),
                     lawCounts(t).c_str(), t.worst.stick_error, t.worst.energy_rise, t.worst.depth);
    }
  }
  return text;
}

std::string withTables(const std::string& document, const std::string& mark,
                       const std::string& tables, const std::string& path) {
  const std::string open = "<!-- " + mark + " -->", close = "<!-- /" + mark + " -->";
  const std::size_t begin = document.find(open + "\n"), end = document.find(close + "\n");
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw Error(path, "has no lines " + open + " and " + close + ", one after the other");
  return document.substr(0, begin) + open + "\n" + tables + "\n" + document.substr(end);
}

}  // namespace ragdoll::lab
