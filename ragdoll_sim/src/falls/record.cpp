#include "ragdoll_sim/falls/record.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/model_yaml.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/io/share.h"
#include "ragdoll_sim/world/batch.h"
#include "ragdoll_sim/world/crowd.h"
#include "ragdoll_sim/world/imu.h"
#include "ragdoll_sim/world/injury.h"

namespace ragdoll::falls {
namespace {

constexpr std::size_t kMostInGroup = 64;  ///< bodies of a batch, as many as stay in the cache
constexpr double kStep = 1.0 / 200;       ///< [s] whatever the preset's
constexpr double kAccelerometer = 0.02, kGyroscope = 0.002;  ///< [m/s^2], [rad/s] noise, deviation
constexpr double kMostAcceleration = 16 * 9.80665, kMostTurn = 35;  ///< [m/s^2], [rad/s] range

/// Where the sensors sit: in the segment's frame of the model before it is scaled.
struct Place {
  const char *name, *segment;
  double x, y, z;  ///< [m]
};
constexpr std::array<Place, kSensors.size()> kPlaces = {{
    {"low_back", "torso", -0.115, 0, -0.2},            // at the belt
    {"wrist", "right_forearm", 0, -0.1, -0.255},       // outside of it
    {"thigh", "right_thigh", 0, -0.07, -0.2},          // trousers' pocket
    {"head", "head", 0.13, 0, 0.15},                   // forehead
}};

std::vector<SensorSpec> sensors(const Fall& fall, double rate) {
  std::vector<SensorSpec> all;
  for (const Place& place : kPlaces) {
    SensorSpec sensor;
    sensor.name = place.name;
    sensor.segment = place.segment;
    sensor.position = fall.scale * Vec3(place.x, place.y, place.z);
    sensor.rate = rate;
    sensor.where = "fall: sensor " + sensor.name;
    all.push_back(sensor);
  }
  return all;
}

/// Noise and saturation of a record's n-th sample, and into floats.
void put(const Fall& fall, std::size_t sensor, int n, const Vec3& acceleration, const Vec3& turn,
         std::vector<float>& to) {
  double noise[6];
  normalNumbers(fall.seed * kSensors.size() + sensor, static_cast<std::uint64_t>(n), 6, noise);
  for (int c = 0; c < 3; ++c) {
    const double a = acceleration[c] + kAccelerometer * noise[c];
    const double w = turn[c] + kGyroscope * noise[3 + c];
    to[6 * n + c] = static_cast<float>(std::clamp(a, -kMostAcceleration, kMostAcceleration));
    to[6 * n + 3 + c] = static_cast<float>(std::clamp(w, -kMostTurn, kMostTurn));
  }
}

/// One body of a group.
struct Track {
  const Fall* fall = nullptr;
  Record* record = nullptr;
  int quiet = 0;  ///< samples before the onset
  std::unique_ptr<Judge> judge;
  Vec3 momentum = Vec3::Zero(), head_velocity = Vec3::Zero();
  HeadInjury head;
  bool asleep = false;       ///< at the end of the last sample
};

/// Falls of one scene on their way.
class GroupRun {
 public:
  GroupRun(const Options& options, int samples, int every, const std::vector<Scene>& scenes,
           const FallScene& first)
      : options_(options),
        samples_(samples),
        every_(every),
        release_(static_cast<std::uint64_t>(std::round(first.release / scenes[0].solver.step))),
        batch_(scenes),
        imus_(batch_.model()) {
    if (!first.scene.pins.empty() && release_ == 0) batch_.letGo();
    imus_.reset(batch_.state());
    const Skeleton& s = skeleton();
    weight_ = s.M.rowwise().sum();
    floors_.assign(batch_.model().obstacles.begin(),
                   batch_.model().obstacles.begin() + first.floors);
    head_ = s.particle("head");
  }

  void add(const Fall& fall, Record& record) {
    Track track;
    track.fall = &fall;
    track.record = &record;
    track.quiet = std::min(samples_ / 4, static_cast<int>(std::round(fall.onset * options_.rate)));
    record.onset = track.quiet / options_.rate;
    for (auto& imu : record.imu) imu.resize(6 * static_cast<std::size_t>(samples_));
    const Skeleton& s = skeleton();
    if (options_.positions) record.positions.resize(3 * static_cast<std::size_t>(samples_) * s.named);
    if (options_.euler) record.euler.resize(3 * static_cast<std::size_t>(samples_));
    std::vector<double> radii(s.radius.data(), s.radius.data() + s.named);
    track.judge = std::make_unique<Judge>(
        std::vector<std::string>(s.particles.begin(), s.particles.begin() + s.named), radii, floors_);
    const int i = static_cast<int>(tracks_.size());
    track.momentum = momentum(i);
    track.head_velocity = velocity(i, head_);
    tracks_.push_back(std::move(track));
  }

