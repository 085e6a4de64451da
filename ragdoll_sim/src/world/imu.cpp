#include "ragdoll_sim/world/imu.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/body/part_motion.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

/// The part that turns with the segment: it, or a group with all its particles; -1: none.
int partWith(const FrameTree& tree, const Segment& segment) {
  if (const int own = tree.partOf(segment); own >= 0) return own;
  for (std::size_t p = 0; p < tree.parts.size(); ++p) {
    const std::vector<int>& in = tree.parts[p].particles;
    if (tree.parts[p].group &&
        std::all_of(segment.particles.begin(), segment.particles.end(),
                    [&](int i) { return std::count(in.begin(), in.end(), i) > 0; }))
      return static_cast<int>(p);
  }
  return -1;
}

Vec3 restAnchor(const Skeleton& s, const Segment& segment) {
  if (!segment.group && segment.particles.size() == 2) return s.rest.col(segment.particles[0]);
  Vec3 mean = Vec3::Zero();
  for (const int i : segment.particles) mean += s.rest.col(i);
  return mean / static_cast<double>(segment.particles.size());
}

/// FNV-1a: sensors of one seed but other names have other noise.
std::uint64_t streamOf(const Sensor& sensor) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](std::uint64_t byte) { hash = (hash ^ byte) * 0x100000001b3u; };
  for (const char c : sensor.name) add(static_cast<unsigned char>(c));
  for (int shift = 0; shift < 64; shift += 8) add((sensor.seed >> shift) & 0xff);
  return hash;
}

Vec3 mean(const Points& all, const std::vector<int>& columns) {
  Vec3 sum = Vec3::Zero();
  for (const int i : columns) sum += all.col(i);
  return sum / static_cast<double>(columns.size());
}

/// [rad/s] of a group: that of the rigid motion nearest to its particles' velocities.
Vec3 groupSpin(const State& state, const std::vector<int>& particles, const Vec3& x,
               const Vec3& v) {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vec3 moment = Vec3::Zero();
  for (const int i : particles) {
    const Vec3 r = state.x.col(i) - x;
    inertia += r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
    moment += r.cross(state.v.col(i) - v);
  }
  return inertia.ldlt().solve(moment);
}

/// The rotation's axis times its angle, the shorter way [rad].
Vec3 turnOf(const Quat& q) {
  const double half_sine = q.vec().norm();
  if (half_sine == 0) return Vec3::Zero();
  const double sign = q.w() < 0 ? -1 : 1;
  return sign * 2 * std::atan2(half_sine, std::abs(q.w())) / half_sine * q.vec();
}

Quat middle(const Quat& a, const Quat& b) {
  const double sign = a.dot(b) < 0 ? -1 : 1;
  return Quat(Eigen::Vector4d(a.coeffs() + sign * b.coeffs())).normalized();
}

Quat turnedBy(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Quat(Eigen::AngleAxisd(angle, turn / angle)) : Quat::Identity();
}

/// [s] into a step of h at which the impulse per mass `push` acts that moves by `way` until the
/// step's end: h/2 of an even force, any of an impact.
double timeOf(const Vec3& push, const Vec3& way, double h) {
  const double square = push.squaredNorm();
  return square > 0 ? std::clamp(h - way.dot(push) / square, 0.0, h) : 0.5 * h;
}

void takeIn(Vec3& mean, const Vec3& value, std::uint64_t count) {
  mean += (value - mean) / static_cast<double>(count);
}

Vec3 saturated(const Vec3& value, double range) { return value.cwiseMax(-range).cwiseMin(range); }

}  // namespace

SensorFrame sensorFrame(const Model& model, const FrameTracker& tracker, const Sensor& sensor) {
  const Skeleton& s = model.skeletonOf(model.ragdolls[sensor.ragdoll]);
  const FrameTree& tree = tracker.tree(sensor.ragdoll);
  const Segment& segment = s.segments[sensor.segment];
  const int part = partWith(tree, segment);
  for (std::size_t f = 0; part >= 0 && f < tree.frames.size(); ++f) {
    if (tree.frames[f].part != part) continue;
    const Vec3 origin = mean(s.rest, tree.frames[f].particles);
    return {tracker.firstFrame(sensor.ragdoll) + static_cast<int>(f),
            {restAnchor(s, segment) + sensor.position - origin, sensor.orientation}};
  }
  return {};
}

void checkSensorNames(const Model& model, const FrameTracker& tracker) {
  for (const Sensor& s : model.sensors) {
    const std::string own = s.name.substr(s.name.find('/') + 1);
    if (tracker.tree(s.ragdoll).frame(own) < 0) continue;
    throw Error(s.where + ".name", "'" + s.name +
                                       "' is a frame of the body already; another name is right, "
                                       "such as '" +
                                       own + "_imu'");
  }
}

Imus::Imus(const Model& model) : tracker_(model) {
  std::vector<int> parts;
  for (const Sensor& sensor : model.sensors) {
    mount(model, sensor);
    parts.push_back(mounts_.back().part);
  }
  tracker_.followOnly(parts);
}

