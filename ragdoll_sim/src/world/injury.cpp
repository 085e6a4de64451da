#include "ragdoll_sim/world/injury.h"

#include <algorithm>
#include <cmath>

namespace ragdoll {
namespace {

constexpr double kRounding = 1e-9;  ///< of the window: it may be a whole number of steps

Vec3 velocityOf(const HeadInjuries::Head& head, const State& state) {
  Vec3 sum = Vec3::Zero();
  for (const int i : head.particles) sum += state.v.col(i);
  return sum / static_cast<double>(head.particles.size());
}

/// Each side of a contact: ragdoll, its particles, +1 for the side that the impulse is told of.
template <class Take>
void forEachSide(const ContactImpulse& c, const Take& take) {
  take(c.ragdoll, c.particle, 1.0);
  if (c.obstacle < 0) take(c.other >= 0 ? c.other : c.ragdoll, c.other_particle, -1.0);
}

}  // namespace

void HeadInjury::add(double acceleration, double h) {
  const double g = acceleration / kG;
  peak_ = std::max(peak_, g);
  // A constant mean within the step: its best part is never less than the step, up to the window.
  if (h > kWindow) {
    hic_ = std::max(hic_, kWindow * std::pow(g, 2.5));
    marks_ = {{marks_.back().time + h, marks_.back().sum + g * h}};
    return;
  }
  marks_.push_back({marks_.back().time + h, marks_.back().sum + g * h});
  const Mark& now = marks_.back();
  while (now.time - marks_.front().time > kWindow * (1 + kRounding)) marks_.pop_front();
  for (auto mark = marks_.begin(); mark + 1 != marks_.end(); ++mark) {
    const double span = now.time - mark->time;
    hic_ = std::max(hic_, span * std::pow((now.sum - mark->sum) / span, 2.5));
  }
}

HeadInjuries::HeadInjuries(const Model& model) {
  for (const Ragdoll& r : model.ragdolls)
    for (const Segment& s : model.skeletonOf(r).segments) {
      if (s.name.find("head") == std::string::npos) continue;
      Head head;
      head.name = r.name + "/" + s.name;
      head.particles = s.particles;
      if (s.particles.size() == 2) head.particles.erase(head.particles.begin());
      for (int& p : head.particles) p += r.first;
      heads_.push_back(std::move(head));
    }
}

void HeadInjuries::begin(const State& state) {
  for (Head& head : heads_) head.before = velocityOf(head, state);
}

void HeadInjuries::end(const Model& model, const State& state) {
  const double h = model.solver.step;
  for (Head& head : heads_) head.injury.add((velocityOf(head, state) - head.before).norm() / h, h);
}

void RegionLoads::add(const Model& model, const std::vector<ContactImpulse>& contacts, double h) {
  std::map<std::pair<int, std::string>, Vec3> sums;
  for (const ContactImpulse& c : contacts)
    forEachSide(c, [&](int ragdoll, const std::array<int, 2>& particles, double sign) {
      const auto key = std::pair(ragdoll, regionName(model, ragdoll, particles));
      sums.try_emplace(key, Vec3::Zero()).first->second += sign * c.impulse;
      Load& load =
          loads_[key];  // a spring's peak lies within the step, where others' are not known
      load.peak_force = std::max(load.peak_force, peakForce(c, h));
    });
  for (const auto& [key, impulse] : sums) {
    Load& load = loads_[key];
    load.peak_force = std::max(load.peak_force, impulse.norm() / h);
  }
}

void RegionLoads::add(const Model& model, const std::vector<ImpactReport>& impacts) {
  for (const ImpactReport& impact : impacts) {
    if (impact.over) continue;
    const ContactImpulse& c = impact.contact;
    const double energy = 0.5 * c.effective_mass * c.approach * c.approach;
    forEachSide(c, [&](int ragdoll, const std::array<int, 2>& particles, double) {
      Load& load = loads_[{ragdoll, regionName(model, ragdoll, particles)}];
      load.approach_energy = std::max(load.approach_energy, energy);
    });
  }
}

}  // namespace ragdoll
