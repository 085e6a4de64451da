#include "ragdoll_sim/core/snapshot.h"

#include <cstring>
#include <string>
#include <type_traits>

#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

constexpr std::uint64_t kMagic = 0x504e534c4c4f4447;  ///< "GDOLLSNP"
constexpr std::uint32_t kVersion = 5;  ///< of the layout; change it with any of the visit functions

std::uint64_t fnv(const std::uint8_t* data, std::size_t size) {
  std::uint64_t h = 14695981039346656037ull;
  for (std::size_t i = 0; i < size; ++i) h = (h ^ data[i]) * 1099511628211ull;
  return h;
}

/// Both archives take any value by operator(); sizes are written before what they count.
class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    raw(&value, sizeof value);
  }
  void operator()(const std::string& s) { block(s.data(), s.size(), 1); }
  void operator()(const Vec3& v) { raw(v.data(), sizeof(double) * 3); }
  void operator()(const Quat& q) { raw(q.coeffs().data(), sizeof(double) * 4); }
  void operator()(const Points& p) {
    block(p.data(), static_cast<std::size_t>(p.cols()), 3 * sizeof(double));
  }
  template <class T>
  void operator()(const std::vector<T>& v) {
    if constexpr (std::is_arithmetic_v<T>) {
      block(v.data(), v.size(), sizeof(T));
    } else {
      (*this)(static_cast<std::uint64_t>(v.size()));
      for (const T& item : v) visit(*this, item);
    }
  }

  std::vector<std::uint8_t> bytes;

 private:
  void block(const void* data, std::size_t count, std::size_t size) {
    (*this)(static_cast<std::uint64_t>(count));
    raw(data, count * size);
  }
  void raw(const void* data, std::size_t size) {
    const auto* p = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), p, p + size);
  }
};

class Reader {
 public:
  explicit Reader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  template <class T>
  void operator()(T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    raw(&value, sizeof value);
  }
  void operator()(bool& value) {
    std::uint8_t byte = 0;  // a bool of any other value than 0 or 1 is undefined
    (*this)(byte);
    if (byte > 1) throw Error("snapshot", "is damaged: a switch is neither on nor off");
    value = byte == 1;
  }
  void operator()(std::string& s) {
    s.resize(count(1));
    raw(s.data(), s.size());
  }
  void operator()(Vec3& v) { raw(v.data(), sizeof(double) * 3); }
  void operator()(Quat& q) { raw(q.coeffs().data(), sizeof(double) * 4); }
  void operator()(Points& p) {
    p.resize(3, static_cast<Eigen::Index>(count(3 * sizeof(double))));
    raw(p.data(), sizeof(double) * 3 * static_cast<std::size_t>(p.cols()));
  }
  template <class T>
  void operator()(std::vector<T>& v) {
    if constexpr (std::is_arithmetic_v<T>) {
      v.resize(count(sizeof(T)));
      raw(v.data(), v.size() * sizeof(T));
    } else {
      v.clear();  // it grows with what is there: a wrong count takes no memory
      for (std::size_t n = count(1); n > 0; --n) visit(*this, v.emplace_back());
    }
  }
  std::size_t position() const { return at_; }

