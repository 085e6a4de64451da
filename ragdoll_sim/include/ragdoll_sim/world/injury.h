// Indicators of injury, step by step: of a head from its acceleration, of every region from what
// touches it. Indicators, no proof of safety; with rigid contact they depend on the step
// (docs/injury.md).
#pragma once

#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/world/contacts.h"

namespace ragdoll {

/// The head injury criterion [Versace1971] over at most 15 ms, and the peak:
///   HIC15 = max over t2 - t1 <= 15 ms of (t2 - t1) (mean of a over them)^2.5,  a in g, times in s
class HeadInjury {
 public:
  static constexpr double kWindow = 0.015;  ///< [s]
  static constexpr double kG = 9.80665;     ///< [m/s^2] that a is told in

  /// The next step: mean acceleration [m/s^2] over h [s].
  void add(double acceleration, double h);

  double hic15() const { return hic_; }
  double peakG() const { return peak_; }

 private:
  struct Mark {
    double time, sum;  ///< [s], [g s] up to there
  };
  std::deque<Mark> marks_{{0, 0}};  ///< of the last kWindow
  double hic_ = 0, peak_ = 0;
};

/// Of every segment whose name has "head" in it, at its centre: a bone's `to`, a group's mean.
class HeadInjuries {
 public:
  explicit HeadInjuries(const Model& model);

  void begin(const State& state);                    ///< before a step
  void end(const Model& model, const State& state);  ///< after it

  struct Head {
    std::string name;            ///< "ragdoll/head"
    std::vector<int> particles;  ///< columns of the state
    Vec3 before = Vec3::Zero();  ///< [m/s]
    HeadInjury injury;
  };
  const std::vector<Head>& heads() const { return heads_; }

 private:
  std::vector<Head> heads_;
};

/// The largest that each region of a body had to take, of either side of each contact.
class RegionLoads {
 public:
  /// A step's contacts (Contacts::last) of h [s].
  void add(const Model& model, const std::vector<ContactImpulse>& contacts, double h);
  /// Impacts that begin; those that are over do not count again.
  void add(const Model& model, const std::vector<ImpactReport>& impacts);

  struct Load {
    double peak_force = 0;       ///< [N] of all contacts of the region together
    double approach_energy = 0;  ///< [J] of one impact: m v^2 / 2, m the effective mass
  };
  /// Per ragdoll and region (regionName).
  using Loads = std::map<std::pair<int, std::string>, Load>;
  const Loads& loads() const { return loads_; }

 private:
  Loads loads_;
};

}  // namespace ragdoll
