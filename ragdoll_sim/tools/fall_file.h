// HDF5 files of falls, docs/data.md#file. A file is complete or not there: it is written beside its
// name and renamed when it is closed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/falls/record.h"

namespace ragdoll::lab {

class FallFile {
 public:
  /// path: must not be there. about: what the attributes of `/` say. Throws Error.
  FallFile(const std::string& path, const falls::Recorder& recorder, std::uint64_t count);
  ~FallFile();  ///< unless finished: nothing is left
  FallFile(const FallFile&) = delete;
  FallFile& operator=(const FallFile&) = delete;

  /// In the order of their seeds. Throws Error.
  void write(const std::vector<falls::Record>& records);
  /// Writes the labels' table, closes, renames. Throws Error.
  void finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ragdoll::lab
