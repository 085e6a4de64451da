#include "core/direct/stability.h"

#include <cmath>

#include "core/direct/constants.h"

namespace ragdoll {

double stiffness(Body& body) { return stiffnessOf(body, body.multipliers()); }

double stiffnessOf(Body& body, const double* multipliers) {
  const StickRows& rows = *body.rows;
  const Eigen::Map<const Eigen::VectorXd> m(multipliers, rows.s);
  body.tension.setZero(rows.width);
  body.tension.head(rows.s) = 2 * m.cwiseAbs();
  body.row_sums.resize(rows.width);
  kernels::multiply(rows.absolute_G.data(), body.tension.data(), rows.s, rows.width,
                    body.row_sums.data());
  return rows.s > 0 ? body.row_sums.maxCoeff() : 0;
}

bool isSoft(const Body& body, double h) {
  const StickRows& rows = *body.rows;
  if (rows.s == 0) return true;
  const double most =
      Eigen::Map<const Eigen::VectorXd>(body.multipliers(), rows.s).cwiseAbs().maxCoeff();
  return 2 * most * rows.largest_row * h * h < kStable * kStable;
}

bool exceedsStable(Body& body, double h, double share) {
  return !isSoft(body, h / share) && h * std::sqrt(stiffness(body)) > share * kStable;
}

bool swings(Body& body, double h) { return exceedsStable(body, h, kSwing); }

bool tensionJumped(Body& body, double h) {
  return exceedsStable(body, h, kJump) &&
         stiffness(body) > kJumped * stiffnessOf(body, body.saved.multipliers.data());
}

}  // namespace ragdoll
