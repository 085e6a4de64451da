// ragdoll_lab falls: labelled falls with IMUs, without ROS.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <iostream>
#include <optional>

#include "arguments.h"
#include "commands.h"
#ifdef RAGDOLL_WITH_HDF5
#include "fall_file.h"
#endif
#include "fall_labels.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/falls/record.h"

namespace ragdoll::lab {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAboutFalls =
    "Draws falls from their seeds, simulates them, and writes what sensors on the body would say,\n"
    "with labels: HDF5, CSV as KFall has it, or both. docs/data.md. The same seed and options "
    "give\n"
    "the same bytes of data, whatever the number of falls and threads.\n";
constexpr std::uint64_t kChunk = 1280;  ///< falls in memory at a time: 32 of each scene, whole packs

struct Arguments {
  std::string first = "1", count = "1";
  std::string out, csv;
  bool no_positions = false, quiet = false;
  falls::Options options;
};

std::uint64_t whole(const std::string& option, const std::string& word) {
  const bool digits = !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || word.size() > 18)
    throw Error(option, "is '" + word + "'; a whole number in 0 ... " + std::to_string(falls::kLastSeed) +
                            " is expected");
  return std::stoull(word);
}

/// KFall's columns, of the sensor at the low back.
void writeCsv(const std::string& folder, const falls::Recorder& recorder, const falls::Record& record) {
  char name[32];
  std::snprintf(name, sizeof name, "fall_%08llu.csv", static_cast<unsigned long long>(record.fall.seed));
  std::ofstream out(fs::path(folder) / name);
  out << "TimeStamp(s),FrameCounter,AccX,AccY,AccZ,GyrX,GyrY,GyrZ,EulerX,EulerY,EulerZ\n";
  constexpr double kG = 9.80665, kDegrees = 180 / 3.14159265358979323846;
  const std::vector<float>& imu = record.imu[0];
  for (int k = 0; k < recorder.samples(); ++k) {
    const float *a = &imu[6 * k], *e = &record.euler[3 * k];
    char row[256];
    std::snprintf(row, sizeof row, "%.6g,%d,%.5f,%.5f,%.5f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f\n",
                  (k + 1) / recorder.options().rate, k + 1, a[0] / kG, a[1] / kG, a[2] / kG,
                  a[3] * kDegrees, a[4] * kDegrees, a[5] * kDegrees, double(e[0]), double(e[1]), double(e[2]));
    out << row;
  }
  out.close();
  if (!out) throw Error((fs::path(folder) / name).string(), "cannot be written; is the disk full?");
}

class LabelsCsv {
 public:
  explicit LabelsCsv(const std::string& folder) : path_((fs::path(folder) / "labels.csv").string()) {
    if (fs::exists(path_)) throw Error(path_, "is there already: name another folder");
    std::error_code failed;
    fs::create_directories(folder, failed);
    out_.open(path_);
    if (!out_) throw Error(path_, "cannot be written");
  }

  void write(const falls::Record& record) {
    std::string head, row;
    for (const Label& label : labelsOf(record)) {
      head += (head.empty() ? "" : ",") + std::string(label.name);
      char number[40] = "";
      if (label.type == Label::Type::kCount)
        std::snprintf(number, sizeof number, "%.0f", label.number);
      else if (std::isfinite(label.number))
        std::snprintf(number, sizeof number, "%.17g", label.number);
      row += (row.empty() ? "" : ",") +
             (label.type == Label::Type::kWord ? label.word : std::string(number));
    }
    if (first_) out_ << head << "\n";
    first_ = false;
    out_ << row << "\n";
    if (!out_.flush()) throw Error(path_, "cannot be written; is the disk full?");
  }

 private:
  std::string path_;
  std::ofstream out_;
  bool first_ = true;
};

