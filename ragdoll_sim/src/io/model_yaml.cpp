#include "ragdoll_sim/io/model_yaml.h"

#include <cmath>
#include <filesystem>

#include "contact_reader.h"
#include "model_reader.h"
#include "reader.h"

namespace ragdoll {
namespace io {
namespace {

constexpr std::size_t kMaxParticles = 1000;  ///< of one model; its mass matrix is dense
constexpr std::size_t kMaxSticks = 2000;     ///< of one model; so are the matrices over its sticks

ParticleSpec readParticle(const std::string& name, const Reader& reader) {
  ParticleSpec particle;
  particle.name = name;
  particle.where = reader.where();
  MapReader map(reader);
  particle.position = map.need("position").vector();
  if (const auto mass = map.find("mass")) particle.mass = mass->notNegative();
  if (const auto radius = map.find("radius")) particle.radius = radius->notNegative();
  map.finish();
  return particle;
}

StickSpec readStick(const Reader& reader) {
  StickSpec stick;
  stick.where = reader.where();
  const std::string expected = "[particle, particle] or [particle, particle, length]";
  if (!reader.isList()) reader.failType(expected);
  const std::size_t size = reader.value()->items.size();
  if (size != 2 && size != 3)
    reader.fail("has " + std::to_string(size) + " items; " + expected + " is expected");
  const std::vector<Reader> items = reader.list(3);
  stick.a = items[0].name();
  stick.b = items[1].name();
  if (size == 3) stick.length = items[2].positive();
  return stick;
}

void readGroup(MapReader& map, SegmentSpec& segment) {
  segment.group = true;
  const Reader particles = map.need("particles");
  for (const Reader& item : particles.list(kMaxParticles)) segment.particles.push_back(item.name());
  if (segment.particles.size() < 3) {
    particles.fail("has " + std::to_string(segment.particles.size()) +
                   " particles; a rigid group has 3 or more (a bone has from and to)");
  }
  if (const auto mass = map.find("mass")) segment.mass = mass->notNegative();
  if (const auto com = map.find("com")) segment.com_point = com->vector();
  if (const auto inertia = map.find("inertia")) {
    const std::vector<double> i = inertia->numbers(6);
    segment.inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  }
}

void readBone(MapReader& map, SegmentSpec& segment) {
  segment.particles = {map.need("from").name(), map.need("to").name()};
  if (const auto mass = map.find("mass")) segment.mass = mass->notNegative();
  if (const auto com = map.find("com")) segment.com = com->number();
  if (const auto gyration = map.find("gyration")) segment.gyration = gyration->notNegative();
}

SegmentSpec readSegment(const std::string& name, const Reader& reader) {
  SegmentSpec segment;
  segment.name = name;
  segment.where = reader.where();
  MapReader map(reader);
  bool group = false;
  for (const auto& entry : map.entries()) group = group || entry.first == "particles";
  group ? readGroup(map, segment) : readBone(map, segment);
  if (const auto contact = map.find("contact")) segment.contact = readContact(*contact);
  map.finish();
  return segment;
}

/// `key` in radians or `key_deg` in degrees; both is one too many.
template <class Read>
auto angle(MapReader& map, const std::string& key, Read read)
    -> std::optional<decltype(read(*map.find(key), 1.0))> {
  const auto degrees = map.find(key + "_deg");
  const auto radians = map.find(key);
  if (degrees && radians) radians->fail("is there in radians and in degrees; one is right");
  if (degrees) return read(*degrees, kDegree);
  if (radians) return read(*radians, 1.0);
  return std::nullopt;
}

AngleRange readRange(const Reader& reader, double unit) {
  const std::vector<double> ends = reader.numbers(2);
  if (ends[0] > ends[1]) reader.fail("begins above its end; [smallest, largest] is expected");
  return {ends[0] * unit, ends[1] * unit};
}

void readHinge(MapReader& map, JointSpec& joint) {
  joint.type = JointSpec::Type::kHinge;
  joint.axis = map.need("axis").direction();
  const auto range = angle(map, "range", readRange);
  if (!range) map.missing("range_deg");
  joint.range = *range;
  joint.twist =
      angle(map, "twist", [](const Reader& value, double unit) { return value.positive() * unit; });
}

void readCone(MapReader& map, JointSpec& joint) {
  joint.type = JointSpec::Type::kCone;
  joint.axis = map.need("axis").direction();
  const auto half_angle = angle(map, "half_angle", [](const Reader& value, double unit) {
    const double result = value.notNegative() * unit;
    if (result > M_PI)
      value.fail(std::string("is more than half a turn (180 degrees)") +
                 (unit == 1 ? "; with 'half_angle_deg' it is in degrees" : ""));
    return result;
  });
  if (!half_angle) map.missing("half_angle_deg");
  joint.half_angle = *half_angle;
}

void readPlanes(const Reader& reader, MapReader& map, JointSpec& joint) {
  joint.type = JointSpec::Type::kPlanes;
  const char* keys[] = {"xy", "yz", "xz"};
  bool any = false;
  for (int i = 0; i < 3; ++i) {
    joint.planes[i] = angle(map, keys[i], readRange);
    any = any || joint.planes[i];
  }
  if (!any) reader.fail("has no region; at least one of xy_deg, yz_deg, xz_deg is expected");
}

JointSpec readJoint(const std::string& name, const Reader& reader) {
  JointSpec joint;
  joint.name = name;
  joint.where = reader.where();
  MapReader map(reader);
  const std::size_t type = map.need("type").choice({"hinge", "cone", "planes"});
  joint.parent = map.need("parent").name();
  joint.child = map.need("child").name();
  if (type == 0) readHinge(map, joint);
  if (type == 1) readCone(map, joint);
  if (type == 2) readPlanes(reader, map, joint);
  if (const auto stiffness = map.find("stiffness")) joint.stiffness = stiffness->positive();
  if (const auto damping = map.find("damping")) joint.damping = damping->notNegative();
  map.finish();
  return joint;
}

/// A mapping from names that the user chooses to parts of one kind.
template <class Part>
void readParts(const Reader& reader, std::size_t most,
               Part (*read)(const std::string&, const Reader&), std::vector<Part>& parts) {
  const MapReader map(reader, most);
  for (const auto& [name, part] : map.entries()) {
    const Value key{Value::Kind::kText, 0, name, {}};
    Reader(std::make_shared<Value>(key), part.where(), "", 0).name();
    parts.push_back(read(name, part));
  }
}

}  // namespace

SkeletonSpec readModel(const Reader& reader, const std::string& name) {
  SkeletonSpec model;
  model.where = reader.where();
  MapReader map(reader);
  const auto own_name = map.find("name");
  model.name = own_name ? own_name->text() : name;
  const Reader particles = map.need("particles");
  readParts(particles, kMaxParticles, readParticle, model.particles);
  if (model.particles.empty()) particles.fail("is empty; at least one particle is expected");
  if (const auto sticks = map.find("sticks")) {
    for (const Reader& stick : sticks->list(kMaxSticks)) model.sticks.push_back(readStick(stick));
  }
  if (const auto segments = map.find("segments")) {
    readParts(*segments, kMaxParticles, readSegment, model.segments);
  }
  if (const auto joints = map.find("joints")) {
    readParts(*joints, kMaxParticles, readJoint, model.joints);
  }
  map.finish();
  return model;
}

}  // namespace io

std::shared_ptr<const SkeletonSpec> parseModel(const std::string& text, const std::string& name) {
  const io::Reader root(io::parseDocument(text, name), name);
  return std::make_shared<const SkeletonSpec>(io::readModel(root, "model"));
}

std::shared_ptr<const SkeletonSpec> loadModel(const std::string& path) {
  const io::Reader root(io::parseDocument(io::readFile(path), path), path);
  const std::string name = std::filesystem::path(path).stem().string();
  return std::make_shared<const SkeletonSpec>(io::readModel(root, name));
}

}  // namespace ragdoll
