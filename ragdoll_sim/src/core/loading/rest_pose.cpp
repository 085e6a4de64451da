#include "core/loading/rest_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

constexpr double kAgree = 1e-6;           ///< [-] a stick this near to its length has it
constexpr double kNeedsNoFit = 1e-9;      ///< [-] and this near needs no fit
constexpr double kTold = 1e-6;            ///< [m] moves that the user hears of
constexpr int kAttempts = 6;              ///< from other poses: a fit may end in a dead one
constexpr std::size_t kMaxFitted = 1000;  ///< sticks; their matrix is dense
constexpr double kWork = 2e10;            ///< multiplications of all attempts, about 10 s
constexpr std::size_t kNamed = 8;         ///< sticks and particles that a message names

/// Least squares over the sticks' lengths; particles with weight 0 stay.
class Fit {
 public:
  Fit(const Skeleton& s, Eigen::VectorXd weight) : s_(s), weight_(std::move(weight)) {
    const double count = static_cast<double>(s.sticks.size());
    iterations_ = static_cast<int>(std::clamp(kWork / (count * count * count + 1), 20.0, 3000.0));
  }

  /// |d| / L - 1 of each stick at x.
  Eigen::VectorXd errors(const Points& x) const {
    Eigen::VectorXd out(s_.sticks.size());
    for (std::size_t i = 0; i < s_.sticks.size(); ++i) {
      const Stick& k = s_.sticks[i];
      out[i] = (x.col(k.b) - x.col(k.a)).norm() / k.length - 1;
    }
    return out;
  }

  /// Moves x to a least of the sum of squares; true if every stick has its length there.
  bool run(Points& x) {
    Eigen::VectorXd r = errors(x);
    double damping = 1e-3;
    for (; iterations_ > 0 && r.cwiseAbs().maxCoeff() > 0.1 * kNeedsNoFit; --iterations_) {
      const Points next = x + move(x, r, damping);
      const Eigen::VectorXd after = errors(next);
      if (after.squaredNorm() < r.squaredNorm()) {
        const bool stuck = after.squaredNorm() > 0.9999 * r.squaredNorm();
        x = next;
        r = after;
        damping = std::max(0.1 * damping, 1e-13);
        if (stuck) break;
      } else if ((damping *= 10) > 1e6) {
        break;
      }
    }
    return r.cwiseAbs().maxCoeff() <= kAgree;
  }

 private:
  /// -W J^T (J W J^T + damping)^-1 r with J in units of the sticks' lengths.
  Points move(const Points& x, const Eigen::VectorXd& r, double damping) const {
    const Eigen::Index count = static_cast<Eigen::Index>(s_.sticks.size());
    Points direction(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Vec3 d = x.col(s_.sticks[i].b) - x.col(s_.sticks[i].a);
      direction.col(i) = d.norm() > kMinLength ? Vec3(d.normalized()) : Vec3::UnitX();
    }
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) {
        const Stick &p = s_.sticks[i], &q = s_.sticks[j];
        double w = 0;
        if (p.a == q.a) w += weight_[p.a];
        if (p.b == q.b) w += weight_[p.b];
        if (p.a == q.b) w -= weight_[p.a];
        if (p.b == q.a) w -= weight_[p.b];
        A(i, j) = w * direction.col(i).dot(direction.col(j)) / (p.length * q.length);
      }
    const double scale = std::max(A.diagonal().maxCoeff(), 1e-300);
    A.diagonal().array() += damping * scale;
    const Eigen::VectorXd y = A.selfadjointView<Eigen::Lower>().llt().solve(r);
    Points out = Points::Zero(3, x.cols());
    for (Eigen::Index i = 0; i < count; ++i) {
      const Stick& k = s_.sticks[i];
      const Vec3 pull = y[i] / k.length * direction.col(i);
      out.col(k.a) += weight_[k.a] * pull;
      out.col(k.b) -= weight_[k.b] * pull;
    }
    return out;
  }

  const Skeleton& s_;
  Eigen::VectorXd weight_;
  int iterations_;  ///< left, of all runs
};

