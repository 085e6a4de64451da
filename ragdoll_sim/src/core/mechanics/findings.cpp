#include "ragdoll_sim/core/findings.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/contact/constants.h"
#include "core/contact/detect.h"
#include "core/contact/distance.h"
#include "core/contact/pair_detect.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

/// [m] of the deepest particle or stick of one body, < 0: outside.
double depthOf(const Model& model, const State& state, const Ragdoll& r, std::size_t obstacle) {
  const Obstacle& o = model.obstacles[obstacle];
  const Pose& pose = state.obstacles[obstacle];
  const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
  const auto local = [&](int p) { return Vec3(R.transpose() * (state.x.col(p) - pose.position)); };
  const Skeleton& skeleton = model.skeletonOf(r);
  double deepest = -1;
  for (int p = r.first; p < r.first + skeleton.named; ++p)
    deepest = std::max(deepest, model.radius[p] - signedDistanceValue(o, local(p)));
  if (o.type == ObstacleSpec::Type::kPlane) return deepest;
  for (const Stick& s : skeleton.sticks) {
    const int a = r.first + s.a, b = r.first + s.b;
    deepest = std::max(deepest, -stickGap(o, local(a), local(b), model.radius[a], model.radius[b]));
  }
  return deepest;
}

}  // namespace

std::vector<std::string> deepOverlaps(const Model& model, const State& state) {
  std::vector<std::string> found;
  for (const Ragdoll& r : model.ragdolls)
    for (std::size_t k = 0; k < model.obstacles.size(); ++k) {
      const double depth = depthOf(model, state, r, k);
      if (!(depth > kDeepOverlap)) continue;
      found.push_back(r.name + " is " + numberText(std::round(100 * depth)) + " cm inside " +
                      model.obstacles[k].name);
    }
  return found;
}

int contactsOfSleepers(const Model& model, const State& state) {
  std::vector<Contact> contacts;
  std::vector<SweptObstacle> obstacles;
  std::vector<int> sleepers;
  for (std::size_t r = 0; r < model.ragdolls.size(); ++r)
    if (state.asleep[r]) sleepers.push_back(static_cast<int>(r));
  if (sleepers.empty()) return 0;
  sweepObstacles(model, state, {}, obstacles);
  PairDetector pairs;
  State awake = state;  // pairs of sleepers are left out
  std::fill(awake.asleep.begin(), awake.asleep.end(), 0);
  for (const int r : sleepers) {
    appendContacts(model, obstacles, state.x, state.x, r, kGapResolution, contacts);
    if (model.self_collision)
      pairs.appendSelf(model, state.x, state.x, r, PairSearch::touches(kGapResolution), contacts);
  }
  if (model.ragdoll_collision)
    pairs.appendBetween(model, awake, sleepers, state.x, state.x,
                        PairSearch::touches(kGapResolution), contacts);
  return static_cast<int>(contacts.size());
}

Eigen::VectorXd pointMasses(const Skeleton& skeleton) {
  const Eigen::VectorXd sums = skeleton.M.rowwise().sum();
  Eigen::VectorXd masses = sums.head(skeleton.named);
  for (const Segment& s : skeleton.segments) {
    if (s.carrier < 0) continue;
    const auto k = static_cast<Eigen::Index>(s.particles.size());
    Eigen::MatrixXd P(4, k);  // of the plane: affine coordinates of the foot in it
    for (Eigen::Index i = 0; i < k; ++i) P.col(i) << 1, skeleton.rest.col(s.particles[i]);
    Eigen::Vector4d point;
    point << 1, skeleton.rest.col(s.carrier);
    const Eigen::Vector3d normal = Vec3(P.col(1).tail<3>() - P.col(0).tail<3>())
                                       .cross(Vec3(P.col(2).tail<3>() - P.col(0).tail<3>()));
    if (normal.norm() > 0) {
      const Vec3 n = normal.normalized();
      point.tail<3>() -= n.dot(point.tail<3>() - P.col(0).tail<3>()) * n;
    }
    const Eigen::VectorXd share = P.completeOrthogonalDecomposition().solve(point);
    for (Eigen::Index i = 0; i < k; ++i) masses[s.particles[i]] += share[i] * sums[s.carrier];
  }
  return masses;
}

}  // namespace ragdoll
