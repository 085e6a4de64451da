#include "ragdoll_sim/io/scene_yaml.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "contact_reader.h"
#include "model_reader.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/model_yaml.h"
#include "ragdoll_sim/io/share.h"
#include "settings_reader.h"

namespace ragdoll {
namespace io {
namespace {

constexpr std::size_t kMaxEntries =
    10000;  ///< of every list of a scene, and of all ragdolls together
constexpr std::size_t kMaxParts = 200000;   ///< of all models of a scene: an alias repeats parts
constexpr std::size_t kMaxPlaced = 100000;  ///< particles of a scene with a place of their own
constexpr double kUnitQuaternion =
    1e-14;  ///< a quaternion this close to unit length stays as it is

/// Models of one scene: each is read once and shared by all ragdolls that name it.
class ModelCache {
 public:
  explicit ModelCache(std::string folder) : folder_(std::move(folder)) {}

  std::shared_ptr<const SkeletonSpec> get(const Reader& reader) {
    if (reader.isMap()) {
      auto& model = inlined_[reader.value().get()];
      if (!model) {
        model = std::make_shared<const SkeletonSpec>(readModel(reader, "model"));
        count(*model, reader);
      }
      return model;
    }
    if (!reader.isText()) reader.failType("a model's name, a path or a mapping");
    auto& model = named_[reader.text()];
    if (!model) {
      model = loadModel(findModel(reader.text(), folder_, reader.where()));
      count(*model, reader);
    }
    return model;
  }

 private:
  void count(const SkeletonSpec& model, const Reader& reader) {
    parts_ += model.particles.size() + model.sticks.size() + model.joints.size();
    for (const SegmentSpec& segment : model.segments) parts_ += 1 + segment.particles.size();
    if (parts_ > kMaxParts)
      reader.fail("makes more than " + std::to_string(kMaxParts) +
                  " parts in the models of this scene; use one model more than once, or 'count'");
  }

  std::size_t parts_ = 0;
  std::string folder_;
  std::map<std::string, std::shared_ptr<const SkeletonSpec>> named_;
  std::map<const Value*, std::shared_ptr<const SkeletonSpec>> inlined_;
};

Quat fromRollPitchYaw(const Vec3& rpy) {
  return Quat(Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) *
              Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) * Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()))
      .normalized();
}

/// `rpy_deg`, `rpy` [rad] (turns about the fixed x, y, z in this order) or `quaternion` [x, y, z,
/// w].
Quat readOrientation(MapReader& map) {
  const auto degrees = map.find("rpy_deg");
  const auto radians = map.find("rpy");
  const auto quaternion = map.find("quaternion");
  const int given =
      int(degrees.has_value()) + int(radians.has_value()) + int(quaternion.has_value());
  if (given > 1) {
    (quaternion ? *quaternion : *radians).fail("the orientation is given twice; once is right");
  }
  if (degrees) return fromRollPitchYaw(degrees->vector() * kDegree);
  if (radians) return fromRollPitchYaw(radians->vector());
  if (!quaternion) return Quat::Identity();
  const std::vector<double> q = quaternion->numbers(4);
  const Quat given_orientation(q[3], q[0], q[1], q[2]);
  const double length = given_orientation.coeffs().stableNorm();
  if (!(length > kMinLength))
    quaternion->fail("has length 0; [x, y, z, w] of length 1 is expected");
  if (std::abs(length - 1) < kUnitQuaternion) return given_orientation;
  return Quat(given_orientation.coeffs() / length);
}

/// Those of the ragdolls read so far; each of `count` has its own.
void checkPlaced(const Reader& reader, const RagdollSpec& ragdoll, std::size_t& placed) {
  placed += ragdoll.place.size() * static_cast<std::size_t>(std::max(1, ragdoll.count));
  if (placed > kMaxPlaced)
    reader.fail("places more than " + std::to_string(kMaxPlaced) + " particles of this scene");
}

