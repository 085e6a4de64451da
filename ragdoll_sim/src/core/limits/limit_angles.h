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
    double operator[](int limit) {
      if (!known_[limit]) findValue(limit);
      return value_[limit];
    }
    /// Whether C is at least `margin`; most limits' cosines show it.
    bool isBeyond(int limit, double margin) {
      return isFar(limit, margin) || (*this)[limit] >= margin;
    }
    /// With value and gradient. ahead: coordinates of the body a moment later; it matters at the
    /// tip of a wedge.
    const LimitRow& row(int limit, const double* ahead);
    /// These alone, into a row.
    void evaluate(LimitRow& row, const double* ahead);

    /// Whether this is the pose of that body's `count` coordinates, to the bit; becomes it.
    bool is(const std::vector<Limit>& limits, int first, const double* coordinates,
            std::size_t count) const;
    void makeRoom(std::size_t limits, std::size_t count);
    /// limits: of the body's skeleton; first: the body's first column of the state.
    void set(const std::vector<Limit>& limits, int first, const double* coordinates,
             std::size_t count);

   private:
    bool isFar(int limit, double margin) const;
    void findValue(int limit);

    const std::vector<Limit>* limits_ = nullptr;
    int first_ = 0;
    std::vector<double> coordinates_, value_;
    std::vector<std::uint8_t> known_;  ///< the values
    std::vector<Vec3> reference_, child_;
    std::vector<double> cosine_;        ///< between the two; NaN where it says nothing
    std::vector<LimitRow> row_;         ///< with their gradients, or count 0
    std::vector<std::uint8_t> at_tip_;  ///< of those: isAtTip
  };

  void makeRoom(const Skeleton& skeleton);
  /// Valid until three other poses have been asked for. x: 3 x N.
  Pose& at(const Model& model, const Points& x, int ragdoll);

 private:
  std::array<Pose, 4> poses_;
  std::array<std::uint64_t, 4> last_call_{};
  std::uint64_t calls_ = 0;
  std::size_t last_ = 0;  ///< the pose of the last call
};

}  // namespace ragdoll
