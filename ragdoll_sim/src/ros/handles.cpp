#include "handles.h"

#include <ros/console.h>
#include <visualization_msgs/InteractiveMarkerInit.h>
#include <visualization_msgs/InteractiveMarkerUpdate.h>

#include <algorithm>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

using std::chrono::milliseconds;
using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using visualization_msgs::InteractiveMarkerFeedback;
using visualization_msgs::Marker;

constexpr milliseconds kHandlePeriod{70};  ///< between two updates of the handles, at most
constexpr milliseconds kLetGoAfter{
    1000};  ///< rviz is heard of four times a second while it holds one
constexpr std::size_t kManyHandles = 60;  ///< more than this are thinned out
constexpr std::size_t kMaxHandles = 100;  ///< more than this rviz draws slowly
constexpr double kSize = 1.15;            ///< of a handle, in sizes of its particle
constexpr double kMinRadius = 0.065;      ///< [m] of a handle
constexpr double kBadFeedbackPeriod = 1;  ///< [s] bad feedback is reported this often
const Rgba kColor{1.0f, 0.72f, 0.25f, 0.14f};

/// The ends of bones, or only those from which no other bone goes on; all particles of a body
/// without bones.
std::vector<int> mainParticles(const Skeleton& skeleton, bool only_tips) {
  std::vector<bool> from(skeleton.named, false), to(skeleton.named, false);
  for (const Segment& s : skeleton.segments) {
    if (s.group || s.particles.size() != 2) continue;
    from[s.particles[0]] = true;
    to[s.particles[1]] = true;
  }
  const bool none = std::find(to.begin(), to.end(), true) == to.end();
  std::vector<int> particles;
  for (int p = 0; p < skeleton.named; ++p)
    if (none || (only_tips ? to[p] && !from[p] : to[p] || from[p])) particles.push_back(p);
  return particles;
}

std::vector<Handle> handlesOf(const Model& model, bool only_tips) {
  std::vector<Handle> handles;
  for (const Ragdoll& r : model.ragdolls) {
    const Skeleton& skeleton = model.skeletonOf(r);
    for (const int p : mainParticles(skeleton, only_tips))
      handles.push_back({r.name + "/" + skeleton.particles[p],
                         r.first + p,
                         std::max(kMinRadius, kSize * skeleton.radius[p]),
                         {}});
  }
  return handles;
}

/// As many as rviz draws with ease: of many bodies only the tips of the limbs, of very many the
/// first.
std::vector<Handle> handlesOf(const Model& model) {
  std::vector<Handle> handles = handlesOf(model, false);
  if (handles.size() > kManyHandles) handles = handlesOf(model, true);
  if (handles.size() > kMaxHandles) {
    ROS_INFO("no handles from %s on", handles[kMaxHandles].name.c_str());
    handles.resize(kMaxHandles);
  }
  return handles;
}

/// A sphere that moves parallel to the view, with shift towards it.
InteractiveMarkerControl control(double radius) {
  Marker sphere;
  sphere.type = Marker::SPHERE;
  sphere.scale = toVector3(Vec3::Constant(2 * radius));
  sphere.color = toColor(kColor);
  sphere.pose.orientation.w = 1;
  InteractiveMarkerControl c;
  c.name = "pull";
  c.interaction_mode = InteractiveMarkerControl::MOVE_3D;
  c.orientation.w = 1;
  c.markers.push_back(sphere);
  return c;
}

geometry_msgs::Pose poseAt(const Vec3& position) { return toPose({position, Quat::Identity()}); }

}  // namespace

Handles::Handles(ros::NodeHandle& nh, Simulation& simulation, const FrameLookup& frames)
    : simulation_(simulation), frames_(frames), server_(nh.resolveName("handles")) {
  changes_ =
      Topic::advertise<visualization_msgs::InteractiveMarkerUpdate>(nh, "handles/update", 100);
  all_ =
      Topic::advertise<visualization_msgs::InteractiveMarkerInit>(nh, "handles/update_full", 100);
}

