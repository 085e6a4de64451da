#include "ragdoll_sim/core/start_pose.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/joint_checks.h"
#include "ragdoll_sim/core/limit_projection.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/relax.h"
#include "ragdoll_sim/core/rest_pose.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/system.h"

namespace ragdoll {
namespace {

constexpr double kOutside = M_PI / 180;  ///< [rad] less does no harm
constexpr double kThere = 1e-4;          ///< [rad] of a corrected joint
constexpr double kLengths = 1e-4;        ///< [-] and of its sticks
constexpr double kApart = 0.1;           ///< [-] a stick this far from its length is drawn in later
constexpr int kSweeps = 5000;
constexpr double kLongStep = 1e6;  ///< [s] in which a spring that presses arrives

/// One ragdoll alone, its sticks as long as they start, its hard limits.
class Corrector {
 public:
  Corrector(const Model& model, int ragdoll, const std::vector<int>& fixed) {
    const Ragdoll& r = model.ragdolls[ragdoll];
    Skeleton skeleton = model.skeletonOf(r);
    x_ = model.start_position.middleCols(r.first, skeleton.size());
    const auto soft = [](const auto& limit) { return limit.compliance > 0; };
    const auto drop_soft = [&](auto& limits) {
      limits.erase(std::remove_if(limits.begin(), limits.end(), soft), limits.end());
    };
    drop_soft(skeleton.limits);
    drop_soft(skeleton.plane_limits);
    for (std::vector<Stick>* sticks : {&skeleton.sticks, &skeleton.hidden_sticks})
      for (Stick& k : *sticks) k.length = std::max((x_.col(k.a) - x_.col(k.b)).norm(), kMinLength);
    std::vector<std::string> known;  // those of the model itself have been told
    alone_.systems = {buildSystem(skeleton, 0, fixed, known)};
    alone_.skeletons = {std::move(skeleton)};
    alone_.ragdolls = {{r.name, 0, 0, 0}};
    alone_.start_position = x_;
    state_.asleep = {0};
    state_.x = x_;
    state_.allowed = startAllowed(alone_);
  }

  bool run() {
    for (int i = 0; i < kSweeps; ++i) {
      if (i % 50 == 0) {
        if (isRight()) return true;
        limits_.prepare(alone_, state_, x_, kLongStep);
      }
      const System& s = alone_.systems[0];
      s.lumped ? relaxSticks(s.relaxed, x_.data())
               : relaxCoupledSticks(s.coupled, s.relaxed_BW, s.relaxed_G, x_);
      limits_.sweep(alone_, x_);
    }
    return isRight();
  }

  const Points& positions() const { return x_; }

 private:
  bool isRight() const {
    if (!x_.allFinite() || limitViolation(alone_, x_, 0) > kThere) return false;
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
    if (by[j] > kOutside)
      text += (text.empty() ? "" : ", ") + ("joint '" + s.joints[j].name + "' " + degrees(by[j])) +
              " outside its limit";
  return text;
}

}  // namespace

void correctStart(Model& model, int ragdoll, const std::vector<int>& placed) {
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
  for (const int i : placed)
    if (!std::count(held.begin(), held.end(), i)) held.push_back(i);
  std::sort(held.begin(), held.end());
  for (const std::vector<int>* fixed : {static_cast<const std::vector<int>*>(&held), &pins}) {
    Corrector corrector(model, ragdoll, *fixed);
    if (!corrector.run()) continue;
    start = corrector.positions();
    model.warnings.push_back(told + "; corrected, moved: " + movesText(s, before, start));
    return;
  }
  model.warnings.push_back(told +
                           "; no way was found to correct it, and the first steps push back");
}

}  // namespace ragdoll
