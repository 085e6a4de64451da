#include "ragdoll_sim/core/build_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/loading/contact_regions.h"
#include "core/loading/idle_settings.h"
#include "core/loading/sensors.h"
#include "core/loading/skeleton.h"
#include "core/loading/start_pose.h"
#include "core/loading/system.h"
#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/self_pairs.h"

namespace ragdoll {
namespace {

constexpr int kMaxParticles = 1000000;  ///< in a scene; more is a typing error
/// Of a scene's systems, whose matrices over particles and sticks are dense: 2 GB and about 10 s.
constexpr double kMaxNumbers = 1e8, kMaxWork = 2e10;

void checkSolver(const SolverSpec& s) {
  if (!(s.step > 0 && s.step <= 1))
    throw Error(s.where + ".step", "step is " + numberText(s.step) + "; it must be in (0, 1] s");
  if (s.sweeps < 1 || s.sweeps > 100000)
    throw Error(s.where + ".sweeps",
                "sweeps is " + std::to_string(s.sweeps) + "; it must be in 1 ... 100000");
  checkTolerance(s.where + ".tolerance", s.tolerance);
  checkThreads(s.where + ".threads", s.threads);
  if (!(std::isfinite(s.damping) && s.damping >= 0))
    throw Error(s.where + ".damping", "damping must be >= 0 [1/s]");
  if (!(std::isfinite(s.joint_damping) && s.joint_damping >= 0))
    throw Error(s.where + ".joint_damping", "joint_damping must be >= 0 [1/s]");
}

Quat frameWithZ(const Vec3& z) { return Quat::FromTwoVectors(Vec3::UnitZ(), z.normalized()); }

Obstacle resolve(const ObstacleSpec& o) {
  using Type = ObstacleSpec::Type;
  Obstacle out;
  out.type = o.type;
  out.pose = {o.pose.position, o.pose.orientation.normalized()};
  const bool is_round = o.type == Type::kSphere || o.type == Type::kCapsule;
  out.radius = is_round ? o.radius : 0;
  out.friction = o.friction;
  out.restitution = o.restitution;
  out.frame = o.frame;
  out.contact = complianceOf(o.contact, o.where);
  if (!(std::isfinite(o.friction) && o.friction >= 0))
    throw Error(o.where + ".friction", "friction must be >= 0");
  if (!(o.restitution >= 0 && o.restitution <= 1))
    throw Error(o.where + ".restitution", "restitution must be in [0, 1]");
  checkPosition(o.where + (o.type == Type::kPlane ? ".point" : ".position"), o.pose.position);
  checkLength(o.where + ".radius", o.radius);
  if ((o.type == Type::kSphere || o.type == Type::kCapsule) && !(o.radius > 0))
    throw Error(o.where + ".radius", "radius must be > 0 [m]");
  if (o.type == Type::kBox) {
    if (!(o.size.minCoeff() > 0))
      throw Error(o.where + ".size", "size must be > 0 [m] on each axis");
    checkLength(o.where + ".size", o.size.maxCoeff());
    out.half = 0.5 * o.size;
  } else if (o.type == Type::kPlane) {
    if (!(o.normal.norm() > kMinLength))
      throw Error(o.where + ".normal", "normal must be a direction, not zero");
    out.pose.orientation = frameWithZ(o.normal);
  } else if (o.type == Type::kCapsule) {
    checkPosition(o.where + ".from", o.from);
    checkPosition(o.where + ".to", o.to);
    const Vec3 axis = o.to - o.from;
    out.pose = {0.5 * (o.from + o.to),
                axis.norm() > kMinLength ? frameWithZ(axis) : Quat::Identity()};
    out.half = Vec3(0, 0, 0.5 * axis.norm());
  }
  return out;
}

std::string defaultName(const ObstacleSpec& o, std::size_t number) {
  const char* const types[] = {"plane", "box", "sphere", "capsule"};
  return types[static_cast<int>(o.type)] + ("_" + std::to_string(number));
}

void addObstacle(const ObstacleSpec& o, Model& model) {
  Obstacle obstacle = resolve(o);
  obstacle.name = o.name.empty() ? defaultName(o, model.obstacles.size()) : o.name;
  for (const Obstacle& other : model.obstacles)
    if (other.name == obstacle.name)
      throw Error(o.where + ".name",
                  "name '" + obstacle.name + "' is another obstacle's; each needs its own");
  model.obstacles.push_back(std::move(obstacle));
}

/// One RagdollSpec for each body: `count` unrolled on a square grid around the given position.
std::vector<RagdollSpec> unrolled(const Scene& scene) {
  std::vector<RagdollSpec> out;
  for (const RagdollSpec& r : scene.ragdolls) {
    if (!r.skeleton) throw Error(r.where, "ragdoll '" + r.name + "' has no model");
    if (r.count < 0) throw Error(r.where + ".count", "count must be >= 1");
    checkPosition(r.where + ".position", r.pose.position);
    if (r.count == 0) {
      out.push_back(r);
      continue;
    }
    if (static_cast<double>(r.count) * r.skeleton->particles.size() > kMaxParticles)
      throw Error(r.where + ".count", "more than " + std::to_string(kMaxParticles) + " particles");
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(r.count))));
    for (int i = 0; i < r.count; ++i) {
      RagdollSpec one = r;
      one.count = 0;
      one.name = r.name + "_" + std::to_string(i);
      one.pose.position += Vec3(i % side, i / side, i % side + i / side).cwiseProduct(r.spacing);
      checkPosition(r.where + ".spacing", one.pose.position, "puts '" + one.name + "' at");
      out.push_back(std::move(one));
    }
  }
  return out;
}

