#include "core/loading/direct_system.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/linear/stick_solver.h"
#include "core/loading/rest_pose.h"
#include "core/loading/rigid_groups.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

constexpr double kDependentRow =
    1e-8;  ///< a scaled pivot below this: the stick follows from the others
constexpr double kMassless = 1e-13;  ///< of the masses that it is made of: rounding
constexpr double kDoubtful = 1e6;    ///< condition above which the user is told

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
    if (!(R(i, i) > kDependentRow)) continue;
    kept.push_back(i);
    const Eigen::VectorXd column = R.col(i) / R(i, i);
    R -= column * R.row(i).eval();
  }
  return kept;
}

Eigen::MatrixXd rowsOf(const Eigen::MatrixXd& m, const std::vector<int>& rows) {
  Eigen::MatrixXd out(rows.size(), m.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(i) = m.row(rows[i]);
  return out;
}

/// Names of the parts with the largest weights, a tenth of the largest at least.
std::string largest(const Eigen::VectorXd& weights, const std::vector<std::string>& names) {
  constexpr std::size_t kNamedRows = 8;
  const Eigen::VectorXd w = weights.cwiseAbs();
  std::vector<int> order;
  for (int i = 0; i < w.size(); ++i)
    if (w[i] > 0.1 * w.maxCoeff()) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return w[i] > 1.001 * w[j]; });
  std::vector<std::string> out;
  for (const int i : order)
    if (out.size() <= kNamedRows && !std::count(out.begin(), out.end(), names[i]))
      out.push_back(out.size() < kNamedRows ? names[i] : "...");
  return joined(out);
}

std::vector<std::string> rowNames(const Skeleton& s, const BaseMap& map) {
  std::vector<std::string> names;
  for (const auto& [a, b] : map.ends) {
    if (a >= 0) {
      names.push_back(stickName(s, a, b));
      continue;
    }
    std::vector<std::string> members;
    for (const int i : s.groups[b].particles) members.push_back(s.particles[i]);
    names.push_back("the rigid group of " + joined(members));
  }
  return names;
}

/// Throws for a motion whose inertia is no more than rounding of the masses that make it up.
void checkMasses(const Skeleton& s, const Eigen::MatrixXd& T, const Eigen::MatrixXd& mass) {
  const Eigen::MatrixXd sums = T.cwiseAbs().transpose() * s.M.cwiseAbs() * T.cwiseAbs();
  const Eigen::VectorXd scale = sums.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * mass *
                                                             scale.asDiagonal());
  if (eigen.eigenvalues()[0] > kMassless) return;
  throw Error("model '" + s.name + "'",
              "its masses leave a motion of " +
                  largest(T * scale.asDiagonal() * eigen.eigenvectors().col(0), s.particles) +
                  " without inertia; give each of these particles a mass, or their segment a mass "
                  "and a gyration (a group: an inertia about every axis)");
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
  const Points base = s.rest * map.L.transpose();
  const Points pose = genericPose(base, extent(base)) * map.T.transpose();
  const Eigen::MatrixXd S = scaledSystem(B, B * W * B.transpose(), pose);
  const std::vector<int> kept = independent(S);
  std::vector<int> rows;
  std::vector<std::string> names;
  const std::vector<std::string> all = rowNames(s, map);
  std::vector<std::pair<int, int>> ends;
  for (const int i : kept) {
    rows.push_back(movable[i]);
    names.push_back(all[movable[i]]);
    ends.push_back(map.ends[movable[i]]);
  }
  if (kept.size() < movable.size()) {
    const Eigen::LDLT<Eigen::MatrixXd> solver(rowsOf(rowsOf(S, kept).transpose(), kept));
    for (std::size_t i = 0; i < movable.size(); ++i) {
      if (std::count(kept.begin(), kept.end(), i) || map.ends[movable[i]].first < 0) continue;
      const Eigen::VectorXd share = solver.solve(rowsOf(S, kept).col(i));
      warnings.push_back("model '" + s.name + "': stick " + all[movable[i]] +
                         " is redundant: " + largest(share, names) +
                         " hold its length; the direct methods leave it out");
    }
  }
  map.sticks = rowsOf(map.sticks, rows);
  map.length = rowsOf(map.length, rows);
  map.ends = ends;
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
  const Eigen::MatrixXd mass = map.T.transpose() * s.M * map.T;
  checkMasses(s, map.T, mass);
  DirectSystem d;
  d.W = map.T * mass.ldlt().solve(map.T.transpose());
  d.pin_motion = takeOutPins(pins, d.W);
  d.gravity = Eigen::RowVectorXd::Ones(s.size()) * s.M * d.W;
  d.affine = map.T * map.L;
  keepIndependent(s, map, d.W, warnings);
  d.B = map.sticks * map.L;
  d.BW = d.B * d.W;
  d.G = d.BW * d.B.transpose();
  d.length = map.length;
  d.rows = std::make_shared<const StickRows>(d, s.M);
  if (d.length.size() > 0) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaledSystem(d.B, d.G, s.rest));
    const Eigen::VectorXd& e = eigen.eigenvalues();
    d.condition = e.maxCoeff() / std::max(e.minCoeff(), 1e-300);
    if (d.condition > kDoubtful)
      warnings.push_back("model '" + s.name +
                         "' rests in a pose where these are nearly dependent: " +
                         largest(eigen.eigenvectors().col(0), rowNames(s, map)) + " (condition " +
                         numberText(d.condition) +
                         "); bend it a little there, or expect more work from the step guard");
  }
  return d;
}

}  // namespace ragdoll
