#include "ragdoll_sim/core/measures.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/contact/detect.h"
#include "core/contact/distance.h"
#include "core/contact/pair_detect.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

double kineticEnergy(const Model& model, const State& state) {
  double e = 0;
  for (const Ragdoll& r : model.ragdolls) {
    const Skeleton& s = model.skeletonOf(r);
    const auto v = state.v.middleCols(r.first, s.size());
    e += 0.5 * (v * s.M).cwiseProduct(v).sum();
  }
  return e;
}

double potentialEnergy(const Model& model, const State& state) {
  double e = 0;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    e -= model.skeletonOf(model.ragdolls[i]).M.sum() *
         model.gravity.dot(centreOfMass(model, state, static_cast<int>(i)));
  return e;
}

double springEnergy(const Model& model, const State& state) {
  double e = 0;
  if (!model.compliant) return e;
  std::vector<SweptObstacle> obstacles;
  std::vector<Contact> contacts;
  sweepObstacles(model, state, {}, obstacles);
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    appendContacts(model, obstacles, state.x, state.x, static_cast<int>(i), 0, contacts);
  PairDetector pairs;
  State awake = state;
  std::fill(awake.asleep.begin(), awake.asleep.end(), std::uint8_t(0));
  const PairSearch touching = PairSearch::touches(0);
  for (std::size_t i = 0; i < model.ragdolls.size() && model.self_collision; ++i)
    pairs.appendSelf(model, state.x, state.x, static_cast<int>(i), touching, contacts);
  if (model.ragdoll_collision)
    pairs.appendBetween(model, awake, state.x, state.x, touching, contacts);
  for (const Contact& c : contacts) e += c.storedEnergy(c.gapAt(state.x));
  return e;
}

Vec3 centreOfMass(const Model& model, const State& state, int ragdoll) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  return (state.x.middleCols(r.first, s.size()) * s.M).rowwise().sum() / s.M.sum();
}

Vec3 momentum(const Model& model, const State& state) {
  Vec3 p = Vec3::Zero();
  for (const Ragdoll& r : model.ragdolls) {
    const Skeleton& s = model.skeletonOf(r);
    p += (state.v.middleCols(r.first, s.size()) * s.M).rowwise().sum();
  }
  return p;
}

Vec3 angularMomentum(const Model& model, const State& state) {
  Vec3 l = Vec3::Zero();
  for (const Ragdoll& r : model.ragdolls) {
    const Skeleton& s = model.skeletonOf(r);
    const Points p = state.v.middleCols(r.first, s.size()) * s.M;
    for (int i = 0; i < s.size(); ++i) l += Vec3(state.x.col(r.first + i)).cross(Vec3(p.col(i)));
  }
  return l;
}

double maxStickError(const Model& model, const State& state) {
  double worst = 0;
  for (const Ragdoll& r : model.ragdolls)
    for (const Stick& k : model.skeletonOf(r).sticks) {
      const double length = (state.x.col(r.first + k.a) - state.x.col(r.first + k.b)).norm();
      worst = std::max(worst, std::abs(length / k.length - 1));
    }
  return worst;
}

double maxPenetration(const Model& model, const State& state) {
  double worst = 0;
  for (std::size_t k = 0; k < model.obstacles.size(); ++k) {
    const Pose& pose = state.obstacles[k];
    const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
    for (const Ragdoll& r : model.ragdolls)
      for (int i = r.first; i < r.first + model.skeletonOf(r).named; ++i) {
        const Vec3 p = R.transpose() * (state.x.col(i) - pose.position);
        worst = std::max(worst, model.radius[i] - signedDistanceValue(model.obstacles[k], p));
      }
  }
  return worst;
}

double maxStickPenetration(const Model& model, const State& state) {
  double worst = 0;
  for (std::size_t k = 0; k < model.obstacles.size(); ++k) {
    if (model.obstacles[k].type == ObstacleSpec::Type::kPlane) continue;
    const Pose& pose = state.obstacles[k];
    const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
    for (const Ragdoll& r : model.ragdolls)
      for (const Stick& s : model.skeletonOf(r).sticks) {
        const int a = r.first + s.a, b = r.first + s.b;
        const Vec3 p = R.transpose() * (state.x.col(a) - pose.position);
        const Vec3 q = R.transpose() * (state.x.col(b) - pose.position);
        worst =
            std::max(worst, -stickGap(model.obstacles[k], p, q, model.radius[a], model.radius[b]));
      }
  }
  return worst;
}

double maxLimitViolation(const Model& model, const State& state) {
  double worst = 0;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    worst = std::max(worst, limitViolation(model, state.x, static_cast<int>(i)));
  return worst;
}

std::uint64_t hash(const State& state) {
  std::uint64_t h = 14695981039346656037ull;
  const auto add = [&h](const Points& p) {
    const unsigned char* bytes = reinterpret_cast<const unsigned char*>(p.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(p.size()) * sizeof(double); ++i)
      h = (h ^ bytes[i]) * 1099511628211ull;
  };
  add(state.x);
  add(state.v);
  return h;
}

}  // namespace ragdoll
