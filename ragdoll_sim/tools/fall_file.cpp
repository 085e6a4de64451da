#include "fall_file.h"

#include <hdf5.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "fall_labels.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::lab {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVersion = "1";
constexpr double kSpare = 1 << 20;  ///< [bytes] left free on the disk for what HDF5 itself needs

/// HDF5 closes at the exit what could not be closed, and crashes: to be said before any other call.
const herr_t kNoExit = H5dont_atexit();

/// After a refusal nothing more is asked of it: a file that cannot be written cannot be closed.
bool broken = false;

void check(herr_t result) {
  broken = broken || result < 0;
  if (result < 0) throw Error("HDF5", "refused");
}

/// A handle of HDF5 that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    check(id < 0 ? -1 : 0);
  }
  ~Handle() {
    if (!broken) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

class Types {
 public:
  Types() : word_(H5Tcopy(H5T_C_S1), H5Tclose) { check(H5Tset_size(word_, kWordLength)); }
  hid_t of(const Label& label) const {
    return label.type == Label::Type::kWord    ? static_cast<hid_t>(word_)
           : label.type == Label::Type::kCount ? H5T_STD_U32LE
                                               : H5T_IEEE_F64LE;
  }

 private:
  Handle word_;
};

/// The label as its type has it in memory.
void pack(const Label& label, char* to) {
  if (label.type == Label::Type::kWord) {
    std::memset(to, 0, kWordLength);
    std::memcpy(to, label.word.data(), std::min(label.word.size(), kWordLength));
  } else if (label.type == Label::Type::kCount) {
    const auto count = static_cast<std::uint32_t>(label.number);
    std::memcpy(to, &count, sizeof count);
  } else {
    std::memcpy(to, &label.number, sizeof label.number);
  }
}

void addText(hid_t to, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  check(H5Tset_size(type, H5T_VARIABLE));
  check(H5Tset_cset(type, H5T_CSET_UTF8));
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(to, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* words = text.c_str();
  check(H5Awrite(attribute, type, &words));
}

void addNumber(hid_t to, const char* name, double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(to, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value));
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ",") + word;
  return all;
}

}  // namespace

class FallFile::Impl {
 public:
  Impl(std::string path, const falls::Recorder& recorder, std::uint64_t count)
      : path_(std::move(path)),
        part_(path_ + ".part" + std::to_string(getpid())),
        recorder_(recorder),
        words_(static_cast<int>(recorder.particles().size())) {
    check(kNoExit);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    if (fs::exists(path_))
      throw Error(path_, "is there already: name another file, or remove it first");
    const fs::path folder = fs::absolute(path_).parent_path();
    if (!fs::is_directory(folder)) throw Error(path_, "the folder " + folder.string() + " is not there");
    guard([&] { open(count); });
  }

  ~Impl() {
    close();
    std::error_code none;
    if (!finished_) fs::remove(part_, none);
  }

  void write(const std::vector<falls::Record>& records) {
    needRoom(static_cast<double>(records.size()));
    guard([&] {
      for (const falls::Record& record : records) add(record);
    });
  }

  void finish() {
    guard([&] {
      addTable();
      check(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    });
    guard([&] { check(close()); });
    std::error_code failed;
    fs::rename(part_, path_, failed);
    if (failed) throw Error(path_, "cannot be written: " + failed.message());
    finished_ = true;
  }

 private:
  template <class Work>
  void guard(Work work) {
    errno = 0;
    try {
      work();
    } catch (const Error&) {
      const int why = errno;
      throw Error(path_, "cannot be written: " + std::string(why != 0 ? std::strerror(why) : "HDF5 refuses") + disk());
    }
  }

  double room() const {
    struct statvfs disk;
    const fs::path folder = fs::absolute(path_).parent_path();
    if (statvfs(folder.c_str(), &disk) != 0) return 1e300;
    return static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  }

  std::string disk() const {
    char text[80];
    std::snprintf(text, sizeof text, " (%.1f MB are free on the disk of ", room() * 1e-6);
    return text + fs::absolute(path_).parent_path().string() + ")";
  }

  /// HDF5 does not survive a disk that is full: rather ask before.
  void needRoom(double falls) const {
    if (falls * bytes() + kSpare > room())
      throw Error(path_, "cannot be written: the disk is full" + disk());
  }

  /// Of a fall in the file, about.
  double bytes() const {
    const double samples = recorder_.samples();
    const double positions = recorder_.options().positions ? 12.0 * words_ : 0;
    return samples * (8 + 24.0 * falls::kSensors.size() + positions) + 8000;
  }

  void open(std::uint64_t count) {
    needRoom(1);
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST));
    file_ = H5Fcreate(part_.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access);
    check(file_ < 0 ? -1 : 0);
    const falls::Options& o = recorder_.options();
    const Handle root(H5Gopen2(file_, "/", H5P_DEFAULT), H5Gclose);
    addText(root, "version", kVersion);
    addText(root, "model", o.model);
    addText(root, "settings", joined(o.settings));
    addText(root, "particles", joined(recorder_.particles()));
    addText(root, "sensors", joined({falls::kSensors.begin(), falls::kSensors.end()}));
    addText(root, "scene", recorder_.scene());
    addNumber(root, "seconds", o.seconds);
    addNumber(root, "rate", o.rate);
    addNumber(root, "step", recorder_.step());
    const Handle create(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    check(H5Pset_est_link_info(create, static_cast<unsigned>(std::min<std::uint64_t>(count, 65535)), 8));
    const Handle group(H5Gcreate2(file_, "/falls", H5P_DEFAULT, create, H5P_DEFAULT), H5Gclose);
  }