void tellProgress(std::uint64_t done, std::uint64_t count, double seconds) {
  const double rate = done / std::max(1e-9, seconds);
  std::fprintf(stderr, "\r%llu of %llu falls, %.0f a second, %.0f s left   ",
               static_cast<unsigned long long>(done), static_cast<unsigned long long>(count), rate,
               (count - done) / std::max(1e-9, rate));
  if (done == count) std::fprintf(stderr, "\n");
}

int writeFalls(Arguments arguments) {
  const std::uint64_t first = whole("--first", arguments.first), count = whole("--count", arguments.count);
  if (count == 0) throw Error("--count", "is 0; at least 1 is expected");
  if (first > falls::kLastSeed || count - 1 > falls::kLastSeed - first)
    throw Error("--first", "the seeds " + std::to_string(first) + " ... " + std::to_string(first + count - 1) +
                               " go beyond " + std::to_string(falls::kLastSeed) + ", the last one");
  if (arguments.out.empty() && arguments.csv.empty())
    throw Error("--out", "is missing; --out FILE.h5, --csv DIR or both are expected");
  arguments.options.positions = !arguments.no_positions && !arguments.out.empty();
  arguments.options.euler = !arguments.csv.empty();
  const falls::Recorder recorder(arguments.options);
#ifdef RAGDOLL_WITH_HDF5
  std::optional<FallFile> file;
  if (!arguments.out.empty()) file.emplace(arguments.out, recorder, count);
#else
  if (!arguments.out.empty())
    throw Error("--out", "this build has no HDF5 (libhdf5-dev); --csv DIR works without");
#endif
  std::optional<LabelsCsv> labels;
  if (!arguments.csv.empty()) labels.emplace(arguments.csv);
  const auto begin = std::chrono::steady_clock::now();
  // While one chunk is written the next is simulated.
  const auto chunk = [&](std::uint64_t done) {
    return std::async(std::launch::async,
                      [&, done] { return recorder.record(first + done, std::min(kChunk, count - done)); });
  };
  auto next = chunk(0);
  for (std::uint64_t done = 0; done < count;) {
    const std::vector<falls::Record> records = next.get();
    done += records.size();
    if (done < count) next = chunk(done);
#ifdef RAGDOLL_WITH_HDF5
    if (file) file->write(records);
#endif
    for (const falls::Record& record : records) {
      if (!labels) break;
      writeCsv(arguments.csv, recorder, record);
      labels->write(record);
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    if (!arguments.quiet) tellProgress(done, count, passed.count());
  }
#ifdef RAGDOLL_WITH_HDF5
  if (file) file->finish();
#endif
  return kOk;
}

}  // namespace

int fallsCommand(const Words& words) {
  Arguments a;
  CommandLine line{"falls --first SEED --count K --out FILE.h5 [options]", kAboutFalls, {}};
  auto add = line.options.add_options();
  add("first", po::value(&a.first)->default_value("1"), "Seed of the first fall; the next ones count on");
  add("count", po::value(&a.count)->default_value("1"), "How many");
  add("out", po::value(&a.out), "HDF5 file to write; must not be there");
  add("csv", po::value(&a.csv), "Folder for a CSV file a fall, as KFall has them, and labels.csv");
  add("seconds", po::value(&a.options.seconds)->default_value(5), "Length of a record [s]");
  add("rate", po::value(&a.options.rate)->default_value(100), "Samples a second [Hz]: a whole part of the steps");
  add("model", po::value(&a.options.model)->default_value("human"), "Name or file of the body's model");
  add("threads", po::value(&a.options.threads)->default_value(1), "0: all cores");
  add("no-positions", po::bool_switch(&a.no_positions), "Leave the particles' positions out");
  add("quiet", po::bool_switch(&a.quiet), "No progress on stderr");
  add("set", po::value(&a.options.settings),
      "Change a setting, such as solver.preset=fast; may be given again.\nThe step is 1/200 s unless "
      "solver.step is given");
  return parse(line, words) ? writeFalls(a) : kOk;
}

}  // namespace ragdoll::lab
