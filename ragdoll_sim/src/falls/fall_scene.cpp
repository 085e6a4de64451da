// The scene of a fall: body, what it falls on, furniture, what makes it fall.
#include <cmath>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/falls/fall.h"

namespace ragdoll::falls {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kStanding = 1.02;    ///< [m] hips of the model with feet on the floor, leaning a little
constexpr double kSmooth = 0.004;     ///< [m] thickness of what a foot slips on
constexpr double kSeat = 0.438;       ///< [m] height for the model before it is scaled
constexpr double kBed = 0.5;          ///< [m] its height
constexpr double kRise = 0.17, kTread = 0.3;  ///< [m] of the stairs
constexpr int kSteps = 6;
constexpr double kFlesh = 2;          ///< [1/s] joint damping: limbs stop swinging, as flesh makes them

ObstacleSpec plane(double friction) {
  ObstacleSpec floor;
  floor.friction = friction;
  floor.where = "fall: floor";
  return floor;
}

ObstacleSpec box(const Vec3& low, const Vec3& high, double friction, const std::string& what) {
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.pose.position = 0.5 * (low + high);
  box.size = high - low;
  box.friction = friction;
  box.where = "fall: " + what;
  return box;
}

Quat turn(double roll, double pitch, double yaw) {
  return Quat(Eigen::AngleAxisd(yaw * kDegree, Vec3::UnitZ()) *
              Eigen::AngleAxisd(pitch * kDegree, Vec3::UnitY()) *
              Eigen::AngleAxisd(roll * kDegree, Vec3::UnitX()));
}

Vec3 restOf(const SkeletonSpec& model, const std::string& name) {
  for (const ParticleSpec& p : model.particles)
    if (p.name == name) return p.position;
  throw Error(model.where.empty() ? model.name : model.where,
              "has no particle '" + name + "', which a fall needs; human, human_lumped and their like have it");
}

/// Thighs forward, shanks down, however the trunk leans.
void sit(const Fall& fall, const SkeletonSpec& model, RagdollSpec& body) {
  const Vec3 forward = turn(0, 0, fall.yaw) * Vec3::UnitX();
  for (const char* side : {"left_", "right_"}) {
    const std::string name = side;
    const Vec3 leg = restOf(model, name + "leg"), knee = restOf(model, name + "knee"),
               foot = restOf(model, name + "foot");
    const Vec3 bent = body.pose.position + body.pose.orientation * leg + (knee - leg).norm() * forward;
    body.place.emplace_back(name + "knee", bent);
    body.place.emplace_back(name + "foot", bent - (foot - knee).norm() * Vec3::UnitZ());
  }
}

void addStairs(const Fall& fall, FallScene& out) {
  const double top = kSteps * kRise + kRise, width = 1.5;
  auto& all = out.scene.obstacles;
  all.push_back(box({-2, -width, 0}, {0, width, top}, fall.friction, "landing"));
  for (int i = 0; i < kSteps; ++i)
    all.push_back(box({i * kTread, -width, 0}, {(i + 1) * kTread, width, top - (i + 1) * kRise},
                      fall.friction, "stairs"));
  out.floors = static_cast<int>(all.size());
}

void addSeat(const Fall& fall, FallScene& out) {
  const double s = fall.scale, seat = kSeat * s;
  auto& all = out.scene.obstacles;
  const double rear = fall.place < 0 ? -0.05 : -0.22;
  const double front = fall.start == "chair" ? 0.1 : fall.place < 0 ? 0.24 : 0.06;
  all.push_back(box({rear * s, -0.25, 0}, {front * s, 0.25, seat}, fall.friction, "seat"));
  if (fall.start == "chair")
    all.push_back(box({-0.27 * s, -0.25, 0}, {-0.22 * s, 0.25, seat + 0.45 * s}, fall.friction, "back"));
}

void addSmooth(const Fall& fall, FallScene& out) {
  const double side = fall.foot == "left_foot" ? 1 : -1, s = fall.scale;
  const Vec3 a(-0.4 * s, side * 0.01 * s, 0), b(1.2 * s, side * 0.35 * s, kSmooth);
  out.scene.obstacles.push_back(box(a.cwiseMin(b), a.cwiseMax(b), fall.foot_friction, "smooth"));
  out.floors = 2;
}

/// Where the model's origin is.
double heightOf(const Fall& fall) {
  const double s = fall.scale;
  if (fall.start == "sitting" || fall.start == "chair")  // a hip that is lower clears the seat
    return kSeat * s + (0.162 + 0.115 * std::sin(std::abs(fall.roll) * kDegree)) * s;
  if (fall.start == "bed") return kBed + 0.125 * s;
  const double standing = kStanding * s;
  if (fall.start == "stairs") return (kSteps + 1) * kRise + standing;
  return standing + (fall.kind == "slip" ? kSmooth + 0.01 * s : 0);
}

void addPin(const std::string& particle, const std::string& what, FallScene& out) {
  PinSpec pin;
  pin.particle = particle;
  pin.where = "fall: " + what;
  out.scene.pins.push_back(pin);
}

RagdollSpec bodyOf(const Fall& fall, const std::shared_ptr<const SkeletonSpec>& model) {
  RagdollSpec body;
  body.skeleton = model;
  body.where = "fall: body";
  body.pose.position = Vec3(0, 0, heightOf(fall));
  if (fall.start == "stairs") body.pose.position.x() = -0.2;
  if (fall.start == "bed") body.pose.position = Vec3(0, fall.place, heightOf(fall));
  body.pose.orientation = turn(fall.roll, fall.pitch, fall.start == "bed" ? 0 : fall.yaw);
  body.velocity = turn(0, 0, fall.yaw) * Vec3(fall.speed, 0, 0);
  if (fall.start == "sitting" || fall.start == "chair") sit(fall, *model, body);
  return body;
}

}  // namespace

