#include "core/loading/start_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/limits/limit_projection.h"
#include "core/linear/relax.h"
#include "core/loading/joint_checks.h"
#include "core/loading/rest_pose.h"
#include "core/loading/system.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {
namespace {

constexpr double kInside = 2e-4;      ///< [rad] so far inside its limits a joint is brought
constexpr double kThere = 1e-4;       ///< [rad] give or take this
constexpr double kLengths = 1e-6;     ///< [-] and with sticks of this accuracy
constexpr double kApart = 0.1;        ///< [-] a stick this far from its length is drawn in later
constexpr double kJoined = 1e-9;      ///< [m] so near a point is where its rigid group has it
constexpr double kToldLength = 1e-3;  ///< [m] a stick this far from its length is told
constexpr double kRoundingAngle = 1e-13;  ///< [rad] a joint so far outside is at its limit
constexpr int kSweeps = 5000;
constexpr double kLongStep = 1e6;  ///< [s] in which a spring that presses arrives

void setAngle(Limit& limit, double angle) {
  limit.angle = angle;
  limit.sin_angle = std::sin(angle);
  limit.cos_angle = std::cos(angle);
}

/// One ragdoll alone at x, its sticks as long as they start, its hard limits: regions of planes by
/// their borders, since the way back to an allowed direction may be long.
class Corrector {
 public:
  Corrector(Skeleton skeleton, const Points& x, const std::vector<int>& fixed) : x_(x) {
    std::vector<Limit>& limits = skeleton.limits;
    limits.erase(std::remove_if(limits.begin(), limits.end(),
                                [](const Limit& limit) { return limit.compliance > 0; }),
                 limits.end());
    for (Limit& limit : limits) {
      limit.region = false;
      setAngle(limit, limit.angle - std::min(kInside, limit.angle / 4));
    }
    skeleton.plane_limits.clear();
    skeleton.lumped = false;  // sticks alone take too long to hold a flat group flat
    for (std::vector<Stick>* sticks : {&skeleton.sticks, &skeleton.hidden_sticks})
      for (Stick& k : *sticks) k.length = std::max((x_.col(k.a) - x_.col(k.b)).norm(), kMinLength);
    std::vector<std::string> known;  // those of the model itself have been told
    alone_.systems = {buildSystem(skeleton, 0, fixed, known)};
    alone_.skeletons = {std::move(skeleton)};
    alone_.ragdolls = {{"", 0, 0, 0}};
    alone_.start_position = x_;
    state_.asleep = {0};
    state_.x = x_;
    state_.allowed.resize(3, 0);
  }

  bool run() {
    for (int i = 0; i < kSweeps; ++i) {
      if (i % 50 == 0) {
        if (isRight(kThere)) return true;
        limits_.prepare(alone_, state_, x_, kLongStep);
      }
      const System& s = alone_.systems[0];
      relaxCoupledSticks(s.coupled, s.relaxed_BW, s.relaxed_G, x_);
      limits_.sweep(alone_, x_);
    }
    return isRight(kInside + kThere);  // limits that leave no room
  }

  const Points& positions() const { return x_; }

 private:
  bool isRight(double violation) const {
    if (!x_.allFinite() || limitViolation(alone_, x_, 0) > violation) return false;
    const std::vector<Stick>& sticks = alone_.skeletons[0].sticks;
    return std::all_of(sticks.begin(), sticks.end(), [&](const Stick& k) {
      return std::abs((x_.col(k.a) - x_.col(k.b)).norm() / k.length - 1) < kLengths;
    });
  }

  Model alone_;
  State state_;
  Points x_;
  LimitProjection limits_;
};

bool isApart(const Skeleton& s, const Points& x) {
  return std::any_of(s.sticks.begin(), s.sticks.end(), [&](const Stick& k) {
    return std::abs((x.col(k.a) - x.col(k.b)).norm() / k.length - 1) > kApart;
  });
}

/// "joint 'right_knee' 40.0 deg outside its limit, ..."; "" if all are inside.
std::string outside(const Skeleton& s, const Points& x) {
  std::vector<double> by(s.joints.size(), 0.0);
  for (const Limit& limit : s.limits)
    if (limit.compliance == 0 && !limit.region)
      by[limit.joint] = std::max(by[limit.joint], -limitValue(limit, x.data()));
  for (const PlaneLimit& limit : s.plane_limits)
    if (limit.compliance == 0)
      by[limit.joint] = std::max(by[limit.joint], planeViolation(limit, x.data()));
  std::string text;
  for (std::size_t j = 0; j < by.size(); ++j)
    if (by[j] > kNegligibleAngle)
      text += (text.empty() ? "" : ", ") + ("joint '" + s.joints[j].name + "' " + degrees(by[j])) +
              " outside its limit";
  return text;
}

/// A rest pose that the digits of a file put beside the border of a hard limit is on it. The first
/// step would draw it back, the faster the shorter it is.
void reachRest(Limit& limit, const Points& rest) {
  const double violated = -limitValue(limit, rest.data());
  if (limit.compliance > 0 || violated < kRoundingAngle || violated > kNegligibleAngle) return;
  setAngle(limit, limit.angle + violated);
  // Near an axis C grows slower than the angle.
  const double left = -limitValue(limit, rest.data());
  if (left > 0 && left < violated) setAngle(limit, limit.angle + left * left / (violated - left));
}

}  // namespace

