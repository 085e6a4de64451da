#include "ragdoll_sim/world/contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "cone_balance.h"
#include "pin_impulses.h"
#include "ragdoll_sim/core/findings.h"

namespace ragdoll {
namespace {

constexpr double kNoRest = 1e-13;     ///< of a body's momenta: a rest below is rounding
constexpr double kLeastShare = 1e-6;  ///< of the strongest contact: what any contact can take
constexpr double kUnknown = 1e8;    ///< likewise: sleepers' contacts with each other take the rest
constexpr double kApart = 1e-2;     ///< likewise, but for those
constexpr double kPressing = 1e-5;  ///< [m] that are farther apart
constexpr double kNoForce = 1e-12;  ///< of the weight: no contact
constexpr std::uint32_t kImpactsOfAStep = 256;  ///< ids that a step has

auto keyOf(const ContactImpulse& c) {
  return std::tie(c.ragdoll, c.obstacle, c.other, c.particle, c.other_particle);
}

bool isBefore(const ContactImpulse& a, const ContactImpulse& b) { return keyOf(a) < keyOf(b); }

/// Of two parts, by how much each pressed.
Vec3 meanNormal(const ContactImpulse& a, const ContactImpulse& b) {
  const Vec3 sum = std::max(0.0, a.impulse.dot(a.normal)) * a.normal +
                   std::max(0.0, b.impulse.dot(b.normal)) * b.normal;
  return sum.norm() > 0 ? Vec3(sum.normalized()) : b.normal;
}

/// A later part of the same contact.
void addTo(ContactImpulse& sum, const ContactImpulse& next) {
  const Vec3 normal = meanNormal(sum, next);
  const Vec3 impulse = sum.impulse + next.impulse;
  const double approach = std::max(sum.approach, next.approach);
  const double mass = next.effective_mass > 0 ? next.effective_mass : sum.effective_mass;
  const double slip = next.effective_mass > 0 ? next.slip : sum.slip;
  const double peak = std::max(sum.peak, next.peak);
  const double friction = std::max(sum.friction, next.friction);
  sum = next;
  sum.friction = friction;
  sum.normal = normal;
  sum.peak = peak;
  sum.impulse = impulse;
  sum.approach = approach;
  sum.effective_mass = mass;
  sum.slip = slip;
  sum.normal = turnedIntoCone(sum);
}

/// A later part of it in the same step: it pressed where both did in the mean.
void addPart(ContactImpulse& sum, const ContactImpulse& next) {
  const double before = sum.impulse.norm(), after = next.impulse.norm();
  const Vec3 point = before + after > 0
                         ? Vec3(sum.point + after / (before + after) * (next.point - sum.point))
                         : next.point;
  addTo(sum, next);
  sum.point = point;
}

bool isPinned(const Model& model, int ragdoll) {
  return !model.systemOf(model.ragdolls[ragdoll]).pins.empty();
}

/// The other body of a contact that momentum goes to; -1: none.
int partnerOf(const ContactImpulse& c) {
  return c.obstacle < 0 && c.other >= 0 && c.other != c.ragdoll ? c.other : -1;
}

bool isInner(const ContactImpulse& c) { return c.obstacle < 0 && partnerOf(c) < 0; }

bool isSame(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

bool isSame(const CachedImpulse& a, const CachedImpulse& b) {
  return a.ragdoll == b.ragdoll && a.a == b.a && a.b == b.b && a.obstacle == b.obstacle &&
         a.other == b.other && a.impulse == b.impulse;
}

template <class T>
bool areSame(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const T& x, const T& y) { return isSame(x, y); });
}

/// In all that tells what presses on sleepers.
bool restsAlike(const State& a, const State& b) {
  return a.x == b.x && a.v == b.v && areSame(a.obstacles, b.obstacles) &&
         areSame(a.impulses, b.impulses);
}

}  // namespace

Contacts::Contacts(const Model& model) {
  for (const Ragdoll& r : model.ragdolls) masses_.push_back(pointMasses(model.skeletonOf(r)));
  restart(model);
}