/// v (3 x n) <- the velocities of the body as a whole, about its centre of mass at x.
void startMoving(const RagdollSpec& spec, const Skeleton& s, const Eigen::Ref<const Points>& x,
                 Eigen::Ref<Points> v) {
  const int n = s.size();
  const Eigen::RowVectorXd share =
      Eigen::RowVectorXd::Ones(n) * s.M;  // mass that each point stands for
  const Vec3 com = x * share.transpose() / share.sum();
  checkSpeed(spec.where + ".velocity", spec.velocity);
  for (int i = 0; i < n; ++i)
    v.col(i) = spec.velocity + spec.angular_velocity.cross(x.col(i) - com);
  Eigen::Index fastest = 0;
  v.colwise().squaredNorm().maxCoeff(&fastest);
  checkSpeed(spec.where + ".angular_velocity", v.col(fastest));
}

/// start: the model's start pose.
void placeRagdoll(const RagdollSpec& spec, const Skeleton& s, const Points& start, int first,
                  Model& model) {
  const int n = s.size();
  auto x = model.start_position.middleCols(first, n);
  auto v = model.start_velocity.middleCols(first, n);
  const Quat q = spec.pose.orientation.normalized();
  x = (q.toRotationMatrix() * start).colwise() + spec.pose.position;
  startMoving(spec, s, x, v);
  for (const auto& [name, position] : spec.place) {
    const int i = s.particle(name);
    if (i < 0 || i >= s.named)
      throw Error(spec.where + ".place",
                  "unknown particle '" + name + "'; the model has " +
                      joined({s.particles.begin(), s.particles.begin() + s.named}));
    checkPosition(spec.where + ".place." + name, position);
    x.col(i) = position;
  }
}

void addRagdolls(const Scene& scene, const std::vector<RagdollSpec>& specs, Model& model) {
  std::map<const SkeletonSpec*, int> known;
  std::set<std::string> names;
  std::vector<Points> starts;  // of each skeleton
  int size = 0;
  if (specs.empty()) throw Error(scene.where, "ragdolls: a scene needs at least one ragdoll");
  for (const RagdollSpec& r : specs) {
    if (r.name.empty() || r.name.find('/') != std::string::npos)
      throw Error(r.where + ".name", "name '" + r.name + "' must be a word without '/'");
    if (!names.insert(r.name).second)
      throw Error(r.where + ".name",
                  "name '" + r.name + "' is another ragdoll's; each needs its own");
    auto [it, fresh] =
        known.try_emplace(r.skeleton.get(), static_cast<int>(model.skeletons.size()));
    if (fresh) {
      model.skeletons.push_back(buildSkeleton(*r.skeleton));
      starts.push_back(startPose(*r.skeleton, model.skeletons.back()));
      const std::vector<std::string>& doubts = model.skeletons.back().warnings;
      model.warnings.insert(model.warnings.end(), doubts.begin(), doubts.end());
    }
    model.ragdolls.push_back({r.name, it->second, 0, size});
    size += model.skeletons[it->second].size();
    if (size > kMaxParticles)
      throw Error(r.where, "more than " + std::to_string(kMaxParticles) + " particles");
  }
  model.start_position.resize(3, size);
  model.start_velocity.resize(3, size);
  model.radius.resize(size);
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const Ragdoll& r = model.ragdolls[i];
    const Skeleton& s = model.skeletonOf(r);
    placeRagdoll(specs[i], s, starts[r.skeleton], r.first, model);
    model.radius.segment(r.first, s.size()) = s.radius;
  }
}

std::vector<Pin> resolvePins(const Scene& scene, const Model& model) {
  std::vector<Pin> pins;
  for (const PinSpec& p : scene.pins) {
    BodyRef body;
    try {
      body = findBody(model, p.particle);
    } catch (const Error& e) {
      throw Error(p.where, e.what());
    }
    if (body.particles.size() != 1)
      throw Error(p.where, "'" + p.particle + "' is a segment; a pin holds a particle");
    const int i = body.particles[0];
    for (const Pin& other : pins)
      if (other.particle == i)
        throw Error(p.where, "particle '" + p.particle + "' is pinned twice");
    pins.push_back({body.ragdoll, i, model.start_position.col(i), p.frame});
  }
  return pins;
}