void Handles::feedback(const Feedback& message) {
  try {
    switch (message.event_type) {
      case Feedback::MOUSE_DOWN:
      case Feedback::POSE_UPDATE:
        hold(message);
        break;
      case Feedback::KEEP_ALIVE: {
        std::lock_guard<std::mutex> lock(mutex_);
        const auto grip = grips_.find(message.marker_name);
        if (grip == grips_.end()) break;
        // A jump or a clearing has ended the pull: it begins again when the mouse moves.
        if (isPulled(grip->first))
          grip->second = Simulation::Clock::now();
        else
          grips_.erase(grip);
        break;
      }
      case Feedback::MOUSE_UP: {
        std::lock_guard<std::mutex> lock(mutex_);
        grips_.erase(message.marker_name);
        simulation_.call([&](World& world) { world.release(message.marker_name); });
        break;
      }
      default:
        break;
    }
  } catch (const Error& e) {
    ROS_WARN_THROTTLE(kBadFeedbackPeriod, "~handles/feedback ignored: %s", e.what());
  }
}

bool Handles::isPulled(const std::string& name) {
  return simulation_.call([&](World& world) {
    const std::vector<Pull>& pulls = world.pulls();
    return std::any_of(pulls.begin(), pulls.end(),
                       [&](const Pull& pull) { return pull.body_name == name; });
  });
}

void Handles::hold(const Feedback& message) {
  const Vec3 point = fromPoint(message.pose.position);
  if (!point.allFinite())
    throw Error("pose", "the position of " + message.marker_name + " must be three finite numbers");
  const std::string frame = FrameLookup::normal(message.header.frame_id);
  std::lock_guard<std::mutex> lock(mutex_);
  simulation_.call([&](World& world) {
    const std::optional<Pose> own = world.frame(frame);
    const Pose pose = own ? *own : frames_.inWorld(frame);
    const Vec3 target = pose.position + pose.orientation * point;
    checkPosition("pose", target);
    world.pull(message.marker_name, target);
  });
  grips_[message.marker_name] = Simulation::Clock::now();
  touched_.insert(message.marker_name);
}

void Handles::update() {
  due_ = Simulation::Clock::now() + kHandlePeriod;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    endSilentGrips();
  }
  if (changes_.isHeard() || all_.isHeard()) follow();
}

/// REQUIRES: mutex_ is held, so that no feedback comes in between.
void Handles::endSilentGrips() {
  const auto now = Simulation::Clock::now();
  for (auto grip = grips_.begin(); grip != grips_.end();) {
    if (now - grip->second < kLetGoAfter) {
      ++grip;
      continue;
    }
    simulation_.call([&](World& world) { world.release(grip->first); });
    ROS_WARN("handle '%s' is let go: nothing more was heard of who held it", grip->first.c_str());
    grip = grips_.erase(grip);
  }
}

void Handles::follow() {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Model> model;
  Points x;
  simulation_.look([&](World& world) {
    scene = world.scene();
    model = world.model();
    x = world.state().x;
  });
  bool moved = scene != scene_;
  if (moved) rebuild(*model, x);
  scene_ = scene;
  // The server is not called under the lock: it holds one of its own around feedback().
  std::set<std::string> held, touched;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& grip : grips_) held.insert(grip.first);
    touched.swap(touched_);
  }
  for (Handle& handle : handles_) {
    const Vec3 at = x.col(handle.particle);
    if (touched.count(handle.name) > 0) handle.shown.reset();  // it is where the mouse has put it
    if (held.count(handle.name) > 0 || handle.shown == at) continue;
    server_.setPose(handle.name, poseAt(at));
    handle.shown = at;
    moved = true;
  }
  if (moved) server_.applyChanges();
}

void Handles::rebuild(const Model& model, const Points& x) {
  std::vector<Handle> handles = handlesOf(model);
  if (handles == handles_) return;  // other settings for the same bodies
  handles_ = std::move(handles);
  server_.clear();
  for (const Handle& handle : handles_) {
    InteractiveMarker m;
    m.header.frame_id = frames_.worldFrame();
    m.name = handle.name;
    m.pose = poseAt(x.col(handle.particle));
    m.scale = static_cast<float>(2 * handle.radius);
    m.controls.push_back(control(handle.radius));
    server_.insert(m, [this](const InteractiveMarkerFeedback::ConstPtr& f) { feedback(*f); });
  }
}

}  // namespace ragdoll