void Contacts::restart(const Model& model) {
  const std::vector<ImpactReport> impacts = std::move(report_.impacts);
  report_ = {};
  report_.impacts = impacts;
  step_.clear();
  forget();
  pins_.assign(model.pins.size(), Vec3::Zero());
  report_.on_pins = pins_;
  report_.on_obstacles.assign(model.obstacles.size(), Vec3::Zero());
  report_.moments = report_.on_obstacles;
}

void Contacts::begin(const State& state) {
  before_ = state.v;
  places_ = state.x;
  slept_ = state.asleep;
}

Vec3 Contacts::momentumOf(const Model& model, int ragdoll, const State& state) const {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  const auto change = state.v.middleCols(r.first, s.size()) - before_.middleCols(r.first, s.size());
  return change * s.M.rowwise().sum();
}

void Contacts::end(const Model& model, const Inputs& inputs, const State& state) {
  bool any = false, all = true;
  for (std::size_t i = 0; i < slept_.size(); ++i) {
    slept_[i] = slept_[i] && state.asleep[i];  // all the step long
    any = any || slept_[i];
    all = all && slept_[i];
  }
  const bool calm = all && nothingHappened(model, inputs, state);
  if (!calm || !still_ || !restsAlike(*still_, state)) {
    step_ = log_.impulses;
    if (any) appendPressing(model, state, slept_, step_);
    merge();
    balance(model, inputs, state);
    still_.reset();
    if (calm) still_ = state;
  }
  follow(model, state);
  collect(model, state);
}

/// Then step_ is what the state alone tells, and the next step's, if that is alike.
bool Contacts::nothingHappened(const Model& model, const Inputs& inputs, const State& state) const {
  const double h = model.solver.step;
  return log_.impulses.empty() && places_ == state.x && before_ == state.v &&
         std::none_of(inputs.pokes.begin(), inputs.pokes.end(),
                      [&](const Poke& poke) { return isActive(poke, state.time - h, h); });
}

/// One entry for each contact of the step, in an order of their own, where its parts pressed in the
/// mean.
void Contacts::merge() {
  std::stable_sort(step_.begin(), step_.end(), isBefore);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < step_.size(); ++i) {
    if (kept > 0 && keyOf(step_[kept - 1]) == keyOf(step_[i]))
      addPart(step_[kept - 1], step_[i]);
    else
      step_[kept++] = step_[i];
  }
  step_.resize(kept);
}

void Contacts::balance(const Model& model, const Inputs& inputs, const State& state) {
  const double h = model.solver.step;
  const std::size_t count = model.ragdolls.size();
  std::vector<Vec3> rest(count, Vec3::Zero());
  std::vector<double> scale(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const Ragdoll& r = model.ragdolls[i];
    const double mass = masses_[i].sum();
    rest[i] = momentumOf(model, static_cast<int>(i), state) - h * mass * model.gravity;
    const auto v = before_.middleCols(r.first, model.skeletonOf(r).size());
    scale[i] = mass * (h * model.gravity.norm() + v.cwiseAbs().maxCoeff());
    if (model.solver.damping > 0)
      rest[i] +=
          (1 - std::exp(-model.solver.damping * h)) * (v * model.skeletonOf(r).M.rowwise().sum());
  }
  const double time = state.time - h;
  for (const Poke& poke : inputs.pokes)
    if (isActive(poke, time, h)) rest[poke.body.ragdoll] -= h * poke.force;
  for (const ContactImpulse& c : step_) {
    if (isInner(c)) continue;
    rest[c.ragdoll] -= c.impulse;
    if (partnerOf(c) >= 0) rest[partnerOf(c)] += c.impulse;
  }
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    if (isPinned(model, static_cast<int>(i)) || !(rest[i].norm() > kNoRest * scale[i]))
      rest[i].setZero();
    any = any || !rest[i].isZero(0);
  }
  if (any) spread(model, rest);
  putOnPins(model, inputs, state);
  // What only came near.
  const double least = kNoForce * h * model.gravity.norm();
  step_.erase(std::remove_if(step_.begin(), step_.end(),
                             [&](const ContactImpulse& c) {
                               return c.impulse.norm() <= least * masses_[c.ragdoll].sum();
                             }),
              step_.end());
}

