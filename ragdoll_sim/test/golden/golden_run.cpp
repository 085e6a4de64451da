#include "golden_run.h"

#include <algorithm>
#include <type_traits>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/start_state.h"

namespace ragdoll::golden {
namespace {

/// FNV-1a 64 over what it is given, one number after the other: structs have padding.
class Hash {
 public:
  explicit Hash(std::uint64_t start) : hash_(start) {}

  template <class Number>
  Hash& operator<<(const Number& number) {
    static_assert(std::is_arithmetic_v<Number>);
    const auto* bytes = reinterpret_cast<const unsigned char*>(&number);
    for (std::size_t i = 0; i < sizeof number; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ull;
    return *this;
  }
  Hash& operator<<(const Vec3& v) { return *this << v.x() << v.y() << v.z(); }
  Hash& operator<<(const Quat& q) { return *this << q.x() << q.y() << q.z() << q.w(); }
  Hash& operator<<(const Points& points) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) *this << Vec3(points.col(i));
    return *this << static_cast<std::int64_t>(points.cols());
  }
  Hash& operator<<(const Pose& p) { return *this << p.position << p.orientation; }
  Hash& operator<<(const CachedImpulse& p) {
    return *this << p.ragdoll << p.a << p.b << p.obstacle << p.other[0] << p.other[1] << p.impulse;
  }
  template <class T>
  Hash& operator<<(const std::vector<T>& values) {
    for (const T& value : values) *this << value;
    return *this << static_cast<std::uint64_t>(values.size());
  }

  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_;
};

}  // namespace

Run::Run(const Scene& scene)
    : model(buildModel(scene)), state(startState(model)), inputs(startInputs(model)) {
  outcome_.memory = 14695981039346656037ull;
}

void Run::step() {
  const StepReport r = ragdoll::step(model, inputs, workspace_, state);
  const int fields[] = {r.contacts, r.substeps, r.guarded, r.limited,
                        r.implicit, r.rigid,    r.joining, r.unresolved};
  static_assert(
      sizeof r == sizeof fields + 6 * sizeof(int),
      "every field of the report is in the list, but those of fast, tolerance and rk with events");
  static_assert(sizeof fields / sizeof fields[0] == kSumCount);
  for (int i = 0; i < kSumCount; ++i) outcome_.sums[i] += static_cast<std::uint64_t>(fields[i]);
  ++outcome_.steps;
  outcome_.memory = (Hash(outcome_.memory) << state.step << state.time << state.x << state.v
                                           << state.obstacles << state.asleep << state.quiet
                                           << state.multipliers << state.impulses << state.allowed)
                        .value();
}

Outcome Run::outcome() const {
  Outcome outcome = outcome_;
  outcome.state = hash(state);
  return outcome;
}

void Run::hold(const std::vector<std::string>& particles) {
  std::vector<Pin> pins;
  for (const std::string& name : particles) {
    const BodyRef body = findBody(model, name);
    Pin pin;
    pin.ragdoll = body.ragdoll;
    pin.particle = body.particles.at(0);
    pin.target = state.x.col(pin.particle);
    pins.push_back(pin);
  }
  setPins(model, pins);
  // As the node does it: what the solver remembers belongs to sticks that were free until now.
  for (const Pin& pin : pins) state.v.col(pin.particle).setZero();
  state.multipliers = startState(model).multipliers;
  std::fill(state.asleep.begin(), state.asleep.end(), 0);
  std::fill(state.quiet.begin(), state.quiet.end(), 0);
  workspace_ = Workspace();
  inputs.pins.clear();
}

void Run::setGravity(const Vec3& gravity) {
  model.gravity = gravity;
  workspace_ = Workspace();
}

void Run::poke(const std::string& body, double duration, const Vec3& force, const Vec3& point) {
  Poke poke;
  poke.start = state.time;
  poke.duration = duration;
  poke.body = findBody(model, body);
  poke.body_name = body;
  poke.force = force;
  poke.point = point;
  inputs.pokes.push_back(poke);
}

}  // namespace ragdoll::golden
