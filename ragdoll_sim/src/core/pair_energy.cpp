#include "ragdoll_sim/core/pair_energy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ragdoll_sim/core/joint_damping.h"

namespace ragdoll {
namespace {

constexpr double kRounding = 1e-9;  ///< of the energy: less is no rise

/// Bodies that hang together by contacts; of lone bodies there are none.
std::vector<std::vector<int>> groupsOf(const Model& model, const std::vector<Contact>& contacts) {
  std::vector<int> head(model.ragdolls.size());
  std::iota(head.begin(), head.end(), 0);
  const auto find = [&head](int i) {
    while (head[i] != i) i = head[i] = head[head[i]];
    return i;
  };
  for (const Contact& c : contacts) head[find(c.ragdoll)] = find(c.other);
  std::vector<std::vector<int>> groups(head.size());
  for (std::size_t i = 0; i < head.size(); ++i)
    groups[find(static_cast<int>(i))].push_back(static_cast<int>(i));
  groups.erase(std::remove_if(groups.begin(), groups.end(),
                              [](const std::vector<int>& group) { return group.size() < 2; }),
               groups.end());
  return groups;
}

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

  double work(const Points& x0, const Points* force) const {
    double work = 0;
    for (const int i : bodies_) {
      const Points moved =
          state_.x.middleCols(first(i), size(i)) - x0.middleCols(first(i), size(i));
      work += model_.gravity.dot((moved * mass(i)).rowwise().sum());
      if (force) work += force->middleCols(first(i), size(i)).cwiseProduct(moved).sum();
    }
    return work;
  }

  void takeOut(double rise) {
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

int limitPairEnergy(const Model& model, const std::vector<Contact>& contacts, const Points& x0,
                    const Points& v0, const Points* force, State& state) {
  int limited = 0;
  for (const std::vector<int>& bodies : groupsOf(model, contacts)) {
    Group group(model, bodies, state);
    const double before = group.kineticEnergy(v0);
    const double rise = group.kineticEnergy(state.v) - before - group.work(x0, force);
    if (!(rise > kRounding * std::max(before, group.kineticEnergy(state.v)))) continue;
    group.takeOut(rise);
    limited += static_cast<int>(bodies.size());
  }
  return limited;
}

}  // namespace ragdoll