void Imus::mount(const Model& model, const Sensor& sensor) {
  const Ragdoll& ragdoll = model.ragdolls[sensor.ragdoll];
  const Skeleton& s = model.skeletonOf(ragdoll);
  const Segment& segment = s.segments[sensor.segment];
  const FrameTree& tree = tracker_.tree(sensor.ragdoll);
  const int part = partWith(tree, segment);
  if (part < 0)
    throw Error(sensor.where + ".segment",
                "no frame turns with '" + segment.name + "'; take a bone or a group with a frame");
  Mount m;
  m.sensor = sensor;
  m.part = tracker_.firstPart(sensor.ragdoll) + part;
  m.group = tree.parts[part].group;
  for (const int i : tree.parts[part].particles) m.particles.push_back(ragdoll.first + i);
  m.offset = restAnchor(s, segment) + sensor.position - partAnchor(tree.parts[part], s.rest);
  m.rest_direction = tree.parts[part].rest_direction;
  m.stream = streamOf(sensor);
  mounts_.push_back(std::move(m));
}

/// Where the sensor is and how fast, at a state that the tracker has followed.
Imus::Look Imus::look(const State& state, const Mount& m) const {
  Look look;
  look.part = tracker_.now().parts[m.part];
  const Vec3 arm = look.part * m.offset;
  Vec3 anchor, velocity, spin;
  if (m.group) {
    anchor = mean(state.x, m.particles);
    velocity = mean(state.v, m.particles);
    spin = groupSpin(state, m.particles, anchor, velocity);
  } else {
    const int from = m.particles[0], to = m.particles[1];
    anchor = state.x.col(from);
    velocity = state.v.col(from);
    const Vec3 d = state.x.col(to) - anchor;
    look.direction = look.part * m.rest_direction;
    spin = d.cross(state.v.col(to) - velocity) / std::max(d.squaredNorm(), kMinLength * kMinLength);
  }
  look.pose = {anchor + arm, look.part * m.sensor.orientation};
  look.velocity = velocity + spin.cross(arm);
  look.spin = spin;
  return look;
}

/// Takes the step to the next look into the means.
void Imus::add(const Model& model, const Look& next, Mount& m) {
  const double h = model.solver.step;
  const Pose &from = m.now.pose, &to = next.pose;
  const Quat to_sensor = middle(from.orientation, to.orientation).conjugate();
  const Vec3 push = next.velocity - m.now.velocity - h * model.gravity;
  const Vec3 way = to.position - from.position - h * m.now.velocity - 0.5 * h * h * model.gravity;
  const double t = timeOf(push, way, h);
  // An impact changes the spin, too: until then it is the first, from then on the second.
  const Quat at_push = middle(turnedBy(t * m.now.spin) * from.orientation,
                              turnedBy((t - h) * next.spin) * to.orientation);
  const Vec3 turn = m.group
                        ? turnOf(next.part * m.now.part.conjugate())
                        : turnOf(smallestRotation(m.now.direction, next.direction, Vec3::UnitX()));
  ++m.steps;
  takeIn(m.acceleration, at_push.conjugate() * (push / h), m.steps);
  takeIn(m.turn, to_sensor * (turn / h), m.steps);
  m.now = next;
}

void Imus::begin(Mount& m, bool whole) {
  m.steps = 0;
  m.whole = whole;
  m.acceleration = m.turn = Vec3::Zero();
}

void Imus::reset(const State& state) {
  tracker_.reset(state);
  for (Mount& m : mounts_) {
    m.now = look(state, m);
    begin(m, state.step % m.sensor.every == 0);
  }
}

void Imus::update(const Model& model, const State& state, std::vector<ImuSample>& samples) {
  tracker_.update(state);
  for (std::size_t i = 0; i < mounts_.size(); ++i) {
    Mount& m = mounts_[i];
    add(model, look(state, m), m);
    if (state.step % m.sensor.every != 0) continue;
    if (m.whole) samples.push_back(finish(static_cast<int>(i), state));
    begin(m, true);
  }
}

ImuSample Imus::finish(int sensor, const State& state) const {
  const Mount& m = mounts_[sensor];
  const Sensor& s = m.sensor;
  ImuSample sample{sensor, state.step, state.time, m.acceleration, m.turn, m.now.pose};
  if (s.accelerometer_noise > 0 || s.gyroscope_noise > 0) {
    double noise[6];
    normalNumbers(m.stream, state.step / s.every, 6, noise);
    sample.acceleration += s.accelerometer_noise * Vec3(noise[0], noise[1], noise[2]);
    sample.angular_velocity += s.gyroscope_noise * Vec3(noise[3], noise[4], noise[5]);
  }
  sample.acceleration = saturated(sample.acceleration, s.accelerometer_range);
  sample.angular_velocity = saturated(sample.angular_velocity, s.gyroscope_range);
  return sample;
}

}  // namespace ragdoll
