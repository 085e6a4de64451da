// Joint limits by projection, for the relaxation.
//
// A violated limit moves the particles by dx = W grad C^T d_lambda, d_lambda = (-C - offset -
// compliance lambda) / (w + compliance), w = grad C W grad C^T, lambda >= 0 accumulated over the
// sweeps; offset and compliance soften it (LimitRow::eulerSoftness), 0 for a hard limit. Limits
// near after free motion take part; a sweep evaluates anew those that press or that their last
// tangent says are violated. Tangents taken once per step cost half as much, but a body blew up in
// one of 100 falls.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

class LimitProjection {
 public:
  /// Nothing to do in any sweep: no ragdoll has a joint near its limits.
  bool empty() const { return rows_.empty(); }
  /// x1: free motion (3 x N); h: [s].
  void prepare(const Model& model, const State& state, const Points& x1, double h);
  /// One sweep over all limits; moves x.
  void sweep(const Model& model, Points& x);

 private:
  struct Row {
    LimitRow limit;
    double offset = 0;  ///< [rad] C of its tangent at x = 0
    double w = 0;       ///< [1 / (kg m^2)]
    double lambda = 0;  ///< [kg m^2] accumulated
    LimitRow::Softness softness;
  };
  void evaluate(const Model& model, const Points& x, Row& row) const;
  bool isInside(const Row& row, const Points& x) const;  ///< as its last tangent says
  void project(const Model& model, Row& row, Points& x) const;

  Roomy<LimitRow> found_;
  Roomy<Row> rows_;
};

}  // namespace ragdoll