/// Over the contacts, with weights by their size. What sleepers give each other no state has: it is
/// what is left of their weight when what obstacles give stays as it is.
void Contacts::spread(const Model& model, const std::vector<Vec3>& rest) {
  double strongest = 0;
  for (const ContactImpulse& c : step_)
    if (!isInner(c)) strongest = std::max(strongest, c.impulse.norm());
  const auto weight = [&](const ContactImpulse& c) {
    const bool unknown =
        c.impulse.isZero(0) && partnerOf(c) >= 0 && slept_[c.ragdoll] && slept_[partnerOf(c)];
    if (unknown && strongest > 0) return c.depth > -kPressing ? kUnknown : kApart;
    return strongest > 0 ? c.impulse.norm() / strongest + kLeastShare : 1;
  };
  std::vector<int> place(rest.size(), -1);
  std::vector<Vec3> wanted;
  const auto placeOf = [&](int ragdoll) {
    if (ragdoll < 0 || isPinned(model, ragdoll)) return -1;
    if (place[ragdoll] < 0) {
      place[ragdoll] = static_cast<int>(wanted.size());
      wanted.push_back(rest[ragdoll]);
    }
    return place[ragdoll];
  };
  std::vector<SharedImpulse> shared;
  for (const ContactImpulse& c : step_) {
    if (isInner(c)) continue;
    const int first = placeOf(c.ragdoll), second = placeOf(partnerOf(c));
    shared.push_back({first, second, weight(c), c.friction, c.normal, c.impulse});
  }
  const bool gives = spreadWithinCones(wanted, shared);
  auto next = shared.begin();
  for (ContactImpulse& c : step_) {
    if (isInner(c)) continue;
    c.impulse = (next++)->impulse;
    // The spin that gives friction's couple back is no force along any normal of two bodies, and on
    // an edge the normal turns between parts of a step; a plane has but one.
    const bool plane =
        c.obstacle >= 0 && model.obstacles[c.obstacle].type == ObstacleSpec::Type::kPlane;
    if (!gives && !plane) c.normal = turnedIntoCone(c);
  }
}

/// What is left for those of each body that has any.
void Contacts::putOnPins(const Model& model, const Inputs& inputs, const State& state) {
  pins_.assign(model.pins.size(), Vec3::Zero());
  const Points middle = 0.5 * (places_ + state.x);
  for (int i = 0; i < static_cast<int>(model.ragdolls.size()); ++i) {
    if (!isPinned(model, i)) continue;
    const std::vector<Vec3> by_pins = impulsesByPins(
        model, i, middle, unexplained(model, inputs, step_, before_, middle, state, i));
    auto next = by_pins.begin();
    for (std::size_t p = 0; p < model.pins.size(); ++p)
      if (model.pins[p].ragdoll == i) pins_[p] = *next++;
  }
}