RagdollSpec readRagdoll(const Reader& reader, ModelCache& models) {
  RagdollSpec ragdoll;
  ragdoll.where = reader.where();
  MapReader map(reader);
  if (const auto name = map.find("name")) ragdoll.name = name->name();
  ragdoll.skeleton = models.get(map.need("model"));
  if (const auto position = map.find("position")) ragdoll.pose.position = position->vector();
  ragdoll.pose.orientation = readOrientation(map);
  if (const auto velocity = map.find("velocity")) ragdoll.velocity = velocity->vector();
  if (const auto spin = map.find("angular_velocity")) ragdoll.angular_velocity = spin->vector();
  if (const auto place = map.find("place")) {
    const MapReader particles(*place, kMaxEntries);
    for (const auto& [name, at] : particles.entries())
      ragdoll.place.emplace_back(name, at.vector());
  }
  if (const auto contact = map.find("contact"))
    ragdoll.compliant = contact->choice({"rigid", "compliant"}) == 1;
  const auto count = map.find("count");
  if (count) ragdoll.count = count->integer(1, static_cast<int>(kMaxEntries));
  if (const auto spacing = map.find("spacing")) {
    ragdoll.spacing = spacing->vector();
    if (!count) spacing->fail("has a meaning only together with 'count'");
  }
  map.finish();
  return ragdoll;
}

void readShape(MapReader& map, ObstacleSpec& obstacle) {
  switch (obstacle.type) {
    case ObstacleSpec::Type::kPlane:
      if (const auto point = map.find("point")) obstacle.pose.position = point->vector();
      if (const auto normal = map.find("normal")) obstacle.normal = normal->direction();
      break;
    case ObstacleSpec::Type::kBox: {
      obstacle.pose.position = map.need("position").vector();
      obstacle.pose.orientation = readOrientation(map);
      const Reader size = map.need("size");
      obstacle.size = size.vector();
      if (!(obstacle.size.minCoeff() > 0)) size.fail("three edge lengths above 0 are expected");
      break;
    }
    case ObstacleSpec::Type::kSphere:
      obstacle.pose.position = map.need("position").vector();
      obstacle.radius = map.need("radius").positive();
      break;
    case ObstacleSpec::Type::kCapsule:
      obstacle.from = map.need("from").vector();
      obstacle.to = map.need("to").vector();
      obstacle.radius = map.need("radius").positive();
      break;
  }
}

ObstacleSpec readObstacle(const Reader& reader) {
  ObstacleSpec obstacle;
  obstacle.where = reader.where();
  MapReader map(reader);
  obstacle.type = static_cast<ObstacleSpec::Type>(
      map.need("type").choice({"plane", "box", "sphere", "capsule"}));
  if (const auto name = map.find("name")) obstacle.name = name->name();
  readShape(map, obstacle);
  if (const auto friction = map.find("friction")) obstacle.friction = friction->notNegative();
  if (const auto bounce = map.find("restitution")) obstacle.restitution = bounce->within(0, 1);
  if (const auto frame = map.find("frame")) obstacle.frame = frame->text();
  obstacle.contact = readContactKeys(map);
  map.finish();
  return obstacle;
}

PinSpec readPin(const Reader& reader) {
  PinSpec pin;
  pin.where = reader.where();
  if (reader.isText()) {
    pin.particle = reader.text();
    return pin;
  }
  if (!reader.isMap()) reader.failType("a particle, or {particle: ..., frame: ...}");
  MapReader map(reader);
  pin.particle = map.need("particle").text();
  if (const auto frame = map.find("frame")) pin.frame = frame->text();
  map.finish();
  return pin;
}

PokeSpec readPoke(const Reader& reader) {
  PokeSpec poke;
  poke.where = reader.where();
  MapReader map(reader);
  if (const auto at = map.find("at")) poke.at = at->notNegative();
  poke.body = map.need("body").text();
  poke.force = map.need("force").vector();
  if (const auto point = map.find("point")) poke.point = point->vector();
  if (const auto duration = map.find("duration")) poke.duration = duration->number();
  map.finish();
  return poke;
}

/// {accelerometer: ..., gyroscope: ...}, both or one.
void readInstruments(const std::optional<Reader>& given, double& accelerometer, double& gyroscope,
                     bool zero_is_right) {
  if (!given) return;
  MapReader map(*given);
  for (const auto& [key, value] :
       {std::pair("accelerometer", &accelerometer), std::pair("gyroscope", &gyroscope)})
    if (const auto number = map.find(key))
      *value = zero_is_right ? number->notNegative() : number->positive();
  map.finish();
}