 private:
  std::size_t count(std::size_t size) {
    std::uint64_t n = 0;
    (*this)(n);
    if (n > (bytes_.size() - at_) / size) throw Error("snapshot", "is damaged: it ends too early");
    return static_cast<std::size_t>(n);
  }
  void raw(void* data, std::size_t size) {
    if (size > bytes_.size() - at_) throw Error("snapshot", "is damaged: it ends too early");
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  const std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = 0;
};

// One visit per type, for reading and writing. The structured bindings name every member, so that
// one that is added and forgotten here does not compile.

template <class Archive, class T>
void visitPose(Archive& a, T& pose) {
  auto& [position, orientation] = pose;
  a(position), a(orientation);
}
void visit(Writer& a, const Pose& pose) { visitPose(a, pose); }
void visit(Reader& a, Pose& pose) { visitPose(a, pose); }

template <class Archive, class T>
void visitPin(Archive& a, T& pin) {
  auto& [ragdoll, particle, target, frame] = pin;
  a(ragdoll), a(particle), a(target), a(frame);
}
void visit(Writer& a, const Pin& pin) { visitPin(a, pin); }
void visit(Reader& a, Pin& pin) { visitPin(a, pin); }

template <class Archive, class T>
void visitPoke(Archive& a, T& poke) {
  auto& [start, duration, body, body_name, force, point] = poke;
  auto& [ragdoll, particles, weight] = body;
  a(start), a(duration), a(ragdoll), a(particles), a(weight), a(body_name), a(force), a(point);
}
void visit(Writer& a, const Poke& poke) { visitPoke(a, poke); }
void visit(Reader& a, Poke& poke) { visitPoke(a, poke); }

template <class Archive, class T>
void visitImpulse(Archive& a, T& cached) {
  auto& [ragdoll, p, q, obstacle, other, impulse] = cached;
  a(ragdoll), a(p), a(q), a(obstacle), a(other[0]), a(other[1]), a(impulse);
}
void visit(Writer& a, const CachedImpulse& impulse) { visitImpulse(a, impulse); }
void visit(Reader& a, CachedImpulse& impulse) { visitImpulse(a, impulse); }

/// Two switches in a byte: the layout is that of before there were events.
void visitSwitches(Writer& w, bool sleep, bool events) {
  w(static_cast<std::uint8_t>((sleep ? 1 : 0) + (events ? 2 : 0)));
}
void visitSwitches(Reader& r, bool& sleep, bool& events) {
  std::uint8_t byte = 0;
  r(byte);
  if (byte > 3) throw Error("snapshot", "is damaged: a switch is neither on nor off");
  sleep = byte % 2 == 1;
  events = byte >= 2;
}

template <class Archive, class T>
void visitSolver(Archive& a, T& solver) {
  auto& [preset, method, integrator, step, sweeps, tolerance, events, damping, joint_damping, sleep,
         numbers, threads, where] = solver;
  a(preset), a(method), a(integrator), a(step), a(sweeps), a(tolerance), a(damping),
      a(joint_damping), visitSwitches(a, sleep, events), a(numbers), a(threads), a(where);
}

template <class Archive, class T>
void visitState(Archive& a, T& state) {
  auto& [step, time, x, v, obstacles, asleep, quiet, multipliers, impulses, allowed] = state;
  a(step), a(time), a(x), a(v), a(obstacles), a(asleep), a(quiet), a(multipliers);
  a(impulses), a(allowed);
}

template <class Archive, class T>
void visitMoment(Archive& a, T& moment) {
  auto& [state, pokes, pins, gravity, solver] = moment;
  a(gravity);
  visitSolver(a, solver);
  a(pins), a(pokes);
  visitState(a, state);
}

/// Told of models that have any, so that snapshots of others stay what they are.
void visitCompliance(Writer& w, const Model& model) {
  for (const Obstacle& o : model.obstacles) w(o.contact.compliance), w(o.contact.damping);
  for (const Ragdoll& r : model.ragdolls) {
    w(r.compliant);
    for (const Segment& s : model.skeletonOf(r).segments)
      w(s.contact.compliance), w(s.contact.damping);
  }
}

}  // namespace

std::uint64_t fingerprint(const Model& model) {
  Writer w;
  for (const Skeleton& s : model.skeletons) {
    for (const std::string& name : s.particles) w(name);
    w(Points(s.rest));
    for (Eigen::Index i = 0; i < s.M.size(); ++i) w(s.M.data()[i]);
    for (Eigen::Index i = 0; i < s.radius.size(); ++i) w(s.radius[i]);
    for (const Stick& stick : s.sticks) w(stick.a), w(stick.b), w(stick.length);
    for (const Joint& j : s.joints) {
      w(j.name), w(j.type), w(j.parent), w(j.child), w(j.axis), w(j.range.begin), w(j.range.end);
      w(j.half_angle), w(j.stiffness), w(j.damping);
      for (const auto& plane : j.planes)
        w(plane ? plane->begin : -1e9), w(plane ? plane->end : -1e9);
    }
  }
  for (const Ragdoll& r : model.ragdolls) w(r.name), w(r.skeleton), w(r.first);
  for (const Obstacle& o : model.obstacles) {
    w(o.type), w(o.pose.position), w(o.pose.orientation), w(o.half), w(o.radius);
    w(o.friction), w(o.restitution), w(o.frame);
  }
  w(model.self_collision), w(model.ragdoll_collision);
  if (model.compliant) visitCompliance(w, model);
  return fnv(w.bytes.data(), w.bytes.size());
}

std::vector<std::uint8_t> toBytes(const Model& model, const Moment& moment) {
  Writer w;
  w(kMagic), w(kVersion), w(fingerprint(model));
  visitMoment(w, moment);
  w(fnv(w.bytes.data(), w.bytes.size()));
  return std::move(w.bytes);
}

Moment fromBytes(const Model& model, const std::vector<std::uint8_t>& bytes) {
  std::uint64_t magic = 0, of_model = 0, sum = 0;
  std::uint32_t version = 0;
  if (bytes.size() >= sizeof magic) std::memcpy(&magic, bytes.data(), sizeof magic);
  if (magic != kMagic)
    throw Error("snapshot", "these " + std::to_string(bytes.size()) +
                                " bytes are none; it must be what ~get_state gave");
  if (bytes.size() > sizeof sum)
    std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
  if (sum != fnv(bytes.data(), bytes.size() - sizeof sum))
    throw Error("snapshot", "is damaged: its checksum is wrong");
  Reader r(bytes);
  r(magic), r(version);
  if (version != kVersion)
    throw Error("snapshot", "is of layout " + std::to_string(version) + "; this program reads " +
                                std::to_string(kVersion));
  r(of_model);
  if (of_model != fingerprint(model))
    throw Error("snapshot", "is of another scene; load the scene that it was taken in");
  Moment moment;
  visitMoment(r, moment);
  if (r.position() + sizeof sum != bytes.size())
    throw Error("snapshot", "is damaged: it is longer than what it holds");
  checkFits(model, moment);
  return moment;
}

}  // namespace ragdoll