Poke resolve(const PokeSpec& p, Model& model) {
  Poke poke;
  try {
    poke.body = findBody(model, p.body);
  } catch (const Error& e) {
    throw Error(p.where + ".body", e.what());
  }
  if (!p.force.allFinite()) throw Error(p.where + ".force", "force must be finite numbers [N]");
  if (!p.point.allFinite()) throw Error(p.where + ".point", "point must be finite numbers [m]");
  if (!std::isfinite(p.at)) throw Error(p.where + ".at", "at must be a finite number [s]");
  if (!std::isfinite(p.duration))
    throw Error(p.where + ".duration", "duration must be a finite number [s]");
  poke.body_name = p.body;
  poke.start = p.at;
  poke.duration = p.duration;
  poke.force = p.force;
  poke.point = p.point;
  try {
    checkForce(model, poke);
  } catch (const Error& e) {
    throw Error(p.where, e.what());
  }
  const std::string lost = lostMomentText(poke, model.start_position);
  if (!lost.empty()) model.warnings.push_back(p.where + " on '" + p.body + "': " + lost);
  return poke;
}

/// Which contacts give way.
void addCompliance(const std::vector<RagdollSpec>& specs, Model& model) {
  const auto gives = [](const auto& part) { return part.contact.compliance > 0; };
  model.compliant = std::any_of(model.obstacles.begin(), model.obstacles.end(), gives);
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (!specs[i].compliant) continue;
    const Skeleton& s = model.skeletonOf(model.ragdolls[i]);
    if (std::none_of(s.segments.begin(), s.segments.end(), gives))
      throw Error(specs[i].where + ".contact",
                  "is compliant, but no segment of model '" + s.name +
                      "' has a contact: {stiffness: ..., damping: ...}; 'rigid' is expected");
    model.ragdolls[i].compliant = model.compliant = true;
  }
}

}  // namespace

Model buildModel(const Scene& scene) {
  Model model;
  checkSolver(scene.solver);
  checkGravity(scene.where + ": gravity", scene.gravity, scene.solver.step);
  model.gravity = scene.gravity;
  model.solver = scene.solver;
  model.self_collision = scene.self_collision;
  model.ragdoll_collision = scene.ragdoll_collision;
  const std::vector<RagdollSpec> specs = unrolled(scene);
  addRagdolls(scene, specs, model);
  if (model.self_collision || model.ragdoll_collision)
    for (Skeleton& s : model.skeletons) {
      addCapsules(s, model.self_collision);
      if (model.self_collision) model.notes.push_back(describePairs(s));
    }
  for (const ObstacleSpec& o : scene.obstacles) addObstacle(o, model);
  addCompliance(specs, model);
  const std::vector<Pin> pins = resolvePins(scene, model);
  try {
    setPins(model, pins);
  } catch (const Error& e) {  // it knows no file
    throw Error(scene.where, e.what());
  }
  for (std::size_t i = 0; i < specs.size(); ++i)
    if (!specs[i].place.empty()) {
      correctStart(specs[i], model, static_cast<int>(i));
      const Ragdoll& r = model.ragdolls[i];
      const Skeleton& s = model.skeletonOf(r);
      startMoving(specs[i], s, model.start_position.middleCols(r.first, s.size()),
                  model.start_velocity.middleCols(r.first, s.size()));
    }
  for (Pin& p : model.pins) p.target = model.start_position.col(p.particle);
  for (const PokeSpec& p : scene.pokes) model.pokes.push_back(resolve(p, model));
  for (const SensorSpec& s : scene.sensors) addSensor(s, model);
  std::stable_sort(model.pokes.begin(), model.pokes.end(), [&](const Poke& a, const Poke& b) {
    return actsBefore(a, b, model.solver.step);
  });
  warnOfIdleSettings(model);
  return model;
}

void setPins(Model& model, const std::vector<Pin>& pins) {
  std::map<std::pair<int, std::vector<int>>, int> known;
  std::vector<std::pair<int, std::vector<int>>> wanted;  // skeleton and pins of each system
  std::vector<int> chosen;
  double numbers = 0, work = 0;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    const Ragdoll& r = model.ragdolls[i];
    std::vector<int> local;
    for (const Pin& p : pins)
      if (p.ragdoll == static_cast<int>(i)) local.push_back(p.particle - r.first);
    std::sort(local.begin(), local.end());
    const auto [it, fresh] =
        known.try_emplace({r.skeleton, local}, static_cast<int>(wanted.size()));
    chosen.push_back(it->second);
    if (!fresh) continue;
    wanted.push_back(it->first);
    const Skeleton& s = model.skeletonOf(r);
    const double size = s.size() + static_cast<double>(s.sticks.size() + s.hidden_sticks.size());
    numbers += size * size;
    work += size * size * size;
    if (numbers > kMaxNumbers || work > kMaxWork)
      throw Error("ragdoll '" + r.name + "'",
                  "is too much: its model and those before it, once for each set of pins, have "
                  "matrices that are too large; use smaller models, or the same ones again");
  }
  std::vector<System> systems;
  for (const auto& [skeleton, local] : wanted)
    systems.push_back(buildSystem(model.skeletons[skeleton], skeleton, local, model.warnings));
  model.pins = pins;
  model.systems = std::move(systems);
  for (std::size_t i = 0; i < chosen.size(); ++i) model.ragdolls[i].system = chosen[i];
}

}  // namespace ragdoll