std::shared_ptr<const SkeletonSpec> scaledModel(const SkeletonSpec& model, double scale) {
  auto scaled = std::make_shared<SkeletonSpec>(model);
  const double cube = scale * scale * scale;
  for (ParticleSpec& p : scaled->particles) {
    p.position *= scale;
    p.radius *= scale;
    p.mass *= cube;
  }
  for (StickSpec& stick : scaled->sticks)
    if (stick.length) *stick.length *= scale;
  for (SegmentSpec& segment : scaled->segments) {
    segment.mass *= cube;
    segment.com_point *= scale;
    segment.inertia *= cube * scale * scale;
  }
  for (JointSpec& joint : scaled->joints) {  // torques as weight times length; times as sqrt(length)
    joint.stiffness *= cube * scale;
    joint.damping *= cube * scale * std::sqrt(scale);
  }
  return scaled;
}

FallScene fallScene(const Fall& fall, const std::shared_ptr<const SkeletonSpec>& model, double step) {
  for (const char* name : {"head", "neck", "left_shoulder", "right_shoulder", "left_hip", "right_hip",
                           "left_foot", "right_foot"})
    restOf(*model, name);
  FallScene out;
  Scene& scene = out.scene;
  scene.where = "fall " + std::to_string(fall.seed);
  scene.solver = preset("balanced");
  scene.solver.step = step;
  scene.solver.joint_damping = kFlesh;
  scene.self_collision = true;
  scene.ragdolls = {bodyOf(fall, model)};
  scene.obstacles = {plane(fall.friction)};
  if (fall.start == "stairs") addStairs(fall, out);
  if (fall.start == "sitting" || fall.start == "chair") addSeat(fall, out);
  if (fall.start == "bed")
    scene.obstacles.push_back(box({-1.2, -0.45, 0}, {1.2, 0.45, kBed}, fall.friction, "bed"));
  if (fall.kind == "slip") addSmooth(fall, out);
  if (!fall.push_body.empty()) {
    PokeSpec push;
    push.body = fall.push_body;
    push.force = fall.push;
    push.duration = fall.push_duration;
    push.where = "fall: push";
    scene.pokes.push_back(push);
  }
  if (fall.kind == "faint")  // a limp body stands by all its particles or not at all
    for (const ParticleSpec& p : model->particles) addPin(p.name, "faint", out);
  if (fall.hold > 0) {
    addPin(fall.foot, "trip", out);
    out.release = fall.hold;
  }
  return out;
}

std::vector<std::string> FallScene::held() const {
  std::vector<std::string> all;
  for (const PinSpec& pin : scene.pins) all.push_back(pin.particle);
  return all;
}

}  // namespace ragdoll::falls