/// 0 for particles of groups with mass, whose places the file gives; else 1.
Eigen::VectorXd freedom(const SkeletonSpec& spec, const Skeleton& s) {
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(s.size());
  for (const SegmentSpec& g : spec.segments)
    if (g.group && g.mass > 0)
      for (const std::string& name : g.particles)
        if (const int i = s.particle(name); i >= 0) weight[i] = 0;
  return weight;
}

[[noreturn]] void refuse(const SkeletonSpec& spec, const Skeleton& s, const Points& nearest,
                         const Eigen::VectorXd& errors) {
  std::vector<int> off;
  for (int i = 0; i < errors.size(); ++i)
    if (std::abs(errors[i]) > kAgree) off.push_back(i);
  const auto given = [&](int i) { return spec.sticks[i].length.has_value(); };
  std::stable_sort(off.begin(), off.end(), [&](int i, int j) {
    return std::pair(given(i), std::abs(errors[i])) > std::pair(given(j), std::abs(errors[j]));
  });
  std::string text;
  for (std::size_t k = 0; k < std::min(off.size(), kNamed); ++k) {
    const Stick& stick = s.sticks[off[k]];
    const double now = (nearest.col(stick.b) - nearest.col(stick.a)).norm();
    text += (k == 0 ? "" : ", ") + stickName(s, stick.a, stick.b) + " of " +
            numberText(stick.length) + " m would be " + numberText(now) + " m";
  }
  if (off.size() > kNamed) text += ", ...";
  throw Error(spec.sticks[off[0]].where,
              "no pose gives all sticks their lengths; in the nearest one " + text +
                  "; change a length that the file gives, or leave it out");
}

}  // namespace

std::string stickName(const Skeleton& s, int a, int b) {
  return "'" + s.particles[a] + "-" + s.particles[b] + "'";
}

std::string movesText(const Skeleton& s, const Points& before, const Points& after) {
  const Eigen::VectorXd moved = (after - before).colwise().norm();
  std::vector<int> order;
  for (int i = 0; i < s.named; ++i)
    if (moved[i] > kTold) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return moved[i] > moved[j]; });
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), kNamed); ++k)
    text += (k == 0 ? "" : ", ") + s.particles[order[k]] + " by " +
            numberText(1e3 * moved[order[k]]) + " mm";
  return text + (order.size() > kNamed ? ", ..." : "");
}

double extent(const Points& x) { return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm(); }

Points genericPose(const Points& rest, double size, int variant) {
  constexpr double kShare = 0.1;
  Points x = rest;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    for (int k = 0; k < 3; ++k)
      x(k, i) += kShare * size * std::sin(12.9898 * (3 * i + k) + 4.1414 + 7.2333 * variant);
  return x;
}

void fitRestPose(const SkeletonSpec& spec, Skeleton& s) {
  const Eigen::VectorXd weight = freedom(spec, s);
  Fit fit(s, weight);
  const double worst = s.sticks.empty() ? 0 : fit.errors(s.rest).cwiseAbs().maxCoeff();
  if (!(worst > (s.sticks.size() > kMaxFitted ? kAgree : kNeedsNoFit))) return;
  if (s.sticks.size() > kMaxFitted)
    throw Error(spec.where, "positions can be fitted to the lengths of " +
                                std::to_string(kMaxFitted) + " sticks at most, and there are " +
                                std::to_string(s.sticks.size()) + "; leave the lengths out");
  const Points before = s.rest;
  Points nearest = before;
  double size = extent(before);
  for (const Stick& k : s.sticks) size = std::max(size, k.length);
  double least = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Points x = attempt == 0 ? before : genericPose(before, size, attempt);
    for (int i = 0; i < s.size(); ++i)
      if (weight[i] == 0) x.col(i) = before.col(i);
    const bool fits = fit.run(x);
    const double off = fit.errors(x).squaredNorm();
    if (fits || off < least) nearest = x;
    least = std::min(least, off);
    if (!fits) continue;
    s.rest = x;
    const std::string moves = movesText(s, before, s.rest);
    if (!moves.empty())
      s.warnings.push_back(
          spec.where + ": the positions do not fit the sticks' lengths and were moved: " + moves);
    return;
  }
  refuse(spec, s, nearest, fit.errors(nearest));
}

}  // namespace ragdoll