Points startPose(const SkeletonSpec& spec, Skeleton& s) {
  const std::string what = outside(s, s.rest);
  if (what.empty()) {
    for (Limit& limit : s.limits) reachRest(limit, s.rest);
    return s.rest;
  }
  Corrector corrector(s, s.rest, {});
  if (!corrector.run())
    throw Error(spec.where, "joints: the rest pose leaves " + what +
                                ", and no pose near it keeps all limits; change the limits or the "
                                "particles' positions");
  s.warnings.push_back(
      spec.where + ": the rest pose leaves " + what +
      "; bodies start corrected, moved: " + movesText(s, s.rest, corrector.positions()));
  return corrector.positions();
}

namespace {

/// Brings joints that place left outside their limits back.
void correctLimits(const RagdollSpec& spec, Model& model, int ragdoll) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  auto start = model.start_position.middleCols(r.first, s.size());
  const Points before = start;
  const std::string what = outside(s, before);
  if (what.empty()) return;
  const std::string told = "ragdoll '" + r.name + "': place leaves " + what;
  if (isApart(s, before)) {
    model.warnings.push_back(told +
                             "; its sticks are off their lengths, too, and the first steps "
                             "draw both in");
    return;
  }
  const std::vector<int>& pins = model.systemOf(r).pins;
  std::vector<int> held = pins;
  for (const auto& place : spec.place)
    if (const int i = s.particle(place.first); !std::count(held.begin(), held.end(), i))
      held.push_back(i);
  std::sort(held.begin(), held.end());
  for (const std::vector<int>* fixed : {static_cast<const std::vector<int>*>(&held), &pins}) {
    Corrector corrector(s, before, *fixed);
    if (!corrector.run()) continue;
    start = corrector.positions();
    model.warnings.push_back(told + "; corrected, moved: " + movesText(s, before, start));
    return;
  }
  throw Error(spec.where + ".place",
              told + (pins.empty() ? ", and no pose near it keeps all limits; place it within them"
                                   : ", and the pins leave no way to correct it; place it within "
                                     "the limits, or pin fewer particles"));
}

/// A rigid group is whole from the start, though single points of it were placed.
void joinGroups(Model& model, const Ragdoll& r) {
  const Skeleton& s = model.skeletonOf(r);
  const System& system = model.systemOf(r);
  const bool relaxed = model.solver.method == Method::kJakobsen && system.lumped;
  if (relaxed || s.groups.empty()) return;
  auto start = model.start_position.middleCols(r.first, s.size());
  const Points before = start, together = before * system.direct.affine.transpose();
  if ((together - before).cwiseAbs().maxCoeff() <= kJoined) return;
  start = together;
  model.warnings.push_back("ragdoll '" + r.name +
                           "': place takes points of a rigid group apart; joined again, moved: " +
                           movesText(s, before, together));
}

/// Warns of the stick that is farthest from its length.
void tellLengths(Model& model, const Ragdoll& r) {
  const Skeleton& s = model.skeletonOf(r);
  const auto x = model.start_position.middleCols(r.first, s.size());
  const Stick* worst = nullptr;
  double off = kToldLength;
  for (const Stick& k : s.sticks) {
    const double by = (x.col(k.a) - x.col(k.b)).norm() - k.length;
    if (std::abs(by) <= std::abs(off)) continue;
    off = by;
    worst = &k;
  }
  if (!worst) return;
  char by[32];
  std::snprintf(by, sizeof by, "%.1f mm", 1e3 * std::abs(off));
  model.warnings.push_back("ragdoll '" + r.name + "': place leaves stick " + s.particles[worst->a] +
                           "-" + s.particles[worst->b] + " " + by +
                           (off > 0 ? " too long" : " too short") +
                           ", the most of all; the first steps draw sticks to their lengths");
}

}  // namespace

void correctStart(const RagdollSpec& spec, Model& model, int ragdoll) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  joinGroups(model, r);
  correctLimits(spec, model, ragdoll);
  tellLengths(model, r);
}

}  // namespace ragdoll