  void addArray(hid_t group, const char* name, const std::vector<hsize_t>& size, hid_t type, hid_t memory,
                const void* data) {
    const Handle space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
    const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    check(H5Pset_obj_track_times(create, false));  // the same bytes whenever they are written
    const Handle set(H5Dcreate2(group, name, type, space, H5P_DEFAULT, create, H5P_DEFAULT), H5Dclose);
    check(H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
  }

  void add(const falls::Record& record) {
    char name[24];
    std::snprintf(name, sizeof name, "/falls/%08llu", static_cast<unsigned long long>(record.fall.seed));
    const Handle create(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    check(H5Pset_obj_track_times(create, false));
    check(H5Pset_attr_phase_change(create, 64, 32));  // attributes in the header: small and fast
    const Handle group(H5Gcreate2(file_, name, H5P_DEFAULT, create, H5P_DEFAULT), H5Gclose);
    const hsize_t samples = static_cast<hsize_t>(recorder_.samples());
    if (time_.empty())
      for (hsize_t k = 0; k < samples; ++k)
        time_.push_back(static_cast<double>(k + 1) / recorder_.options().rate);
    addArray(group, "time", {samples}, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, time_.data());
    {
      const Handle imu(H5Gcreate2(group, "imu", H5P_DEFAULT, create, H5P_DEFAULT), H5Gclose);
      for (std::size_t s = 0; s < falls::kSensors.size(); ++s)
        addArray(imu, falls::kSensors[s], {samples, 6}, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT,
                 record.imu[s].data());
    }
    if (recorder_.options().positions)
      addArray(group, "positions", {samples, static_cast<hsize_t>(words_), 3}, H5T_IEEE_F32LE,
               H5T_NATIVE_FLOAT, record.positions.data());
    addLabels(group, labelsOf(record));
  }

  /// As attributes, and as a row of the table.
  void addLabels(hid_t group, const std::vector<Label>& labels) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    if (columns_.empty()) columns_ = labels;
    for (const Label& label : labels) {
      char value[kWordLength];
      pack(label, value);
      const Handle attribute(
          H5Acreate2(group, label.name, types_.of(label), space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
      check(H5Awrite(attribute, types_.of(label), value));
      const std::size_t size = H5Tget_size(types_.of(label));
      rows_.insert(rows_.end(), value, value + size);
    }
    ++row_count_;
  }

  void addTable() {
    std::size_t size = 0;
    for (const Label& label : columns_) size += H5Tget_size(types_.of(label));
    const Handle type(H5Tcreate(H5T_COMPOUND, size), H5Tclose);
    size = 0;
    for (const Label& label : columns_) {
      check(H5Tinsert(type, label.name, size, types_.of(label)));
      size += H5Tget_size(types_.of(label));
    }
    addArray(file_, "labels", {row_count_}, type, type, rows_.data());
  }

  herr_t close() {
    if (file_ < 0 || broken) return 0;
    const herr_t result = H5Fclose(file_);
    file_ = -1;
    return result;
  }

  std::string path_, part_;
  const falls::Recorder& recorder_;
  int words_;
  hid_t file_ = -1;
  Types types_;
  std::vector<double> time_;
  std::vector<Label> columns_;
  std::vector<char> rows_;
  hsize_t row_count_ = 0;
  bool finished_ = false;
};

FallFile::FallFile(const std::string& path, const falls::Recorder& recorder, std::uint64_t count)
    : impl_(std::make_unique<Impl>(path, recorder, count)) {}
FallFile::~FallFile() = default;
void FallFile::write(const std::vector<falls::Record>& records) { impl_->write(records); }
void FallFile::finish() { impl_->finish(); }

}  // namespace ragdoll::lab
