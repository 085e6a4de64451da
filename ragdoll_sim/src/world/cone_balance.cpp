#include "cone_balance.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace ragdoll {
namespace {

constexpr double kInCone = 1e-9;  ///< of the largest impulse: what lies outside by less is inside
constexpr double kBalanced = 1e-12;  ///< of the largest impulse
constexpr double kFloating = 1e-14;  ///< of a body's weights: keeps those without ground solvable
constexpr int kMostIterations = 40;
constexpr int kMostHalvings = 30;
constexpr double kArmijo = 1e-4;

using Matrix = Eigen::SparseMatrix<double>;
using Mat3 = Eigen::Matrix3d;

/// |tangential| <= friction * normal.
struct Cone {
  Vec3 normal = Vec3::Zero();
  double friction = 0;
  bool open = false;  ///< any impulse is in it
};

struct Parts {
  double normal = 0, slope = 0;  ///< slope: |tangential|
  Vec3 along = Vec3::Zero();     ///< unit, tangential
};

Parts partsOf(const Cone& cone, const Vec3& z) {
  Parts p;
  p.normal = z.dot(cone.normal);
  const Vec3 tangential = z - p.normal * cone.normal;
  p.slope = tangential.norm();
  if (p.slope > 0) p.along = tangential / p.slope;
  return p;
}

/// Wide enough for what was told: it stays where it is.
Cone coneOf(const SharedImpulse& s) {
  Cone cone{s.normal, s.friction, false};
  const Parts told = partsOf(cone, s.impulse);
  if (told.slope > cone.friction * told.normal) {
    cone.open = !(told.normal > 0);
    if (!cone.open) cone.friction = told.slope / told.normal;
  }
  return cone;
}

/// [N s] by how much z lies outside.
double outside(const Cone& cone, const Vec3& z) {
  if (cone.open) return 0;
  const Parts p = partsOf(cone, z);
  return std::max(-p.normal, p.slope - cone.friction * std::max(p.normal, 0.0));
}

/// The nearest point of the cone, and how it moves with z.
Vec3 project(const Cone& cone, const Vec3& z, Mat3* jacobian = nullptr) {
  const Parts p = partsOf(cone, z);
  const double mu = cone.friction;
  if (cone.open || (p.normal >= 0 && p.slope <= mu * p.normal)) {
    if (jacobian) jacobian->setIdentity();
    return z;
  }
  if (mu * p.slope <= -p.normal) {
    if (jacobian) jacobian->setZero();
    return Vec3::Zero();
  }
  const double normal = (p.normal + mu * p.slope) / (1 + mu * mu);
  const Vec3 edge = cone.normal + mu * p.along;
  if (jacobian) {
    *jacobian = edge * edge.transpose() / (1 + mu * mu);
    const Vec3 across = cone.normal.cross(p.along);
    if (p.slope > 0) *jacobian += mu * normal / p.slope * across * across.transpose();
  }
  return normal * edge;
}

/// The dual: its value, gradient and Hessian.
class Dual {
 public:
  Dual(const std::vector<Vec3>& rest, const std::vector<SharedImpulse>& told)
      : told_(told),
        wanted_(3 * static_cast<int>(rest.size())),
        matrix_(wanted_.size(), wanted_.size()) {
    for (std::size_t i = 0; i < rest.size(); ++i)
      wanted_.segment<3>(3 * static_cast<int>(i)) = rest[i];
    for (const SharedImpulse& s : told) {
      cones_.push_back(coneOf(s));
      addSigned(s, s.impulse, wanted_);
      largest_ = std::max(largest_, s.impulse.norm());
    }
    largest_ = std::max(largest_, wanted_.cwiseAbs().maxCoeff());
  }

  double largest() const { return largest_; }