  void run() {
    int last = 0;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      beQuiet(static_cast<int>(i));
      last = std::max(last, samples_ - tracks_[i].quiet);
    }
    for (int k = 1; k <= last; ++k) {
      if (allAsleep()) {  // nothing wakes them any more
        for (std::size_t i = 0; i < tracks_.size(); ++i) rest(static_cast<int>(i), k);
        break;
      }
      for (int n = 0; n < every_; ++n) step();
      sample(k);
    }
    for (Track& t : tracks_) {
      t.record->outcome = t.judge->outcome();
      t.record->hic15 = t.head.hic15();
    }
  }

 private:
  const Skeleton& skeleton() const { return batch_.model().skeletonOf(batch_.model().ragdolls[0]); }
  double h() const { return batch_.model().solver.step; }
  int column(int i) const { return batch_.firstColumn(i); }
  Vec3 velocity(int i, int particle) const { return batch_.state().v.col(column(i) + particle); }
  Vec3 momentum(int i) const {
    return batch_.state().v.middleCols(column(i), weight_.size()) * weight_;
  }

  bool allAsleep() const {
    return batch_.state().step > release_ &&
           std::all_of(tracks_.begin(), tracks_.end(), [](const Track& t) { return t.asleep; });
  }

  /// The sensors of a body that does not accelerate or turn.
  void putQuiet(int i, int n) {
    const Track& t = tracks_[i];
    for (std::size_t s = 0; s < kSensors.size(); ++s) {
      const int sensor = i * static_cast<int>(kSensors.size()) + static_cast<int>(s);
      const Quat& turn = imus_.pose(sensor).orientation;
      put(*t.fall, s, n, turn.conjugate() * -batch_.model().gravity, Vec3::Zero(), t.record->imu[s]);
      if (s == 0) putEuler(turn, n, *t.record);
    }
  }

  /// The samples before the onset: the body as it starts, carried at its speed.
  void beQuiet(int i) {
    const Track& t = tracks_[i];
    const Vec3 walk = batch_.model().start_velocity.col(column(i) + head_);
    const Points x = batch_.state().x.middleCols(column(i), skeleton().named);
    for (int n = 0; n < t.quiet; ++n) {
      putQuiet(i, n);
      const Vec3 shift = -(t.quiet - 1 - n) / options_.rate * walk;
      putPositions(x.colwise() + shift, n, *t.record);
    }
    t.judge->look(t.record->onset, x, batch_.state().v.middleCols(column(i), skeleton().named));
  }

  /// The k-th sample after the onset and all that follow, of a body at rest.
  void rest(int i, int k) {
    const Track& t = tracks_[i];
    const Points x = batch_.state().x.middleCols(column(i), skeleton().named);
    for (int n = t.quiet + k - 1; n < samples_; ++n) {
      putQuiet(i, n);
      putPositions(x, n, *t.record);
    }
  }

  void step() {
    if (release_ > 0 && batch_.state().step == release_) batch_.letGo();
    const double time = batch_.state().time;
    batch_.advance();
    imus_.update(batch_.model(), batch_.state(), found_);
    for (std::size_t i = 0; i < tracks_.size(); ++i) measure(static_cast<int>(i), time);
  }

  /// Forces and the head's acceleration in the step that began at `time`.
  void measure(int i, double time) {
    Track& t = tracks_[i];
    if (batch_.state().step > static_cast<std::uint64_t>((samples_ - t.quiet) * every_)) return;
    const Model& model = batch_.model();
    const Vec3 now = momentum(i), head = velocity(i, head_);
    Vec3 force = (now - t.momentum) / h() - weight_.sum() * model.gravity;
    if (!t.fall->push_body.empty() && std::round(time / h()) < std::max(1.0, std::round(t.fall->push_duration / h())))
      force -= t.fall->push;
    const bool held = release_ > 0 && batch_.state().step <= release_ + 1;
    if (!held && !batch_.state().asleep[i])
      t.record->peak_force = std::max(t.record->peak_force, force.norm());
    t.head.add((head - t.head_velocity).norm() / h(), h());
    t.momentum = now;
    t.head_velocity = head;
  }

  /// The k-th samples after the onset.
  void sample(int k) {
    for (const ImuSample& found : found_) {
      const int i = found.sensor / static_cast<int>(kSensors.size());
      const std::size_t s = static_cast<std::size_t>(found.sensor) % kSensors.size();
      const Track& t = tracks_[i];
      const int n = t.quiet + k - 1;
      if (n >= samples_) continue;
      put(*t.fall, s, n, found.acceleration, found.angular_velocity, t.record->imu[s]);
      if (s == 0) putEuler(found.pose.orientation, n, *t.record);
    }
    found_.clear();
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      Track& t = tracks_[i];
      const int n = t.quiet + k - 1, named = skeleton().named;
      const bool asleep = batch_.state().asleep[i] != 0;
      if (n < samples_ && asleep && t.asleep) putQuiet(static_cast<int>(i), n);
      t.asleep = asleep;
      if (n >= samples_) continue;
      const auto x = batch_.state().x.middleCols(column(static_cast<int>(i)), named);
      putPositions(x, n, *t.record);
      t.judge->look((n + 1) / options_.rate, x, batch_.state().v.middleCols(column(static_cast<int>(i)), named));
      t.record->at_rest = asleep;
    }
  }

