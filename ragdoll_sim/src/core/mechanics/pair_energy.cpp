#include "core/mechanics/pair_energy.h"

#include <algorithm>
#include <cmath>

#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

class Group {
 public:
  Group(const Model& model, const std::vector<int>& bodies, State& state)
      : model_(model), bodies_(bodies), state_(state) {}

  double kineticEnergy(const Points& v) const {
    double energy = 0;
    for (const int i : bodies_) {
      const auto own = v.middleCols(first(i), size(i));
      energy += 0.5 * (own * mass(i)).cwiseProduct(own).sum();
    }
    return energy;
  }

  void takeOut(double rise, bool held) {
    const Points all = state_.v;
    const double before = kineticEnergy(all);
    for (const int i : bodies_)
      dampInnerMotion(mass(i), model_.systemOf(model_.ragdolls[i]).pins, 0,
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

  void takeOutOfRelative(double rise) {
    double total = 0;
    Vec3 momentum = Vec3::Zero();
    for (const int i : bodies_) {
      total += mass(i).sum();
      momentum += (state_.v.middleCols(first(i), size(i)) * mass(i)).rowwise().sum();
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
};

}  // namespace

void takeOutOfGroup(const Model& model, const std::vector<int>& bodies, bool held, double rise,
                    State& state) {
  Group(model, bodies, state).takeOut(rise, held);
}

}  // namespace ragdoll
