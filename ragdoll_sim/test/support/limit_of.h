// What a scene converges to, by rk from event to event, and how shake comes to it.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"

namespace ragdoll::test {

class LimitOf {
 public:
  /// After some seconds.
  LimitOf(const std::string& text, double seconds) : scene_(parseScene(text)), seconds_(seconds) {
    exact_ = endOfImpacts(scene_, Method::kRk, 1e-3, seconds);
  }
  /// [m] In steps of 1 / rate.
  double errorAt(double rate) const {
    return largest(endOfImpacts(scene_, Method::kShake, 1 / rate, seconds_) - exact_);
  }
  /// At most `most` [m/s^2] / rate^2, at each of the rates [Hz].
  void expectSecondOrder(double most, std::initializer_list<double> rates) const {
    for (const double rate : rates) EXPECT_LT(errorAt(rate), most / (rate * rate)) << rate;
  }
  /// At most `most` [m] at each of them.
  void expectBelow(double most, std::initializer_list<double> rates) const {
    for (const double rate : rates) EXPECT_LT(errorAt(rate), most) << rate;
  }
  void expectWithinTolerances(std::initializer_list<double> tolerances = {1e-2, 1e-3, 1e-4}) const {
    for (const double tolerance : tolerances) {
      Scene scene = scene_;
      scene.solver.tolerance = tolerance;
      const Points off = endOfImpacts(scene, Method::kShake, 1.0 / 60, seconds_) - exact_;
      EXPECT_LT(largest(off), 3 * tolerance * seconds_) << tolerance;
    }
  }

 private:
  Scene scene_;
  double seconds_;
  Points exact_;
};

}  // namespace ragdoll::test
