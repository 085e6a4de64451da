// Limits of a model at a pose: what the tests of limits share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/start_state.h"
#include "support/limbs.h"

namespace ragdoll::test {

constexpr double kAll = 10;  ///< [rad] a margin that lists every row

inline std::vector<LimitRow> rowsOf(const Model& model, const Points& x, double margin = kAll) {
  State state = startState(model);
  std::vector<LimitRow> rows;
  findLimits(model, x, state, margin, rows);
  for (LimitRow& row : rows) {
    const double value = row.value;
    evaluateLimit(model, x, row);
    EXPECT_NEAR(row.value, value, 1e-15);
  }
  return rows;
}

/// Every particle moved at random by up to `size`.
inline Points shaken(const Model& model, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Points x = model.start_position;
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += uniform(random);
  return x;
}

/// The model with one joint, its child bone pointed along `direction` from the joint.
struct OneJoint {
  Model model;
  int from, to;

  OneJoint(const JointSpec& joint, const std::string& from_name, const std::string& to_name)
      : OneJoint(std::vector<JointSpec>{joint}, from_name, to_name) {}
  OneJoint(const std::vector<JointSpec>& joints, const std::string& from_name,
           const std::string& to_name) {
    SkeletonSpec s = limbs();
    s.joints = joints;
    model = buildModel(sceneOf(s));
    from = model.skeletons[0].particle(from_name);
    to = model.skeletons[0].particle(to_name);
  }
  Points posed(const Vec3& direction) const {
    Points x = model.start_position;
    const double length = (x.col(to) - x.col(from)).norm();
    x.col(to) = x.col(from) + length * direction.normalized();
    return x;
  }
  double violation(const Vec3& direction) const {
    return limitViolation(model, posed(direction), 0);
  }
  double least(const Vec3& direction) const {
    double least = kAll;
    for (const LimitRow& row : rowsOf(model, posed(direction))) least = std::min(least, row.value);
    return least;
  }
};

/// Bent by `angle` to the front (elbow about -y) from hanging down.
inline Vec3 bent(double angle_deg) {
  return {std::sin(rad(angle_deg)), 0, -std::cos(rad(angle_deg))};
}

/// Limbs whose shoulder and elbow have one narrow region each.
inline SkeletonSpec narrowPlanes() {
  SkeletonSpec s = limbs();
  JointSpec elbow = planes("elbow", "upper_arm", "forearm");
  elbow.planes[1] = AngleRange{0, rad(10)};
  JointSpec shoulder = planes("shoulder", "trunk", "upper_arm");
  shoulder.planes[1] = AngleRange{rad(85), rad(95)};
  s.joints = {shoulder, elbow};
  return s;
}

}  // namespace ragdoll::test
