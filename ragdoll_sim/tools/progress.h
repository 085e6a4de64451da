// A bar on stderr while something long runs; silent where stderr is not a terminal.
#pragma once

#include <string>

namespace ragdoll::lab {

class Progress {
 public:
  Progress();
  ~Progress();  ///< wipes the line

  /// `share` of the work done, in [0, 1]; `doing` is what is next.
  void show(double share, const std::string& doing);

 private:
  bool terminal_;
  bool shown_ = false;
};

}  // namespace ragdoll::lab
