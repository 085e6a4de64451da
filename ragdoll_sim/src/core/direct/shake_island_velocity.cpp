// Velocity stage of bodies that touch each other, and what bounces.
#include <algorithm>

#include "core/direct/shake_island.h"

namespace ragdoll {

void ShakeIsland::finish(double h, bool leapfrog, bool impact) {
  if (failed()) return;
  s_.touching.clear();
  s_.warm.clear();
  for (std::size_t i = 0; i < s_.pairs.size(); ++i) {
    if (gapAt(s_.pairs[i]) >= steps_[0].touching_) continue;
    s_.touching.push_back(s_.pairs[i]);
    const bool known = s_.total.size() > 0 && s_.row[i] >= 0;
    for (int k = 0; k < 3; ++k) s_.warm.push_back(known ? s_.total[s_.row[i] + k] / h : 0.0);
  }
  for (ShakeStep& step : steps_) step.move(h, leapfrog);
  pushVelocities(true, impact, h);
  for (ShakeStep& step : steps_) std::swap(step.body_.start, step.body_.end);
}

void ShakeIsland::bounce() {
  for (ShakeStep& step : steps_) {
    step.scratch_.dx.setZero(3, step.n_);
    step.body_.start.setPose(step.rows_, step.xData());
    ws_.x1.middleCols(step.ragdoll_.first, step.n_) = step.x();
    step.restrictToTouching(0);
  }
  s_.touching.clear();
  for (const Contact& c : s_.pairs)
    if (gapAt(c) < steps_[0].touching_) s_.touching.push_back(c);
  s_.warm.assign(3 * s_.touching.size(), 0.0);
  pushVelocities(false, true, 0);
}

void ShakeIsland::pushVelocities(bool at_end, bool impact, double h) {
  s_.joint.clear();
  for (ShakeStep& step : steps_) {
    step.gatherTouching(h);
    s_.joint.addBody(step.body_.schur);
  }
  const int own = s_.joint.size();
  for (std::size_t i = 0; i < s_.touching.size(); ++i) addRows(s_.touching[i], static_cast<int>(i));
  const int size = s_.joint.size();
  if (size == 0) return;
  const auto sticksOf = [&](ShakeStep& step) -> StickSolver& {
    return at_end ? step.body_.end : step.body_.start;
  };
  for (ShakeStep& step : steps_)
    if (!step.body_.schur.empty()) step.body_.schur.assemble(step.rows_, sticksOf(step));
  const auto push = [&](bool blow) {
    s_.b.resize(size);
    s_.p.setZero(size);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      ShakeStep& step = steps_[k];
      if (blow)
        step.fillBlow();
      else
        step.fillRates();
      const int first = s_.joint.firstOf(static_cast<int>(k)), rows = step.ownRows();
      s_.b.segment(first, rows) = step.scratch_.b;
      if (!blow)
        s_.p.segment(first, rows) =
            Eigen::Map<const Eigen::VectorXd>(step.scratch_.warm.data(), rows);
    }
    for (std::size_t i = 0; i < s_.touching.size(); ++i) {
      const Contact& c = s_.touching[i];
      Vec3 rate = Vec3::Zero();
      for (int k = 0; k < 4; ++k) rate += c.weight[k] * state_.v.col(c.particle[k]);
      for (int d = 0; d < 3; ++d) {
        const int row = own + 3 * static_cast<int>(i) + d;
        s_.b[row] = s_.joint.row(row).direction.dot(rate);
        if (!blow) s_.p[row] = s_.warm[3 * i + d];
      }
    }
    s_.joint.solve(s_.b, s_.p);
    s_.joint.split(s_.p, s_.parts);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      ShakeStep& step = steps_[k];
      Schur& schur = step.body_.schur;
      if (!schur.empty()) schur.move(s_.parts[k], step.vData());
    }
  };
  if (!impact || h > 0) {
    for (ShakeStep& step : steps_)
      if (impact) step.holdArriving();
    push(false);
  }
  if (impact) push(true);
}

}  // namespace ragdoll
