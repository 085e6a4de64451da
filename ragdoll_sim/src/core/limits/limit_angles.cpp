#include "core/limits/limit_angles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/limits/limit_value.h"
#include "ragdoll_sim/core/direction.h"

namespace ragdoll {
namespace {

constexpr double kUnit = 1e-9;  ///< of a squared length: beyond, a direction is none
constexpr double kSure = 1e-6;  ///< [-] of cosines: much more than rounding

/// valueOf for one direction after the other, to the bit: neighbours share what they are made of.
class Directions {
 public:
  explicit Directions(const double* x) : x_(x) {}

  Vec3 at(const Direction& d) {
    if (d.bone) return bone(d.base[0], d.base[1]);
    if (d.swings == 0) return ofBase(d, d.c);
    if (d.swings > 1) return valueOf(d, x_);
    const Direction::Swing& swing = d.swing[0];
    if (!swing_ || swing.from != swing_->from || swing.to != swing_->to ||
        swing.axis != swing_->axis || d.base != swing_base_) {
      swing_ = &swing;
      swing_base_ = d.base;
      start_ = ofBase(d, swing.axis);
      end_ = boneDirection(swing, x_);
    }
    return swung(start_, end_, ofBase(d, d.c));
  }

 private:
  Vec3 bone(int from, int to) {
    if (from != from_ || to != to_) {
      from_ = from;
      to_ = to;
      const Vec3 e = pointAt(x_, to) - pointAt(x_, from);
      bone_ = e / std::max(e.norm(), kMinLength);
    }
    return bone_;
  }

  Vec3 ofBase(const Direction& d, const Vec3& c) {
    if (d.base != base_) {
      base_ = d.base;
      e_ = pointAt(x_, d.base[1]) - pointAt(x_, d.base[0]);
      f_ = pointAt(x_, d.base[2]) - pointAt(x_, d.base[0]);
      across_ = e_.cross(f_);
    }
    const Vec3 q = c[0] * e_ + c[1] * f_ + c[2] * across_;
    return q / std::max(q.norm(), kMinLength);
  }

  const double* x_;
  int from_ = -1, to_ = -1;
  std::array<int, 3> base_{-1, -1, -1}, swing_base_{-1, -1, -1};
  const Direction::Swing* swing_ = nullptr;
  Vec3 bone_, e_, f_, across_, start_, end_;
};

bool isUnit(const Vec3& d) { return std::abs(d.squaredNorm() - 1) < kUnit; }

}  // namespace

const LimitRow& LimitAngles::Pose::row(int k, const double* ahead) {
  LimitRow& known = row_[k];
  const Limit& limit = (*limits_)[k];
  const double* x = coordinates_.data();
  if (known.count == 0) {
    evaluateLimit(limit, reference_[k], child_[k], x, first_, known);
    at_tip_[k] = isAtTip(limit, x);
  }
  if (at_tip_[k]) {
    known.border = 0;
    evaluateLimit(limit, x, ahead, first_, known);
  }
  return known;
}

void LimitAngles::Pose::evaluate(LimitRow& row, const double* ahead) {
  const LimitRow& known = this->row(row.limit, ahead);
  row.value = known.value;
  row.count = known.count;
  std::copy_n(known.particle.begin(), known.count, row.particle.begin());
  std::copy_n(known.gradient.begin(), known.count, row.gradient.begin());
}

bool LimitAngles::Pose::is(const std::vector<Limit>& limits, int first, const double* coordinates,
                           std::size_t count) const {
  return limits_ == &limits && first_ == first && coordinates_.size() == count &&
         std::memcmp(coordinates_.data(), coordinates, count * sizeof(double)) == 0;
}

void LimitAngles::Pose::makeRoom(std::size_t limits, std::size_t count) {
  coordinates_.reserve(count);
  value_.reserve(limits);
  known_.reserve(limits);
  reference_.reserve(limits);
  child_.reserve(limits);
  cosine_.reserve(limits);
  row_.reserve(limits);
  at_tip_.reserve(limits);
}

void LimitAngles::Pose::set(const std::vector<Limit>& limits, int first, const double* coordinates,
                            std::size_t count) {
  limits_ = &limits;
  first_ = first;
  coordinates_.assign(coordinates, coordinates + count);
  value_.resize(limits.size());
  known_.assign(limits.size(), 0);
  reference_.resize(limits.size());
  child_.resize(limits.size());
  cosine_.resize(limits.size());
  row_.resize(limits.size());
  at_tip_.resize(limits.size());
  Directions references(coordinates), children(coordinates);
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const Vec3 &r = reference_[k] = references.at(limits[k].reference),
               &w = child_[k] = children.at(limits[k].child);
    const bool shows = limits[k].kind == Limit::Kind::kWithin && isUnit(r) && isUnit(w);
    cosine_[k] = shows ? r.dot(w) : std::numeric_limits<double>::quiet_NaN();
    row_[k].count = 0;
  }
}

bool LimitAngles::Pose::isFar(int k, double margin) const {
  // cos(angle - m) <= cos(angle) + m sin(angle) + m^2 / 2, which is more than is needed.
  const Limit& limit = (*limits_)[k];
  const double m = std::max(margin, 0.0);
  return limit.angle > m && cosine_[k] > limit.cos_angle + m * (limit.sin_angle + 0.5 * m) + kSure;
}

void LimitAngles::Pose::findValue(int k) {
  value_[k] = limitValue((*limits_)[k], reference_[k], child_[k], coordinates_.data());
  known_[k] = 1;
}

void LimitAngles::makeRoom(const Skeleton& skeleton) {
  for (Pose& pose : poses_)
    pose.makeRoom(skeleton.limits.size(), 3 * static_cast<std::size_t>(skeleton.size()));
}

LimitAngles::Pose& LimitAngles::at(const Model& model, const Points& x, int ragdoll) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& skeleton = model.skeletonOf(r);
  const double* body = x.data() + 3 * r.first;
  const std::size_t count = 3 * static_cast<std::size_t>(skeleton.size());
  ++calls_;
  if (poses_[last_].is(skeleton.limits, r.first, body, count)) {
    last_call_[last_] = calls_;
    return poses_[last_];
  }
  std::size_t oldest = 0;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (poses_[i].is(skeleton.limits, r.first, body, count)) {
      last_call_[i] = calls_;
      last_ = i;
      return poses_[i];
    }
    if (last_call_[i] < last_call_[oldest]) oldest = i;
  }
  last_call_[oldest] = calls_;
  last_ = oldest;
  poses_[oldest].set(skeleton.limits, r.first, body, count);
  return poses_[oldest];
}

}  // namespace ragdoll