  void putPositions(const Points& x, int n, Record& record) const {
    if (!options_.positions) return;
    float* to = record.positions.data() + static_cast<std::size_t>(n) * x.size();
    for (Eigen::Index c = 0; c < x.size(); ++c) to[c] = static_cast<float>(x.data()[c]);
  }

  void putEuler(const Quat& q, int n, Record& record) const {
    if (!options_.euler) return;
    constexpr double kDegrees = 180 / 3.14159265358979323846;
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const double angles[3] = {std::atan2(r(2, 1), r(2, 2)), -std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
                              std::atan2(r(1, 0), r(0, 0))};
    for (int c = 0; c < 3; ++c) record.euler[3 * n + c] = static_cast<float>(kDegrees * angles[c]);
  }

  const Options& options_;
  int samples_, every_;
  std::uint64_t release_;
  Batch batch_;
  Imus imus_;
  Eigen::VectorXd weight_;
  std::vector<Obstacle> floors_;
  int head_ = 0;
  std::vector<Track> tracks_;
  std::vector<ImuSample> found_;
};

std::pair<std::string, std::string> keyAndValue(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos)
    throw Error("--set", "'" + setting + "' has no '='; key=value is expected, such as solver.preset=fast");
  return {setting.substr(0, equals), setting.substr(equals + 1)};
}

}  // namespace

Recorder::Recorder(Options options) : options_(std::move(options)) {
  if (!(options_.seconds > 0 && options_.seconds <= 3600))
    throw Error("--seconds", "must be in (0, 3600] s");
  checkThreads("--threads", options_.threads);
  model_ = loadModel(findModel(options_.model, ".", "--model"));
  const FallScene example = sceneOf(drawFall(0), model_);
  step_ = example.scene.solver.step;
  every_ = stepsPerSample(options_.rate, step_);
  samples_ = static_cast<int>(std::floor(options_.seconds * options_.rate + 1e-6));
  if (samples_ < 1) throw Error("--seconds", "is shorter than one sample of --rate");
  scene_ = toYaml(example.scene);
  Scene bare = example.scene;
  bare.sensors.clear();
  const Batch batch(std::vector<Scene>{example.scene});
  names_ = batch.names(0);
}

FallScene Recorder::sceneOf(const Fall& fall, const std::shared_ptr<const SkeletonSpec>& model) const {
  FallScene made = fallScene(fall, model, kStep);
  bool step = false, self = false;
  for (const std::string& setting : options_.settings) {
    const auto [key, value] = keyAndValue(setting);
    applySetting(made.scene, key, value);
    step = step || key == "solver.step";
    self = self || key == "self_collision";
  }
  if (!step) made.scene.solver.step = kStep;
  // Bodies that touch themselves leave the packs; limbs pass through each other rather.
  if (!self && made.scene.solver.method == Method::kFast) made.scene.self_collision = false;
  made.scene.solver.threads = 1;
  made.scene.sensors = sensors(fall, options_.rate);
  return made;
}

void Recorder::recordGroup(const std::vector<std::uint64_t>& seeds, Record* const* records) const {
  std::vector<Scene> scenes;
  FallScene first;
  std::shared_ptr<const SkeletonSpec> model;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    records[i]->fall = drawFall(seeds[i]);
    if (!model) model = scaledModel(*model_, records[i]->fall.scale);
    FallScene made = sceneOf(records[i]->fall, model);
    scenes.push_back(made.scene);
    if (i == 0) first = std::move(made);
  }
  GroupRun run(options_, samples_, every_, scenes, first);
  for (std::size_t i = 0; i < seeds.size(); ++i) run.add(records[i]->fall, *records[i]);
  run.run();
}

std::vector<Record> Recorder::record(std::uint64_t first, std::uint64_t count) const {
  std::vector<Record> records(count);
  std::map<std::uint64_t, std::vector<std::uint64_t>> groups;
  std::vector<std::vector<std::uint64_t>> parts;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    auto& group = groups[falls::sceneOf(seed)];
    group.push_back(seed);
    if (group.size() == kMostInGroup) parts.push_back(std::exchange(group, {}));
  }
  for (auto& [scene, group] : groups)
    if (!group.empty()) parts.push_back(group);
  inParallel(options_.threads, static_cast<int>(parts.size()), [&](int part) {
    std::vector<Record*> own;
    for (const std::uint64_t seed : parts[part]) own.push_back(&records[seed - first]);
    recordGroup(parts[part], own.data());
  });
  return records;
}

}  // namespace ragdoll::falls
