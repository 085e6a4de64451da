#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "core/loading/skeleton.h"
#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

/// A rod's velocity is linear along it, so its kinetic energy is exact with a 2 x 2 matrix on its
/// ends (consistent mass, e.g. [Przemieniecki1968, sec. 11]); c = centre of mass, s = c^2 +
/// gyration^2, both in fractions of the length from the first end.
void addRod(const SegmentSpec& g, const Segment& segment, Eigen::MatrixXd& M) {
  if (!(g.com >= 0 && g.com <= 1))
    throw Error(g.where + ".com", "com of '" + g.name + "' must be a fraction in [0, 1]");
  if (!(std::isfinite(g.gyration) && g.gyration > 0))
    throw Error(g.where + ".gyration", "gyration of '" + g.name + "' must be > 0 (of the length)");
  const double c = g.com, s = c * c + g.gyration * g.gyration;
  const int a = segment.particles[0], b = segment.particles[1];
  M(a, a) += g.mass * (1 - 2 * c + s);
  M(a, b) += g.mass * (c - s);
  M(b, a) += g.mass * (c - s);
  M(b, b) += g.mass * s;
}

/// A rigid body's points are affine in its k particles, p = X beta(p), so the particles carry its
/// mass as the k x k matrix of second moments of beta: P+ S P+^T with P = [1; X] (4 x k) and S =
/// int [1; p] [1; p]^T dm.
void addGroup(const SegmentSpec& g, const Segment& segment, const Points& rest,
              Eigen::MatrixXd& M) {
  checkPosition(g.where + ".com", g.com_point);
  const Eigen::Matrix3d I = 0.5 * (g.inertia + g.inertia.transpose());
  const Eigen::Matrix3d J = 0.5 * I.trace() * Eigen::Matrix3d::Identity() - I;
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(J).eigenvalues();
  if (!I.allFinite() || !(moments[2] > 0) || moments[0] < -1e-9 * moments[2])
    throw Error(g.where + ".inertia",
                "inertia of '" + g.name +
                    "' is no body's: each principal moment must be positive and "
                    "no more than the sum of the other two [kg m^2]");
  Eigen::Matrix4d S;
  S << g.mass, g.mass * g.com_point.transpose(), g.mass * g.com_point,
      J + g.mass * g.com_point * g.com_point.transpose();
  const std::vector<int> particles = segment.allParticles();
  const std::size_t k = particles.size();
  Eigen::MatrixXd P(4, k);
  for (std::size_t i = 0; i < k; ++i) P.col(i) << 1, rest.col(particles[i]);
  const Eigen::MatrixXd inverse = P.completeOrthogonalDecomposition().pseudoInverse();  // k x 4
  const Eigen::MatrixXd m = inverse * S * inverse.transpose();
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j < k; ++j) M(particles[i], particles[j]) += m(i, j);
}

}  // namespace

Eigen::MatrixXd massMatrix(const SkeletonSpec& spec, const Skeleton& skeleton) {
  const int n = skeleton.size();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < skeleton.named; ++i) M(i, i) = spec.particles[i].mass;
  for (std::size_t k = 0; k < spec.segments.size(); ++k) {
    const SegmentSpec& segment = spec.segments[k];
    if (!(segment.mass > 0)) continue;
    if (segment.group)
      addGroup(segment, skeleton.segments[k], skeleton.rest, M);
    else
      addRod(segment, skeleton.segments[k], M);
  }
  for (int i = 0; i < skeleton.named; ++i)
    if (!(M(i, i) > 0))
      throw Error(spec.particles[i].where,
                  "particle '" + skeleton.particles[i] +
                      "' has no mass; give it a mass > 0 [kg] or a segment "
                      "that has one");
  return M;
}

}  // namespace ragdoll
