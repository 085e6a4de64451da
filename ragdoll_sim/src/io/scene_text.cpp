// toYaml: a scene written out so that reading it gives the same bits.
#include <cmath>
#include <locale>
#include <map>
#include <sstream>

#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "settings_reader.h"

namespace ragdoll {
namespace {

/// The shortest of 15, 16 or 17 digits that reads back to the same bits.
std::string number(double value) {
  for (int digits = 15;; ++digits) {
    std::stringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(digits);
    stream << value;
    double back = 0;
    stream >> back;
    if (back == value || digits == 17) return stream.str();
  }
}

std::string vector(const Vec3& v) {
  return "[" + number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()) + "]";
}

std::string range(const AngleRange& r) {
  return "[" + number(r.begin) + ", " + number(r.end) + "]";
}

/// In double quotes, so that no word or sign means anything.
std::string text(const std::string& plain) {
  static const char* const kHex = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : plain) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += std::string("\\") + c;
    } else if (byte < 0x20 || byte == 0x7f) {
      result += std::string("\\x") + kHex[byte >> 4] + kHex[byte & 15];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// A name, in quotes only where it needs them.
std::string name(const std::string& plain) {
  bool simple = !plain.empty() && plain != "null" && plain != "Null" && plain != "NULL";
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const char c = plain[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    simple = simple && (letter || (i > 0 && ((c >= '0' && c <= '9') || c == '/')));
  }
  return simple ? plain : text(plain);
}

std::string names(const std::vector<std::string>& list) {
  std::string result;
  for (const std::string& item : list) result += (result.empty() ? "" : ", ") + name(item);
  return "[" + result + "]";
}

std::string orientation(const Quat& q) {
  return "[" + number(q.x()) + ", " + number(q.y()) + ", " + number(q.z()) + ", " + number(q.w()) +
         "]";
}

/// ", <before>stiffness: ..., damping: ...<after>"; of a rigid surface nothing.
std::string contactText(const ContactSpec& contact, const char* before, const char* after) {
  if (!std::isfinite(contact.stiffness)) return "";
  return std::string(", ") + before + "stiffness: " + number(contact.stiffness) +
         ", damping: " + number(contact.damping) + after;
}

void writeSegment(std::ostream& out, const SegmentSpec& segment) {
  out << name(segment.name) << ": {";
  if (segment.group) {
    const Eigen::Matrix3d& i = segment.inertia;
    out << "particles: " << names(segment.particles) << ", mass: " << number(segment.mass)
        << ", com: " << vector(segment.com_point) << ", inertia: [" << number(i(0, 0)) << ", "
        << number(i(1, 1)) << ", " << number(i(2, 2)) << ", " << number(i(0, 1)) << ", "
        << number(i(0, 2)) << ", " << number(i(1, 2)) << "]";
  } else {
    out << "from: " << name(segment.particles.at(0)) << ", to: " << name(segment.particles.at(1))
        << ", mass: " << number(segment.mass) << ", com: " << number(segment.com)
        << ", gyration: " << number(segment.gyration);
  }
  out << contactText(segment.contact, "contact: {", "}") << "}\n";
}

void writeJoint(std::ostream& out, const JointSpec& joint) {
  out << name(joint.name) << ": {parent: " << name(joint.parent)
      << ", child: " << name(joint.child);
  switch (joint.type) {
    case JointSpec::Type::kHinge:
      out << ", type: hinge, axis: " << vector(joint.axis) << ", range: " << range(joint.range);
      if (joint.twist) out << ", twist: " << number(*joint.twist);
      break;
    case JointSpec::Type::kCone:
      out << ", type: cone, axis: " << vector(joint.axis)
          << ", half_angle: " << number(joint.half_angle);
      break;
    case JointSpec::Type::kPlanes: {
      const char* keys[] = {"xy", "yz", "xz"};
      out << ", type: planes";
      for (int i = 0; i < 3; ++i) {
        if (joint.planes[i]) out << ", " << keys[i] << ": " << range(*joint.planes[i]);
      }
      break;
    }
  }
  if (std::isfinite(joint.stiffness)) out << ", stiffness: " << number(joint.stiffness);
  out << ", damping: " << number(joint.damping) << "}\n";
}

void writeSkeleton(std::ostream& out, const SkeletonSpec& model, const std::string& indent) {
  const std::string item = indent + "  ";
  out << indent << "name: " << name(model.name) << "\n" << indent << "particles:\n";
  for (const ParticleSpec& particle : model.particles) {
    out << item << name(particle.name) << ": {position: " << vector(particle.position)
        << ", mass: " << number(particle.mass) << ", radius: " << number(particle.radius) << "}\n";
  }
  if (!model.sticks.empty()) out << indent << "sticks:\n";
  for (const StickSpec& stick : model.sticks) {
    out << item << "- [" << name(stick.a) << ", " << name(stick.b);
    if (stick.length) out << ", " << number(*stick.length);
    out << "]\n";
  }
  if (!model.segments.empty()) out << indent << "segments:\n";
  for (const SegmentSpec& segment : model.segments) writeSegment(out << item, segment);
  if (!model.joints.empty()) out << indent << "joints:\n";
  for (const JointSpec& joint : model.joints) writeJoint(out << item, joint);
}

/// A model that several ragdolls share is written once and then named by an alias.
using Written = std::map<const SkeletonSpec*, std::string>;

void writeRagdoll(std::ostream& out, const RagdollSpec& ragdoll, Written& written) {
  out << "  - name: " << name(ragdoll.name) << "\n";
  if (ragdoll.skeleton) {
    const auto [entry, first] =
        written.try_emplace(ragdoll.skeleton.get(), "model_" + std::to_string(written.size()));
    out << "    model: " << (first ? "&" : "*") << entry->second << "\n";
    if (first) writeSkeleton(out, *ragdoll.skeleton, "      ");
  }
  out << "    position: " << vector(ragdoll.pose.position) << "\n"
      << "    quaternion: " << orientation(ragdoll.pose.orientation) << "\n"
      << "    velocity: " << vector(ragdoll.velocity) << "\n"
      << "    angular_velocity: " << vector(ragdoll.angular_velocity) << "\n";
  if (ragdoll.compliant) out << "    contact: compliant\n";
  if (!ragdoll.place.empty()) out << "    place:\n";
  for (const auto& [particle, at] : ragdoll.place) {
    out << "      " << name(particle) << ": " << vector(at) << "\n";
  }
  if (ragdoll.count > 0) {
    out << "    count: " << ragdoll.count << "\n    spacing: " << vector(ragdoll.spacing) << "\n";
  }
}

void writeObstacle(std::ostream& out, const ObstacleSpec& obstacle) {
  out << "  - {";
  if (!obstacle.name.empty()) out << "name: " << name(obstacle.name) << ", ";
  switch (obstacle.type) {
    case ObstacleSpec::Type::kPlane:
      out << "type: plane, point: " << vector(obstacle.pose.position)
          << ", normal: " << vector(obstacle.normal);
      break;
    case ObstacleSpec::Type::kBox:
      out << "type: box, position: " << vector(obstacle.pose.position)
          << ", quaternion: " << orientation(obstacle.pose.orientation)
          << ", size: " << vector(obstacle.size);
      break;
    case ObstacleSpec::Type::kSphere:
      out << "type: sphere, position: " << vector(obstacle.pose.position)
          << ", radius: " << number(obstacle.radius);
      break;
    case ObstacleSpec::Type::kCapsule:
      out << "type: capsule, from: " << vector(obstacle.from) << ", to: " << vector(obstacle.to)
          << ", radius: " << number(obstacle.radius);
      break;
  }
  out << ", friction: " << number(obstacle.friction)
      << ", restitution: " << number(obstacle.restitution) << contactText(obstacle.contact, "", "");
  if (!obstacle.frame.empty()) out << ", frame: " << text(obstacle.frame);
  out << "}\n";
}

void writePin(std::ostream& out, const PinSpec& pin) {
  out << "  - {particle: " << text(pin.particle);
  if (!pin.frame.empty()) out << ", frame: " << text(pin.frame);
  out << "}\n";
}

void writePoke(std::ostream& out, const PokeSpec& poke) {
  out << "  - {at: " << number(poke.at) << ", body: " << text(poke.body)
      << ", force: " << vector(poke.force) << ", point: " << vector(poke.point)
      << ", duration: " << number(poke.duration) << "}\n";
}

/// ", <key>: {accelerometer: ..., gyroscope: ...}"; infinite numbers are left out.
std::string instruments(const char* key, double accelerometer, double gyroscope) {
  std::string list;
  if (std::isfinite(accelerometer)) list += "accelerometer: " + number(accelerometer);
  if (std::isfinite(gyroscope))
    list += std::string(list.empty() ? "" : ", ") + "gyroscope: " + number(gyroscope);
  return list.empty() ? "" : std::string(", ") + key + ": {" + list + "}";
}

void writeSensor(std::ostream& out, const SensorSpec& sensor) {
  out << "  - {name: " << name(sensor.name) << ", type: imu, segment: " << text(sensor.segment)
      << ", position: " << vector(sensor.position)
      << ", quaternion: " << orientation(sensor.orientation) << ", rate: " << number(sensor.rate)
      << instruments("noise", sensor.accelerometer_noise, sensor.gyroscope_noise)
      << instruments("range", sensor.accelerometer_range, sensor.gyroscope_range)
      << ", seed: " << sensor.seed << "}\n";
}

void writeSettings(std::ostream& out, const Scene& scene) {
  const SolverSpec& solver = scene.solver;
  out << "self_collision: " << (scene.self_collision ? "true" : "false") << "\n"
      << "ragdoll_collision: " << (scene.ragdoll_collision ? "true" : "false") << "\n"
      << "solver: {preset: " << name(solver.preset)
      << ", method: " << methodNames().at(static_cast<std::size_t>(solver.method))
      << ", integrator: " << integratorNames().at(static_cast<std::size_t>(solver.integrator))
      << ", step: " << number(solver.step) << ", sweeps: " << solver.sweeps
      << ", tolerance: " << number(solver.tolerance)
      << ", events: " << (solver.events ? "true" : "false")
      << ", damping: " << number(solver.damping)
      << ", joint_damping: " << number(solver.joint_damping)
      << ", sleep: " << (solver.sleep ? "true" : "false")
      << ", numbers: " << io::numbersNames().at(static_cast<std::size_t>(solver.numbers))
      << ", threads: " << solver.threads << "}\n"
      << "coat: " << name(scene.coat) << "\n";
}

}  // namespace

std::string toYaml(const Scene& scene) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << "gravity: " << vector(scene.gravity) << "\nragdolls:\n";
  Written written;
  for (const RagdollSpec& ragdoll : scene.ragdolls) writeRagdoll(out, ragdoll, written);
  if (!scene.obstacles.empty()) out << "obstacles:\n";
  for (const ObstacleSpec& obstacle : scene.obstacles) writeObstacle(out, obstacle);
  if (!scene.pins.empty()) out << "pins:\n";
  for (const PinSpec& pin : scene.pins) writePin(out, pin);
  if (!scene.pokes.empty()) out << "pokes:\n";
  for (const PokeSpec& poke : scene.pokes) writePoke(out, poke);
  if (!scene.sensors.empty()) out << "sensors:\n";
  for (const SensorSpec& sensor : scene.sensors) writeSensor(out, sensor);
  writeSettings(out, scene);
  return out.str();
}

}  // namespace ragdoll