  Vec3 free(std::size_t c, const Eigen::VectorXd& mu) const {
    const SharedImpulse& s = told_[c];
    Vec3 change = Vec3::Zero();
    if (s.first >= 0) change += mu.segment<3>(3 * s.first);
    if (s.second >= 0) change -= mu.segment<3>(3 * s.second);
    return s.impulse + s.weight * change;
  }
  Vec3 at(std::size_t c, const Eigen::VectorXd& mu) const {
    return project(cones_[c], free(c, mu));
  }

  bool isInCones(const Eigen::VectorXd& mu) const {
    for (std::size_t c = 0; c < told_.size(); ++c)
      if (outside(cones_[c], free(c, mu)) > kInCone * largest_) return false;
    return true;
  }

  double value(const Eigen::VectorXd& mu) const {
    double sum = -wanted_.dot(mu);
    for (std::size_t c = 0; c < told_.size(); ++c)
      sum += (at(c, mu).squaredNorm() - told_[c].impulse.squaredNorm()) / (2 * told_[c].weight);
    return sum;
  }

  /// What the bodies' sums have too much; with_cones: else as if there were none.
  Eigen::VectorXd gradient(const Eigen::VectorXd& mu, bool with_cones) const {
    Eigen::VectorXd sum = -wanted_;
    for (std::size_t c = 0; c < told_.size(); ++c)
      addSigned(told_[c], with_cones ? at(c, mu) : free(c, mu), sum);
    return sum;
  }

  /// The Newton step against that.
  Eigen::VectorXd step(const Eigen::VectorXd& mu, const Eigen::VectorXd& gradient,
                       bool with_cones) {
    entries_.clear();
    for (std::size_t c = 0; c < told_.size(); ++c) {
      Mat3 J = Mat3::Identity();
      if (with_cones) project(cones_[c], free(c, mu), &J);
      const SharedImpulse& s = told_[c];
      J *= s.weight;
      const Mat3 own = J + kFloating * s.weight * Mat3::Identity();
      addBlock(s.first, s.first, own);
      addBlock(s.second, s.second, own);
      addBlock(s.first, s.second, -J);
      addBlock(s.second, s.first, -J);
    }
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    return -Eigen::SimplicialLDLT<Matrix>(matrix_).solve(gradient);
  }

 private:
  static void addSigned(const SharedImpulse& s, const Vec3& impulse, Eigen::VectorXd& sum) {
    if (s.first >= 0) sum.segment<3>(3 * s.first) += impulse;
    if (s.second >= 0) sum.segment<3>(3 * s.second) -= impulse;
  }
  void addBlock(int i, int j, const Mat3& block) {
    if (i < 0 || j < 0) return;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) entries_.emplace_back(3 * i + a, 3 * j + b, block(a, b));
  }

  const std::vector<SharedImpulse>& told_;
  std::vector<Cone> cones_;
  Eigen::VectorXd wanted_;
  double largest_ = 0;
  Matrix matrix_;
  std::vector<Eigen::Triplet<double>> entries_;
};

/// From where mu stands: the best balance on the way, as there may be none. Near the end the value
/// no longer tells steps apart, the gradient does.
Eigen::VectorXd minimise(Dual& dual, Eigen::VectorXd mu) {
  Eigen::VectorXd gradient = dual.gradient(mu, true), best = mu;
  double least = gradient.cwiseAbs().maxCoeff();
  for (int i = 0; i < kMostIterations && least > kBalanced * dual.largest(); ++i) {
    const double left = gradient.cwiseAbs().maxCoeff(), value = dual.value(mu);
    const Eigen::VectorXd step = dual.step(mu, gradient, true);
    const double slope = gradient.dot(step);
    if (!step.allFinite() || !(slope < 0)) break;
    double t = 1;
    Eigen::VectorXd next, next_gradient;
    for (int k = 0;; ++k, t /= 2) {
      if (k == kMostHalvings) return best;
      next = mu + t * step;
      next_gradient = dual.gradient(next, true);
      if (dual.value(next) <= value + kArmijo * t * slope ||
          next_gradient.cwiseAbs().maxCoeff() <= left / 2)
        break;
    }
    mu.swap(next);
    gradient.swap(next_gradient);
    if (gradient.cwiseAbs().maxCoeff() < least) {
      least = gradient.cwiseAbs().maxCoeff();
      best = mu;
    }
  }
  return best;
}

