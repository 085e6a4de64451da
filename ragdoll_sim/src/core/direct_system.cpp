#include "ragdoll_sim/core/direct_system.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/rigid_groups.h"
#include "ragdoll_sim/core/stick_solver.h"

namespace ragdoll {
namespace {

constexpr double kDependent =
    1e-8;                          ///< a scaled pivot below this: the stick follows from the others
constexpr double kJitter = 0.1;    ///< share of the body's size, for a generic pose
constexpr double kDoubtful = 1e6;  ///< condition above which the user is told

/// G o (D^T D), scaled to a unit diagonal, for stick rows B and positions X.
Eigen::MatrixXd scaledSystem(const Eigen::MatrixXd& B, const Eigen::MatrixXd& G, const Points& X) {
  const Eigen::MatrixXd D = X * B.transpose();
  Eigen::MatrixXd S = G.cwiseProduct(D.transpose() * D);
  const Eigen::VectorXd scale = S.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * S * scale.asDiagonal();
}

/// Sticks that are independent of those before them, in order (Cholesky without pivoting).
std::vector<int> independent(const Eigen::MatrixXd& S) {
  std::vector<int> kept;
  Eigen::MatrixXd R = S;  // Schur complement, updated in place
  for (int i = 0; i < R.rows(); ++i) {
    if (!(R(i, i) > kDependent)) continue;
    kept.push_back(i);
    const Eigen::VectorXd column = R.col(i) / R(i, i);
    R -= column * R.row(i).eval();
  }
  return kept;
}

/// A pose near the rest that is no special one: fixed irrational offsets.
Points genericPose(const Points& rest) {
  const double size = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
  Points x = rest;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    for (int k = 0; k < 3; ++k)
      x(k, i) += kJitter * size * std::sin(12.9898 * (3 * i + k) + 4.1414);
  return x;
}

Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& m, const std::vector<int>& rows) {
  Eigen::MatrixXd out(rows.size(), m.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(i) = m.row(rows[i]);
  return out;
}

std::string stickName(const Skeleton& s, std::pair<int, int> ends) {
  return "'" + s.particles[ends.first] + "-" + s.particles[ends.second] + "'";
}

/// Keeps the sticks that a motion can need; says which were redundant.
void keepIndependent(const Skeleton& s, BaseMap& map, const Eigen::MatrixXd& W,
                     std::vector<std::string>& warnings) {
  std::vector<int> movable;
  for (Eigen::Index i = 0; i < map.sticks.rows(); ++i) {
    const Eigen::RowVectorXd b = map.sticks.row(i) * map.L;
    if ((b * W * b.transpose()).value() > 1e-12 * W.diagonal().maxCoeff())
      movable.push_back(static_cast<int>(i));
  }
  Eigen::MatrixXd B = rowsOf(map.sticks, movable) * map.L;
  // The generic pose keeps rigid groups affine: it moves base points.
  const Points pose = genericPose(s.rest * map.L.transpose()) * map.T.transpose();
  const std::vector<int> kept = independent(scaledSystem(B, B * W * B.transpose(), pose));
  std::vector<int> rows;
  std::size_t next = 0;
  for (std::size_t i = 0; i < movable.size(); ++i) {
    if (next < kept.size() && kept[next] == static_cast<int>(i)) {
      rows.push_back(movable[i]);
      ++next;
    } else if (map.ends[movable[i]].first >= 0) {
      warnings.push_back("stick " + stickName(s, map.ends[movable[i]]) +
                         " is redundant: others hold its length; the direct methods leave it out");
    }
  }
  map.sticks = rowsOf(map.sticks, rows);
  map.length = rowsOf(map.length, rows);
}

}  // namespace

Eigen::MatrixXd takeOutPins(const std::vector<int>& pins, Eigen::MatrixXd& W) {
  const Eigen::Index n = W.rows(), p = static_cast<Eigen::Index>(pins.size());
  Eigen::MatrixXd motion(p, n);
  if (p == 0) return motion;
  Eigen::MatrixXd We(n, p), Wee(p, p);
  for (Eigen::Index j = 0; j < p; ++j) We.col(j) = W.col(pins[j]);
  for (Eigen::Index j = 0; j < p; ++j) Wee.row(j) = We.row(pins[j]);
  // Complete orthogonal decomposition: more pins than a rigid group has freedoms leave W_EE
  // singular.
  motion = Wee.completeOrthogonalDecomposition().solve(We.transpose());
  W -= We * motion;
  for (const int i : pins) {
    W.row(i).setZero();
    W.col(i).setZero();
    motion.col(i).setZero();
  }
  for (Eigen::Index j = 0; j < p; ++j) motion(j, pins[j]) = 1;
  return motion;
}

DirectSystem buildDirectSystem(const Skeleton& s, const std::vector<int>& pins,
                               std::vector<std::string>& warnings) {
  BaseMap map = baseMap(s);
  const Eigen::LDLT<Eigen::MatrixXd> mass(map.T.transpose() * s.M * map.T);
  if (mass.info() != Eigen::Success || !(mass.vectorD().minCoeff() > 0))
    throw Error("model '" + s.name + "'",
                "its masses leave some motion without inertia; give every "
                "particle a mass, or every segment a mass and a gyration");
  DirectSystem d;
  d.W = map.T * mass.solve(map.T.transpose());
  d.pin_motion = takeOutPins(pins, d.W);
  d.gravity = Eigen::RowVectorXd::Ones(s.size()) * s.M * d.W;
  d.affine = map.T * map.L;
  keepIndependent(s, map, d.W, warnings);
  d.B = map.sticks * map.L;
  d.BW = d.B * d.W;
  d.G = d.BW * d.B.transpose();
  d.length = map.length;
  d.rows = std::make_shared<const StickRows>(d);
  if (d.length.size() > 0) {
    const Eigen::VectorXd e = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                  scaledSystem(d.B, d.G, s.rest), Eigen::EigenvaluesOnly)
                                  .eigenvalues();
    d.condition = e.maxCoeff() / std::max(e.minCoeff(), 1e-300);
    if (d.condition > kDoubtful)
      warnings.push_back("model '" + s.name +
                         "' rests in a pose where its sticks are nearly dependent "
                         "(condition " +
                         std::to_string(d.condition) +
                         "); bend it a little, or expect more work from the step guard");
  }
  return d;
}

}  // namespace ragdoll
