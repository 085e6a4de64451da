// One body's limits at the few poses that a step looks at: values, and gradients where they are
// asked for, each worked out once per pose.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

class LimitAngles {
 public:
  /// A ragdoll's limits at one pose.
  class Pose {
   public:
    /// [rad] C of a limit of the skeleton.
    double operator[](int limit) const { return value_[limit]; }
    /// Value and gradient; x: of this pose (3 x N).
    void evaluate(const Model& model, const Points& x, LimitRow& row);

    /// Whether this is the pose of `count` coordinates, to the bit; becomes it.
    bool is(const double* coordinates, std::size_t count) const;
    void set(const std::vector<Limit>& limits, const double* coordinates, std::size_t count);

   private:
    std::vector<double> coordinates_, value_;
    std::vector<LimitRow> row_;  ///< with their gradients, or count 0
  };

  /// Valid until three other poses have been asked for. x: 3 x N.
  Pose& at(const Model& model, const Points& x, int ragdoll);

 private:
  std::array<Pose, 4> poses_;
  std::array<std::uint64_t, 4> last_call_{};
  std::uint64_t calls_ = 0;
};

}  // namespace ragdoll