/// What balances where nothing is bound, twice: weights may be far apart, and rounding with them.
Eigen::VectorXd unbound(Dual& dual, Eigen::VectorXd mu) {
  for (int i = 0; i < 2; ++i) mu += dual.step(mu, dual.gradient(mu, false), false);
  return mu;
}

/// Of bodies that no contacts join to others.
bool spreadTogether(const std::vector<Vec3>& rest, std::vector<SharedImpulse>& impulses) {
  if (rest.empty() || impulses.empty()) return true;
  const std::vector<SharedImpulse> told = impulses;
  Dual dual(rest, told);
  Eigen::VectorXd mu = unbound(dual, Eigen::VectorXd::Zero(3 * static_cast<int>(rest.size())));
  if (!mu.allFinite()) return true;
  if (dual.isInCones(mu)) {
    for (std::size_t c = 0; c < told.size(); ++c) impulses[c].impulse = dual.free(c, mu);
    return true;
  }
  mu = minimise(dual, mu);
  for (std::size_t c = 0; c < told.size(); ++c) impulses[c].impulse = dual.at(c, mu);
  // What no impulse in the cones can give.
  const std::vector<SharedImpulse> within = impulses;
  const Eigen::VectorXd missing = -dual.gradient(mu, true);
  const bool gives = missing.cwiseAbs().maxCoeff() <= kInCone * dual.largest();
  std::vector<Vec3> left(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i)
    left[i] = missing.segment<3>(3 * static_cast<int>(i));
  Dual again(left, within);
  const Eigen::VectorXd more = unbound(again, Eigen::VectorXd::Zero(mu.size()));
  if (!more.allFinite()) return gives;
  for (std::size_t c = 0; c < told.size(); ++c) impulses[c].impulse = again.free(c, more);
  return gives;
}

/// Bodies that contacts join, and these contacts.
struct Group {
  std::vector<Vec3> rest;
  std::vector<SharedImpulse> impulses;
  std::vector<std::size_t> from;  ///< of each impulse
};

int rootOf(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// In the order of their first bodies.
std::vector<Group> groupsOf(const std::vector<Vec3>& rest,
                            const std::vector<SharedImpulse>& impulses) {
  std::vector<int> parent(rest.size()), group(rest.size(), -1), place(rest.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const SharedImpulse& c : impulses)
    if (c.first >= 0 && c.second >= 0) parent[rootOf(parent, c.first)] = rootOf(parent, c.second);
  std::vector<Group> groups;
  const auto groupOf = [&](int i) -> Group& {
    int& index = group[rootOf(parent, i)];
    if (index < 0) {
      index = static_cast<int>(groups.size());
      groups.emplace_back();
    }
    return groups[index];
  };
  for (int i = 0; i < static_cast<int>(rest.size()); ++i) {
    Group& own = groupOf(i);
    place[i] = static_cast<int>(own.rest.size());
    own.rest.push_back(rest[i]);
  }
  for (std::size_t c = 0; c < impulses.size(); ++c) {
    const int body = std::max(impulses[c].first, impulses[c].second);
    if (body < 0) continue;
    Group& own = groupOf(body);
    own.impulses.push_back(impulses[c]);
    for (int* end : {&own.impulses.back().first, &own.impulses.back().second})
      if (*end >= 0) *end = place[*end];
    own.from.push_back(c);
  }
  return groups;
}

}  // namespace

bool spreadWithinCones(const std::vector<Vec3>& rest, std::vector<SharedImpulse>& impulses) {
  bool gives = true;
  for (Group& group : groupsOf(rest, impulses)) {
    gives = spreadTogether(group.rest, group.impulses) && gives;
    for (std::size_t k = 0; k < group.from.size(); ++k)
      impulses[group.from[k]].impulse = group.impulses[k].impulse;
  }
  return gives;
}

}  // namespace ragdoll