/// Impacts begin and end.
void Contacts::follow(const Model& model, const State& state) {
  const double h = model.solver.step;
  std::uint32_t begun = 0;
  for (Open& open : open_) open.touched = false;
  for (const ContactImpulse& c : step_) {
    // In the order of their keys, as those of the step.
    const auto before = [](const Open& open, const ContactImpulse& of) {
      return isBefore(open.report.contact, of);
    };
    auto open = std::lower_bound(open_.begin(), open_.end(), c, before);
    const bool known = open != open_.end() && !isBefore(c, open->report.contact);
    if (!known) open = open_.emplace(open);
    // What relaxation keeps no account of is there before it presses.
    if (!known || !open->pressed) {
      open->first = state.step;
      open->report.contact = c;
      open->report.contact.impulse.setZero();
      open->pressed = !c.impulse.isZero(0);
      open->told = open->pressed && c.approach > kImpactSpeed;
      if (open->told) {
        open->report.id = static_cast<std::uint32_t>(state.step) * kImpactsOfAStep + begun++;
        open->report.step = state.step;
        open->report.time = state.time;
        report_.impacts.push_back(open->report);
      }
    }
    open->touched = true;
    if (open->report.over) continue;
    open->report.contact.impulse += c.impulse;
    open->report.duration = static_cast<double>(state.step - open->first + 1) * h;
    if (const double force = peakForce(c, h); force > open->report.peak_force) {
      open->report.peak_force = force;
      open->hardest = state.step;
    }
  }
  for (Open& open : open_) {
    const double since = static_cast<double>(state.step - open.hardest) * h;
    if (!open.told || open.report.over || (open.touched && since < kSettled)) continue;
    open.report.over = true;
    open.report.step = state.step;
    open.report.time = state.time;
    report_.impacts.push_back(open.report);
  }
  open_.erase(std::remove_if(open_.begin(), open_.end(), [](const Open& o) { return !o.touched; }),
              open_.end());
}

/// Into the interval.
void Contacts::collect(const Model& model, const State& state) {
  const double h = model.solver.step;
  report_.step = state.step;
  report_.time = state.time;
  report_.interval += h;
  for (const ContactImpulse& c : step_) {
    addTouch(report_.touches, {c, peakForce(c, h)});
    if (c.obstacle < 0) continue;
    report_.on_obstacles[c.obstacle] -= c.impulse;
    report_.moments[c.obstacle] -= c.point.cross(c.impulse);
  }
  report_.on_pins.resize(pins_.size(), Vec3::Zero());
  for (std::size_t p = 0; p < pins_.size(); ++p) report_.on_pins[p] -= pins_[p];
}

ContactReport Contacts::take() {
  ContactReport taken = report_;
  report_.interval = 0;
  report_.touches.clear();
  report_.impacts.clear();
  for (std::vector<Vec3>* sums : {&report_.on_obstacles, &report_.moments, &report_.on_pins})
    std::fill(sums->begin(), sums->end(), Vec3::Zero());
  return taken;
}

double peakForce(const ContactImpulse& c, double h) {
  return std::max(c.peak, c.impulse.norm() / h);
}

void addTouch(std::vector<Touch>& all, const Touch& next) {
  const auto before = [](const Touch& t, const ContactImpulse& c) {
    return isBefore(t.contact, c);
  };
  auto touch = std::lower_bound(all.begin(), all.end(), next.contact, before);
  if (touch == all.end() || keyOf(touch->contact) != keyOf(next.contact)) {
    all.insert(touch, next);
    return;
  }
  addTo(touch->contact, next.contact);
  touch->peak_force = std::max(touch->peak_force, next.peak_force);
}

std::string particlesName(const Model& model, int ragdoll, const std::array<int, 2>& particles) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const std::vector<std::string>& names = model.skeletonOf(r).particles;
  const std::string first = names[particles[0] - r.first];
  return particles[1] < 0 || particles[1] == particles[0]
             ? first
             : first + "-" + names[particles[1] - r.first];
}

std::string regionName(const Model& model, int ragdoll, const std::array<int, 2>& particles) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Skeleton& s = model.skeletonOf(r);
  const int region =
      s.region(particles[0] - r.first, particles[1] < 0 ? -1 : particles[1] - r.first);
  if (region >= 0) return s.segments[region].name;
  return particlesName(model, ragdoll, particles);
}

std::string otherName(const Model& model, const ContactImpulse& c, std::string* body) {
  if (body) body->clear();
  if (c.obstacle >= 0) return model.obstacles[c.obstacle].name;
  const int other = c.other >= 0 ? c.other : c.ragdoll;
  if (body) *body = particlesName(model, other, c.other_particle);
  return model.ragdolls[other].name;
}

}  // namespace ragdoll