SensorSpec readSensor(const Reader& reader) {
  SensorSpec sensor;
  sensor.where = reader.where();
  MapReader map(reader);
  sensor.name = map.need("name").name();
  map.need("type").choice({"imu"});
  sensor.segment = map.need("segment").text();
  if (const auto position = map.find("position")) sensor.position = position->vector();
  sensor.orientation = readOrientation(map);
  if (const auto rate = map.find("rate")) sensor.rate = rate->positive();
  readInstruments(map.find("noise"), sensor.accelerometer_noise, sensor.gyroscope_noise, true);
  readInstruments(map.find("range"), sensor.accelerometer_range, sensor.gyroscope_range, false);
  if (const auto seed = map.find("seed"))
    sensor.seed = static_cast<std::uint64_t>(seed->integer(0, std::numeric_limits<int>::max()));
  map.finish();
  return sensor;
}

void checkCount(const Reader& reader, const std::vector<RagdollSpec>& ragdolls) {
  std::size_t total = 0;
  for (const RagdollSpec& ragdoll : ragdolls)
    total += static_cast<std::size_t>(std::max(1, ragdoll.count));
  if (total > kMaxEntries) {
    reader.fail("are " + std::to_string(total) + " ragdolls; at most " +
                std::to_string(kMaxEntries) + " are possible");
  }
}

Scene readScene(const Reader& reader, const std::string& folder) {
  Scene scene;
  scene.where = reader.file();
  scene.solver = preset("balanced");
  scene.solver.where = reader.file() + ": solver";
  MapReader map(reader);
  for (const std::string& key : settingKeys()) {
    if (const auto value = map.find(key)) readSetting(key, *value, scene);
  }
  ModelCache models(folder);
  const Reader ragdolls = map.need("ragdolls");
  std::size_t placed = 0;
  for (const Reader& item : ragdolls.list(kMaxEntries)) {
    scene.ragdolls.push_back(readRagdoll(item, models));
    checkPlaced(item, scene.ragdolls.back(), placed);
  }
  if (scene.ragdolls.empty()) ragdolls.fail("is empty; at least one ragdoll is expected");
  checkCount(ragdolls, scene.ragdolls);
  if (const auto obstacles = map.find("obstacles")) {
    for (const Reader& item : obstacles->list(kMaxEntries)) {
      scene.obstacles.push_back(readObstacle(item));
    }
  }
  if (const auto pins = map.find("pins")) {
    for (const Reader& item : pins->list(kMaxEntries)) scene.pins.push_back(readPin(item));
  }
  if (const auto pokes = map.find("pokes")) {
    for (const Reader& item : pokes->list(kMaxEntries)) scene.pokes.push_back(readPoke(item));
  }
  if (const auto sensors = map.find("sensors")) {
    for (const Reader& item : sensors->list(kMaxEntries)) scene.sensors.push_back(readSensor(item));
  }
  if (const auto solver = map.find("solver")) scene.solver = readSolver(*solver);
  map.finish();
  scene.text = toYaml(scene);
  return scene;
}

}  // namespace
}  // namespace io

Scene parseScene(const std::string& text, const std::string& name) {
  return io::readScene(io::Reader(io::parseDocument(text, name), name), ".");
}

Scene loadScene(const std::string& path) {
  const std::string file = findScene(path);
  const std::string folder = std::filesystem::path(file).parent_path().string();
  const io::Reader root(io::parseDocument(io::readFile(file), file), file);
  return io::readScene(root, folder.empty() ? "." : folder);
}

bool isSceneText(const std::string& scene) {
  return scene.find('\n') != std::string::npos || scene.find(": ") != std::string::npos ||
         scene.find('{') != std::string::npos;
}

void fixFrames(Scene& scene) {
  for (ObstacleSpec& obstacle : scene.obstacles) obstacle.frame.clear();
  for (PinSpec& pin : scene.pins) pin.frame.clear();
  scene.text = toYaml(scene);
}

}  // namespace ragdoll
