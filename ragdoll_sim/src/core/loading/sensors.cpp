#include "core/loading/sensors.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

constexpr double kWholeSteps = 1e-6;  ///< relative: a step of 0.0083333333 is 1/120 s
constexpr double kOnALine = 1e-6;     ///< relative: points this close to a line have no orientation
constexpr double kMostSteps = 1e9;    ///< of a sample

/// The particles of a rigid part that the segment belongs to lie on a line.
bool isLine(const Skeleton& s, const std::vector<int>& particles) {
  const Vec3 origin = s.rest.col(particles[0]);
  Vec3 longest = Vec3::Zero();
  for (const int i : particles)
    if ((s.rest.col(i) - origin).norm() > longest.norm()) longest = s.rest.col(i) - origin;
  return std::all_of(particles.begin(), particles.end(), [&](int i) {
    return (s.rest.col(i) - origin).cross(longest).norm() <= kOnALine * longest.squaredNorm();
  });
}

/// Whether a rigid body that is more than a line has all of the segment's particles.
bool isInGroup(const Skeleton& s, const Segment& segment) {
  return std::any_of(s.segments.begin(), s.segments.end(), [&](const Segment& other) {
    return other.particles.size() > 2 && !isLine(s, other.particles) &&
           std::all_of(segment.particles.begin(), segment.particles.end(), [&](int i) {
             return std::count(other.particles.begin(), other.particles.end(), i) > 0;
           });
  });
}

void findSegment(const SensorSpec& spec, const Model& model, Sensor& sensor) {
  const std::size_t slash = spec.segment.find('/');
  const bool named = slash != std::string::npos;
  const std::string segment = named ? spec.segment.substr(slash + 1) : spec.segment;
  std::vector<std::string> names;
  for (const Ragdoll& r : model.ragdolls) names.push_back(r.name);
  sensor.ragdoll = named ? indexOf(names, spec.segment.substr(0, slash)) : 0;
  const std::string where = spec.where + ".segment";
  if (sensor.ragdoll < 0) {
    const bool many = names.size() > 20;
    if (many) names.resize(20);
    throw Error(where, "unknown ragdoll '" + spec.segment.substr(0, slash) + "'; there are " +
                           joined(names) + (many ? ", ..." : ""));
  }
  const Skeleton& s = model.skeletonOf(model.ragdolls[sensor.ragdoll]);
  sensor.segment = s.segment(segment);
  if (sensor.segment >= 0) return;
  std::vector<std::string> there;
  for (const Segment& other : s.segments) there.push_back(other.name);
  throw Error(where, there.empty()
                         ? "the model has no segments, and a sensor needs one"
                         : "unknown segment '" + segment + "'; there are " + joined(there));
}

/// Steps of a sample.
std::uint64_t stepsPerSample(const SensorSpec& spec, double h) {
  const double steps = 1 / (spec.rate * h), whole = std::round(steps);
  if (whole >= 1 && whole <= kMostSteps && std::abs(steps - whole) <= kWholeSteps * whole)
    return static_cast<std::uint64_t>(whole);
  const double most = 1 / h;
  throw Error(spec.where + ".rate",
              "rate is " + numberText(spec.rate) + " Hz, which steps of " + numberText(h) +
                  " s do not give; it must be " + numberText(most) + " Hz or a whole part of it (" +
                  numberText(most / 2) + ", " + numberText(most / 3) + ", ...)");
}

void checkInstrument(const std::string& where, const char* name, double noise, double range) {
  if (!(std::isfinite(noise) && noise >= 0))
    throw Error(where + ".noise." + name, "noise must be a finite number >= 0");
  if (!(range > 0)) throw Error(where + ".range." + name, "range must be > 0");
}

}  // namespace

void addSensor(const SensorSpec& spec, Model& model) {
  Sensor sensor;
  sensor.where = spec.where;
  if (spec.name.empty() || spec.name.find('/') != std::string::npos)
    throw Error(spec.where + ".name", "name '" + spec.name + "' must be a word without '/'");
  findSegment(spec, model, sensor);
  sensor.name = model.ragdolls[sensor.ragdoll].name + "/" + spec.name;
  for (const Sensor& other : model.sensors)
    if (other.name == sensor.name)
      throw Error(spec.where + ".name",
                  "name '" + sensor.name + "' is another sensor's; each needs its own");
  checkPosition(spec.where + ".position", spec.position);
  sensor.position = spec.position;
  sensor.orientation = spec.orientation.normalized();
  if (!(std::isfinite(spec.rate) && spec.rate > 0))
    throw Error(spec.where + ".rate", "rate must be > 0 [Hz]");
  sensor.every = stepsPerSample(spec, model.solver.step);
  checkInstrument(spec.where, "accelerometer", spec.accelerometer_noise, spec.accelerometer_range);
  checkInstrument(spec.where, "gyroscope", spec.gyroscope_noise, spec.gyroscope_range);
  sensor.accelerometer_noise = spec.accelerometer_noise;
  sensor.gyroscope_noise = spec.gyroscope_noise;
  sensor.accelerometer_range = spec.accelerometer_range;
  sensor.gyroscope_range = spec.gyroscope_range;
  sensor.seed = spec.seed;
  const Skeleton& s = model.skeletonOf(model.ragdolls[sensor.ragdoll]);
  const Segment& segment = s.segments[sensor.segment];
  sensor.twists = isInGroup(s, segment);
  if (!sensor.twists && segment.particles.size() > 2)
    throw Error(spec.where + ".segment", "segment '" + segment.name +
                                             "' is a line and has no orientation; take a bone or "
                                             "a group that is not flat on a line");
  if (!sensor.twists)
    model.notes.push_back("sensor '" + sensor.name + "': the bone '" + segment.name +
                          "' has no twist, so its gyroscope tells nothing of turning about it");
  model.sensors.push_back(std::move(sensor));
}

}  // namespace ragdoll
