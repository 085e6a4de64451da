// Whether a moment is one that step() can go on from: what came as bytes may hold anything.
#include <algorithm>
#include <cmath>
#include <set>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/snapshot.h"
#include "ragdoll_sim/core/solver_presets.h"

namespace ragdoll {
namespace {

constexpr double kUnitTolerance = 1e-6;  ///< an orientation is this close to length 1

void require(bool ok, const char* what) {
  if (!ok) throw Error("snapshot", std::string("is damaged: ") + what);
}

template <class Numbers>
bool allFinite(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); });
}

bool isIndex(int i, std::size_t count) { return i >= 0 && static_cast<std::size_t>(i) < count; }

/// Positions or velocities that a run can come to.
template <class Numbers>
bool areReached(const Numbers& numbers) {
  return (numbers.array().abs() <= kLargestState).all();
}

/// Whether the particle (column of the state) is one of the ragdoll's.
bool isPart(const Model& model, int ragdoll, int particle) {
  if (!isIndex(ragdoll, model.ragdolls.size())) return false;
  const Ragdoll& r = model.ragdolls[ragdoll];
  return isIndex(particle - r.first, static_cast<std::size_t>(model.skeletonOf(r).size()));
}

void checkState(const Model& model, const State& state) {
  const auto bodies = model.ragdolls.size();
  require(state.x.cols() == model.size() && state.v.cols() == model.size() &&
              state.asleep.size() == bodies && state.quiet.size() == bodies &&
              state.obstacles.size() == model.obstacles.size() &&
              state.allowed.cols() == startAllowed(model).cols(),
          "its sizes are not those of the scene");
  require(areReached(state.x) && areReached(state.v),
          "it holds a position or velocity that no run comes to");
  require(std::isfinite(state.time) && state.allowed.allFinite() && allFinite(state.quiet) &&
              allFinite(state.multipliers),
          "it holds numbers that are not finite");
  for (const Pose& pose : state.obstacles)
    require(areReached(pose.position) &&
                std::abs(pose.orientation.coeffs().norm() - 1) < kUnitTolerance,
            "an obstacle is nowhere");
  for (const CachedImpulse& impulse : state.impulses)
    require(isIndex(impulse.ragdoll, bodies) && impulse.impulse.allFinite(),
            "a contact of a ragdoll out of range");
}

void checkPokes(const Model& model, const std::vector<Poke>& pokes) {
  for (const Poke& poke : pokes) {
    const auto& particles = poke.body.particles;
    require(!particles.empty() && poke.body.weight.size() == particles.size() &&
                std::all_of(particles.begin(), particles.end(),
                            [&](int p) { return isPart(model, poke.body.ragdoll, p); }),
            "a poke of a particle out of range");
    require(poke.force.allFinite() && poke.point.allFinite() && std::isfinite(poke.start) &&
                std::isfinite(poke.duration) && allFinite(poke.body.weight),
            "a poke's numbers are not finite");
  }
}

void checkPins(const Model& model, const std::vector<Pin>& pins) {
  std::set<int> held;
  for (const Pin& pin : pins) {
    require(isPart(model, pin.ragdoll, pin.particle), "a pin of a particle out of range");
    require(held.insert(pin.particle).second, "a particle is pinned twice");
    require(areReached(pin.target), "a pin holds its particle where no run comes to");
  }
}

void checkSavedSolver(const SolverSpec& solver) {
  const auto& presets = presetNames();
  require(std::count(presets.begin(), presets.end(), solver.preset) > 0 &&
              isIndex(static_cast<int>(solver.method), 4) &&
              isIndex(static_cast<int>(solver.numbers), 2) && solver.threads >= 0 &&
              isIndex(static_cast<int>(solver.integrator), 5),
          "its solver is none");
}

}  // namespace

void checkFits(const Model& model, const Moment& moment) {
  checkSavedSolver(moment.solver);
  require(moment.gravity.allFinite(), "its gravity is not finite");
  checkPins(model, moment.pins);
  checkPokes(model, moment.pokes);
  checkState(model, moment.state);
}

}  // namespace ragdoll
