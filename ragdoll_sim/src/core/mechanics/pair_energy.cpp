#include "core/mechanics/pair_energy.h"

#include <algorithm>
#include <cmath>

#include "core/linear/stick_solver.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

class Group {
 public:
  Group(const Model& model, const std::vector<int>& bodies, State& state, GroupScratch& scratch)
      : model_(model), bodies_(bodies), state_(state), scratch_(scratch) {}

  double kineticEnergy(const Points& v) {
    double energy = 0;
    for (const int i : bodies_) {
      const auto own = v.middleCols(first(i), size(i));
      scratch_.pushed.noalias() = own * mass(i);
      energy += 0.5 * scratch_.pushed.cwiseProduct(own).sum();
    }
    return energy;
  }

  void takeOut(double rise, bool held) {
    Points& all = scratch_.all;
    all = state_.v;
    const double before = kineticEnergy(all);
    for (const int i : bodies_)
      dampInnerMotion({mass(i), rows(i).mass}, model_.systemOf(model_.ragdolls[i]).pins, 0,
                      state_.x.middleCols(first(i), size(i)),
                      state_.v.middleCols(first(i), size(i)));
    const double inner = before - kineticEnergy(state_.v);
    if (inner > rise) {
      const double keep = std::sqrt(1 - rise / inner);
      for (const int i : bodies_) {
        auto v = state_.v.middleCols(first(i), size(i));
        v += keep * (all.middleCols(first(i), size(i)) - v);
      }
    } else if (held) {
      const double left = kineticEnergy(state_.v);
      const double keep = left > 0 ? std::sqrt(std::max(0.0, 1 - (rise - inner) / left)) : 0;
      for (const int i : bodies_) state_.v.middleCols(first(i), size(i)) *= keep;
    } else {
      takeOutOfRelative(rise - inner);
    }
  }

 private:
  int first(int i) const { return model_.ragdolls[i].first; }
  int size(int i) const { return model_.skeletonOf(model_.ragdolls[i]).size(); }
  const Eigen::MatrixXd& mass(int i) const { return model_.skeletonOf(model_.ragdolls[i]).M; }

  const StickRows& rows(int i) const { return *model_.systemOf(model_.ragdolls[i]).direct.rows; }

  void takeOutOfRelative(double rise) {
    double total = 0;
    Vec3 momentum = Vec3::Zero();
    for (const int i : bodies_) {
      total += mass(i).sum();
      scratch_.pushed.noalias() = state_.v.middleCols(first(i), size(i)) * mass(i);
      momentum += scratch_.pushed.rowwise().sum();
    }
    const Vec3 common = momentum / total;
    const double relative = kineticEnergy(state_.v) - 0.5 * total * common.squaredNorm();
    const double keep = relative > 0 ? std::sqrt(std::max(0.0, 1 - rise / relative)) : 0;
    for (const int i : bodies_) {
      const bool pinned = !model_.systemOf(model_.ragdolls[i]).pins.empty();
      auto v = state_.v.middleCols(first(i), size(i));
      if (pinned)
        v *= keep;
      else
        v = (keep * (v.colwise() - common)).colwise() + common;
    }
  }

  const Model& model_;
  const std::vector<int>& bodies_;
  State& state_;
  GroupScratch& scratch_;
};

}  // namespace

void takeOutOfGroup(const Model& model, const std::vector<int>& bodies, bool held, double rise,
                    State& state, GroupScratch& scratch) {
  Group(model, bodies, state, scratch).takeOut(rise, held);
}

}  // namespace ragdoll
