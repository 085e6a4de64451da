#include "markers.h"

#include <ros/node_handle.h>

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/body/limit_shapes.h"
#include "ragdoll_sim/ros/convert.h"
#include "ragdoll_sim/world/looks.h"

namespace ragdoll {
namespace {

using std::chrono::milliseconds;
using visualization_msgs::Marker;

constexpr milliseconds kMarkerPeriod{33};   ///< at most 30 Hz
constexpr milliseconds kStickPeriod{200};   ///< 5 Hz: the sticks of one body are 7 kB/s
constexpr std::chrono::seconds kSentAgain{60};  ///< a floor is 216 kB: 4 kB/s
constexpr std::chrono::seconds kReset{1};   ///< a slow rviz has seen a clock that went back
constexpr double kBodyLifetime = 0.5;       ///< [s]
constexpr double kForever = 0;              ///< [s]
constexpr int kMarkerQueue =
    16;  ///< messages kept for a slow listener: what is told once is not dropped
constexpr std::size_t kMostMessage = 1000000;  ///< [bytes] of a message, unless one marker has
                                               ///< more: roscpp counts the messages of a queue only
constexpr std::size_t kMostBodies = 8000000;  ///< [bytes] of a picture: 22 of the default coat
constexpr double kBodiesAtOnce = 20;          ///< as many live kBodyLifetime, more live longer
constexpr double kPokeLifetime = 0.15;        ///< [s] a poke of one step is seen this long
constexpr double kPullWidth = 0.01;           ///< [m]
constexpr double kStickWidth = 0.012;         ///< [m]
constexpr double kPinMargin = 0.015;          ///< [m] of a pin's ball around the particle's
const Rgba kStickColor{0.15f, 0.16f, 0.19f, 1};
const Rgba kPokeColor{0.92f, 0.26f, 0.21f, 0.95f};

bool samePose(const Pose& a, const Pose& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

/// [m] grows with the force but fits any: 10 N 0.3, 100 N 0.5, 1 kN 0.7
double arrowLength(double force) {
  return std::clamp(0.5 + 0.2 * std::log10(std::max(force, 1e-9) / 100), 0.2, 1.2);
}

}  // namespace

MarkerPublisher::MarkerPublisher(ros::NodeHandle& nh, const std::string& world_frame,
                                 const std::string& coat)
    : world_frame_(world_frame), coat_(coat) {
  const auto joined = [this] { newcomer_ = true; };
  markers_ = Topic::advertise<visualization_msgs::MarkerArray>(nh, "markers", kMarkerQueue, joined);
  scenery_ = Topic::advertise<visualization_msgs::MarkerArray>(nh, "scenery", kMarkerQueue, joined);
}

void MarkerPublisher::setCoat(const std::string& coat) {
  std::lock_guard<std::mutex> lock(coat_mutex_);
  other_coat_ = other_coat_ || coat != coat_;
  coat_ = coat;
}

void MarkerPublisher::publish(const Snapshot& world, const Posture& posture,
                              Simulation::Clock::time_point now) {
  if (!wanted()) return;
  for (const Poke& poke : world.acted)
    if (!contains(pokes_, poke)) pokes_.push_back(poke);
  if (!contacts_ || world.mark.run != contacts_run_) contact_markers_.clear();
  contacts_run_ = world.mark.run;
  if (contacts_ && world.contacts) contact_markers_.hear(*world.contacts);
  if (now < next_) return;
  next_ = std::max(next_ + kMarkerPeriod, now + kMarkerPeriod / 2);

  if (other_coat_.exchange(false) || world.scene != scene_) startScene(world);
  ++drawn_;
  // A clock that goes back, as that of a bag that is played again, makes rviz forget everything.
  const ros::Time time = ros::Time::now();
  if (time < time_) newcomer_ = true, reset_by_ = now + kReset;
  time_ = time;
  if (reset_by_ && now >= *reset_by_) newcomer_ = true, reset_by_.reset();
  const bool all = newcomer_.exchange(false), slow = all || now >= next_sticks_;
  if (slow) next_sticks_ = now + kStickPeriod;
  const bool again = all || now >= next_obstacles_;
  if (again) next_obstacles_ = now + kSentAgain;
  message_.markers.clear();
  addObstacles(world, again);
  addScenery(world, posture, slow);
  if (!message_.markers.empty()) scenery_.publisher().publish(message_);
  if (!markers_.isHeard()) return;
  if (divided_ && !again) addObstacles(world, true);  // its queue is soon full
  if (slow) addSticks(world, posture);
  addBodies(world, posture, now, all);
  send();
}

void MarkerPublisher::makeBodies(const Snapshot& world) {
  std::map<int, std::shared_ptr<Coat>> coats;  // by skeleton
  for (int i = 0; i < world.tracker->ragdolls(); ++i) {
    std::shared_ptr<Coat>& coat = coats[world.model->ragdolls[i].skeleton];
    if (!coat) coat = std::make_shared<Coat>(kind_, *world.model, *world.tracker, i);
    bodies_.emplace_back(coat, world_frame_, i, 1 + i * BodyMarkers::kIds);
  }
}

/// In turn, as many as a picture may have.
void MarkerPublisher::addBodies(const Snapshot& world, const Posture& posture,
                                Simulation::Clock::time_point now, bool all) {
  if (bodies_.empty()) makeBodies(world);
  if (all)
    for (BodyMarkers& body : bodies_) body.tellAll();
  const double lifetime =
      kBodyLifetime * std::max(1.0, static_cast<double>(bodies_.size()) / kBodiesAtOnce);
  std::vector<Marker>& markers = message_.markers;
  std::size_t bytes = 0;
  for (std::size_t told = 0; told < bodies_.size() && bytes < kMostBodies; ++told) {
    std::size_t counted = markers.size();
    bodies_[next_body_].append(*world.model, *world.tracker, posture, now, frames_, lifetime,
                               markers);
    next_body_ = (next_body_ + 1) % bodies_.size();
    for (; counted < markers.size(); ++counted)
      bytes += ros::serialization::serializationLength(markers[counted]);
  }
}

/// The picture, in messages of kMostMessage.
void MarkerPublisher::send() {
  visualization_msgs::MarkerArray part;
  std::size_t bytes = 0;
  divided_ = false;
  for (Marker& marker : message_.markers) {
    const std::size_t more = ros::serialization::serializationLength(marker);
    if (!part.markers.empty() && bytes + more > kMostMessage) {
      markers_.publisher().publish(part);
      part.markers.clear();
      bytes = 0;
      divided_ = true;
    }
    bytes += more;
    part.markers.push_back(std::move(marker));
  }
  if (!part.markers.empty()) markers_.publisher().publish(part);
}

void MarkerPublisher::addScenery(const Snapshot& world, const Posture& posture, bool slow) {
  addPokes(world, posture);
  addPulls(world, posture);
  if (slow) addPins(world, posture);
  pokes_.clear();
  if (limits_) addLimits(world, posture);
  if (contacts_) addContacts();
}

void MarkerPublisher::clear() {
  visualization_msgs::MarkerArray message;
  message.markers.push_back(marker("", 0, 0));
  message.markers[0].action = Marker::DELETEALL;
  markers_.publisher().publish(message);
  scenery_.publisher().publish(message);
}

void MarkerPublisher::startScene(const Snapshot& world) {
  scene_ = world.scene;
  kind_ = [this] {
    std::lock_guard<std::mutex> lock(coat_mutex_);
    return coatKind(coat_.empty() ? scene_->coat : coat_);
  }();
  clear();
  bodies_.clear();  // made for the first that wants them
  next_body_ = 0;
  divided_ = false;
  contact_markers_.clear();

  obstacles_.clear();
  shown_obstacles_.clear();
  for (std::size_t i = 0; i < world.model->obstacles.size(); ++i) {
    Marker m = marker("obstacles", static_cast<int>(i), kForever);
    toMarker(obstacleLook(*world.model, static_cast<int>(i)), m);
    obstacles_.push_back(std::move(m));
  }
  newcomer_ = true;
}

Marker MarkerPublisher::marker(const std::string& ns, int id, double lifetime) const {
  Marker m;
  m.header.frame_id = world_frame_;  // stamp 0: to be shown whenever it arrives
  m.ns = ns;
  m.id = id;
  m.action = Marker::ADD;
  m.pose.orientation.w = 1;
  m.lifetime = ros::Duration(lifetime);
  return m;
}

void MarkerPublisher::addSticks(const Snapshot& world, const Posture& posture) {
  Marker m = marker("sticks", 0, kBodyLifetime);
  m.type = Marker::LINE_LIST;
  m.scale.x = kStickWidth;
  m.color = toColor(kStickColor);
  for (const Ragdoll& r : world.model->ragdolls) {
    for (const Stick& s : world.model->skeletonOf(r).sticks) {
      m.points.push_back(toPoint(posture.x.col(r.first + s.a)));
      m.points.push_back(toPoint(posture.x.col(r.first + s.b)));
    }
  }
  message_.markers.push_back(std::move(m));
}

void MarkerPublisher::addObstacles(const Snapshot& world, bool all) {
  const std::vector<Pose>& poses = world.state.obstacles;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const bool moved = i < shown_obstacles_.size() && !samePose(shown_obstacles_[i], poses[i]);
    if (!all && !moved) continue;
    obstacles_[i].pose = toPose(poses[i]);
    message_.markers.push_back(obstacles_[i]);
  }
  shown_obstacles_ = poses;
}

void MarkerPublisher::addPokes(const Snapshot& world, const Posture& posture) {
  int id = 0;
  for (const Poke& poke : pokes_) {
    if (poke.force.isZero()) continue;
    const Vec3 direction = poke.force.normalized();
    Vec3 tip = poke.point;
    double depth = 0;  // of the body's point below its surface
    for (std::size_t i = 0; i < poke.body.particles.size(); ++i) {
      tip += poke.body.weight[i] * posture.x.col(poke.body.particles[i]);
      depth = std::max(depth, world.model->radius[poke.body.particles[i]]);
    }
    tip -= depth * direction;
    Marker m = marker("pokes", id++, kPokeLifetime);
    m.type = Marker::ARROW;
    m.points = {toPoint(tip - arrowLength(poke.force.norm()) * direction), toPoint(tip)};
    m.scale = toVector3(Vec3(0.025, 0.07, 0.12));  // shaft, head, head's length
    m.color = toColor(kPokeColor);
    message_.markers.push_back(std::move(m));
  }
}

void MarkerPublisher::addPulls(const Snapshot& world, const Posture& posture) {
  if (world.pulls.empty()) return;
  Marker m = marker("pulls", 0, kPokeLifetime);
  m.type = Marker::LINE_LIST;
  m.scale.x = kPullWidth;
  m.color = toColor(kPokeColor);
  for (const Pull& pull : world.pulls) {
    m.points.push_back(toPoint(posture.x.col(pull.body.particles[0])));
    m.points.push_back(toPoint(pull.target));
  }
  message_.markers.push_back(std::move(m));
}

/// A ball around each particle that is held: what hangs in the air does not hang on nothing.
void MarkerPublisher::addPins(const Snapshot& world, const Posture& posture) {
  int id = 0;
  for (const Pin& pin : world.model->pins) {
    Marker m = marker("pins", id++, kBodyLifetime);
    m.type = Marker::SPHERE;
    m.pose.position = toPoint(posture.x.col(pin.particle));
    m.scale = toVector3(Vec3::Constant(2 * (world.model->radius[pin.particle] + kPinMargin)));
    m.color = toColor(kStickColor);
    message_.markers.push_back(std::move(m));
  }
}

void MarkerPublisher::addLimits(const Snapshot& world, const Posture& posture) {
  int id = 0;
  for (int i = 0; i < world.tracker->ragdolls(); ++i)
    for (const CoatShape& shape : limitShapes(*world.model, *world.tracker, posture, i)) {
      Marker m = marker("limits", id++, kBodyLifetime);
      toMarker(shape, m);
      message_.markers.push_back(std::move(m));
    }
}

void MarkerPublisher::addContacts() {
  contact_markers_.append(marker("", 0, kPokeLifetime), message_.markers);
}

}  // namespace ragdoll
