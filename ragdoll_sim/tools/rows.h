// Files of rows that are written while a run goes on, at ticks of its time.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll::lab {

/// A file that a row is written to now and then; without a path nothing is.
class RowFile {
 public:
  explicit RowFile(const std::string& path) : path_(path) {
    if (path_.empty()) return;
    file_.open(path_);
    if (!file_) throw Error(path_, "cannot be written");
  }
  bool wanted() const { return !path_.empty(); }
  std::ostream& out() { return file_; }
  void close() {
    if (!wanted()) return;
    file_.close();
    if (!file_) throw Error(path_, "could not be written to the end");
  }

 private:
  std::string path_;
  std::ofstream file_;
};

/// Tick k is at k / rate, and is met by the first step at or after it.
class Ticks {
 public:
  Ticks(const Model& model, double rate) : rate_(rate), slack_(kMissed * model.solver.step) {}

  /// How many ticks the step at that time [s] meets.
  int due(double time) {
    int count = 0;
    for (; static_cast<double>(tick_) / rate_ <= time + slack_; ++tick_) ++count;
    return count;
  }

 private:
  static constexpr double kMissed = 1e-9;  ///< part of a step by which a step may miss its tick

  double rate_, slack_;
  std::uint64_t tick_ = 0;
};

}  // namespace ragdoll::lab
