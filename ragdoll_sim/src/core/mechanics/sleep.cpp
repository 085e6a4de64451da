#include "ragdoll_sim/core/sleep.h"

#include <algorithm>

#include "core/contact/constants.h"
#include "core/contact/contact.h"
#include "core/contact/detect.h"
#include "core/mechanics/constants.h"
#include "core/mechanics/supports.h"

namespace ragdoll {
namespace {

void wake(State& state, int ragdoll) {
  state.asleep[ragdoll] = 0;
  state.quiet[ragdoll] = 0;
}

bool moved(const Pose& a, const Pose& b) {
  return a.position != b.position || a.orientation.coeffs() != b.orientation.coeffs();
}

/// Whether the obstacle comes near the ragdoll on its way from state to end.
bool comesNear(const Model& model, const State& state, const SweptObstacle& obstacle, int ragdoll) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const int n = model.skeletonOf(r).size();
  const auto x = state.x.middleCols(r.first, n);
  const double pad = model.radius.segment(r.first, n).maxCoeff() + kWakeReach;
  return ((x.rowwise().minCoeff().array() - pad) <= obstacle.bounds.hi.array()).all() &&
         ((x.rowwise().maxCoeff().array() + pad) >= obstacle.bounds.lo.array()).all();
}

bool isHung(const Model& model, int ragdoll) {
  return !model.systemOf(model.ragdolls[ragdoll]).pins.empty();
}

struct Rest {
  double speed;  ///< [m/s]
  double time;   ///< [s]
};

Rest restOf(bool pressed, bool hung) {
  if (hung) return {kHungSpeed, kHungTime};  // a wall that it touches does not hold a swing
  if (pressed) return {kStillSpeed, kQuietTime};
  return {kFloatSpeed, kHungTime};
}

/// Applies `pass` to pairs until it passes nothing on any more.
template <class Pass>
void spread(const std::vector<BodyPair>& pairs, const Pass& pass) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const BodyPair& pair : pairs) changed = pass(pair.first, pair.second) || changed;
  }
}

}  // namespace

void wakeDisturbed(const Model& model, const Inputs& inputs, double h, State& state) {
  for (const Poke& poke : inputs.pokes)
    if (isActive(poke, state.time, h)) wake(state, poke.body.ragdoll);
  if (std::none_of(state.asleep.begin(), state.asleep.end(), [](auto a) { return a != 0; })) return;
  for (std::size_t p = 0; p < inputs.pins.size(); ++p)
    if (inputs.pins[p] != state.x.col(model.pins[p].particle)) wake(state, model.pins[p].ragdoll);
  if (inputs.obstacles.empty()) return;
  for (std::size_t k = 0; k < model.obstacles.size(); ++k) {
    if (!moved(state.obstacles[k], inputs.obstacles[k])) continue;
    const SweptObstacle obstacle =
        sweepObstacle(model.obstacles[k], state.obstacles[k], inputs.obstacles[k]);
    for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
      if (state.asleep[i] && comesNear(model, state, obstacle, static_cast<int>(i)))
        wake(state, static_cast<int>(i));
  }
}

bool wakeTouched(const std::vector<Contact>& contacts, const Points& x1, State& state) {
  bool woke = false;
  for (const Contact& c : contacts) {
    if (c.other < 0 || c.moves[0] == c.moves[1]) continue;
    const int sleeper = c.moves[0] ? c.other : c.ragdoll, mover = c.moves[0] ? c.ragdoll : c.other;
    if (!state.asleep[sleeper] || state.quiet[mover] > 0) continue;
    if (std::min(c.gapAt(x1), c.gap_start) > kNearBody) continue;
    wake(state, sleeper);
    woke = true;
  }
  return woke;
}

namespace {

/// `gripped` becomes who stands, by contacts that stick, on what does not move.
void findHeld(const Model& model, const State& state, Supports& supports) {
  std::vector<std::uint8_t>& held = supports.gripped;
  for (std::size_t i = 0; i < held.size(); ++i)
    held[i] = held[i] || state.asleep[i] || isHung(model, static_cast<int>(i));
  for (bool changed = true; changed;) {
    changed = false;
    for (const BodyPair& pair : supports.pressing) {
      if (!pair.grips || held[pair.first] == held[pair.second]) continue;
      held[pair.first] = held[pair.second] = 1;
      changed = true;
    }
  }
}

}  // namespace

void putToSleep(const Model& model, double h, Supports& all, State& state) {
  const std::vector<BodyPair>& pressing = all.pressing;
  std::vector<std::uint8_t>& pressed = all.pressed;
  findHeld(model, state, all);
  const std::vector<std::uint8_t>& held = all.gripped;
  const auto supports = [&](int i) { return pressed[i] || state.asleep[i] || isHung(model, i); };
  spread(pressing, [&](int i, int j) {
    if (supports(i) == supports(j)) return false;
    pressed[supports(i) ? j : i] = 1;
    return true;
  });
  std::vector<std::uint8_t>& still = pressed;  // takes its place, body by body
  for (std::size_t i = 0; i < still.size(); ++i) {
    const bool was_pressed = pressed[i] != 0;
    still[i] = state.asleep[i];
    if (state.asleep[i]) continue;
    const Ragdoll& r = model.ragdolls[i];
    const Rest rest = restOf(was_pressed, isHung(model, static_cast<int>(i)));
    const double v2 =
        state.v.middleCols(r.first, model.skeletonOf(r).size()).colwise().squaredNorm().maxCoeff();
    state.quiet[i] = v2 < rest.speed * rest.speed ? state.quiet[i] + h : 0;
    const bool slides = was_pressed && !held[i] && v2 > kHeldSpeed * kHeldSpeed;
    still[i] = state.quiet[i] >= rest.time && !slides;
  }
  spread(pressing, [&](int i, int j) {
    if (still[i] == still[j]) return false;
    still[i] = still[j] = 0;
    return true;
  });
  for (std::size_t i = 0; i < still.size(); ++i) {
    if (state.asleep[i] || !still[i]) continue;
    const Ragdoll& r = model.ragdolls[i];
    state.asleep[i] = 1;
    state.v.middleCols(r.first, model.skeletonOf(r).size()).setZero();
  }
}

void wakeAll(State& state) {
  std::fill(state.asleep.begin(), state.asleep.end(), 0);
  std::fill(state.quiet.begin(), state.quiet.end(), 0.0);
}

}  // namespace ragdoll
