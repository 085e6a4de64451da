// How fast a simulation is: simulated per clock time, measured now and then.
#pragma once

namespace ragdoll {

class Pace {
 public:
  static constexpr double kLongest = 5;  ///< [s] without an advance: then it stands

  /// Of the period that ends: simulated and clock time [s]. leaps: it follows a clock that may tick
  /// seldom, so that a period without an advance counts with the one in which it comes.
  double after(double simulated, double seconds, bool leaps) {
    waited_ += seconds;
    if (leaps && simulated == 0 && waited_ < kLongest) return pace_;
    pace_ = simulated / waited_;
    waited_ = 0;
    return pace_;
  }

 private:
  double pace_ = 0;
  double waited_ = 0;  ///< [s] since it was measured
};

}  // namespace ragdoll
