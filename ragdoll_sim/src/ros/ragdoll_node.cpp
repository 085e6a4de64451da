// The node: reads the parameters, starts the simulation, the publisher and the services, and waits.
#include <ros/ros.h>
#include <semaphore.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "attachments.h"
#include "callback_threads.h"
#include "control.h"
#include "frame_lookup.h"
#include "handles.h"
#include "parameters.h"
#include "pokes.h"
#include "publisher.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/simulation.h"
#include "ragdoll_sim/world/text.h"
#include "reconfigure.h"
#include "ros_clock.h"
#include "scenes.h"
#include "settings.h"

namespace {

constexpr int kCallbackThreads = 4;  ///< a long ~step leaves some for the other services

ragdoll::World loadWorld(const std::string& parameter, const ragdoll::Parameters& parameters,
                         const ragdoll::GivenSettings& given) {
  const bool is_text = ragdoll::isSceneText(parameters.scene);
  const std::string name = is_text ? "" : parameters.scene;
  ragdoll::Scene scene;
  try {
    scene = is_text ? ragdoll::parseScene(parameters.scene, "scene")
                    : ragdoll::loadScene(ragdoll::resolvePackage(name));
  } catch (const ragdoll::Error& e) {
    throw ragdoll::Error("parameter " + parameter, e.what());
  }
  given.apply(scene);
  try {
    ragdoll::World world(std::move(scene), name, parameters.frame_prefix);
    ragdoll::tellChecks(world);
    ROS_INFO("scene '%s': %s", is_text ? "of the parameter" : name.c_str(),
             ragdoll::contents(*world.model()).c_str());
    if (const std::string settings = given.overriding(); !settings.empty())
      ROS_INFO("parameters override the scene's: %s", settings.c_str());
    return world;
  } catch (const ragdoll::Error& e) {
    throw ragdoll::Error("parameter " + parameter, e.what());
  }
}

ragdoll::Simulation::Options pace(const ragdoll::Parameters& parameters) {
  ragdoll::Simulation::Options options;
  options.realtime_factor = parameters.realtime_factor;
  options.paused = parameters.start_paused;
  if (ros::Time::isSimTime() && !parameters.publish_clock)
    options.external_clock = [] { return ros::Time::now().toSec(); };
  return options;
}

/// SIGINT and SIGTERM end the node, but while it starts they wait: a publisher that ROS hands out
/// as it shuts down ends the process (SIGTRAP) at its first message. The second signal does not
/// wait, as the start may: for a master that is gone.
class Signals {
 public:
  Signals() {
    sem_init(&news_, 0, 0);
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, take);
  }
  /// False if a signal came before.
  static bool defer() {
    deferred_ = true;
    return !taken_;
  }
  static void release() {
    runs_ = true;
    deferred_ = false;
  }
  /// Returns when a signal has come, or once ROS ends the node for another reason.
  static void wait() {
    while (ros::ok() && !ros::isShuttingDown() && !taken_) {
      timespec until{};
      clock_gettime(CLOCK_MONOTONIC, &until);
      until.tv_nsec += kPoll;
      if (until.tv_nsec >= kSecond) ++until.tv_sec, until.tv_nsec -= kSecond;
      sem_clockwait(&news_, CLOCK_MONOTONIC, &until);
    }
  }

 private:
  static constexpr long kSecond = 1000000000;  // [ns]
  static constexpr long kPoll = kSecond / 4;   ///< [ns] between two looks at ROS
  static void take(int) {
    if (taken_.exchange(true) || !(deferred_ || runs_)) ros::requestShutdown();
    sem_post(&news_);  // of what may wake a thread the one thing that a signal may do
  }
  static inline sem_t news_;
  static inline std::atomic<bool> deferred_{false}, runs_{false}, taken_{false};
};

/// /use_sim_time for as long as this node is the clock; left alone where someone has set it before.
/// A record on the server tells whether that was a node like this one, which was killed or still
/// is the clock, too: the last one takes it away.
class SimTime {
 public:
  explicit SimTime(bool wanted) {
    bool before = false;
    given_ = ros::param::get(kName, before);
    if (!wanted || (before && !ros::param::get(kRecord, given_))) return;
    ros::param::set(kRecord, given_);
    ros::param::set(kName, true);
    set_ = true;
  }
  ~SimTime() {
    if (!set_ || !ros::master::check()) return;  // ROS would wait for one
    if (!alone_ && isPublished()) return;
    ros::param::del(kRecord);
    bool now = false;
    if (!ros::param::get(kName, now) || !now) return;  // someone has set it since
    if (given_)
      ros::param::set(kName, false);
    else
      ros::param::del(kName);
  }
  /// No other node is the clock: the master may name one that was killed.
  void setAlone() { alone_ = true; }
  SimTime(const SimTime&) = delete;
  SimTime& operator=(const SimTime&) = delete;

 private:
  static constexpr const char* kName = "/use_sim_time";
  static constexpr const char* kRecord = "/ragdoll_sim/use_sim_time_was_given";
  /// /clock, by the master: when this node does not, by another.
  static bool isPublished() {
    ros::master::V_TopicInfo topics;
    ros::master::getTopics(topics);
    return std::any_of(topics.begin(), topics.end(),
                       [](const ros::master::TopicInfo& topic) { return topic.name == "/clock"; });
  }
  bool alone_ = false;
  bool given_ = false;  ///< as false, before
  bool set_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "ragdoll", ros::init_options::NoSigintHandler);
  const Signals signals;
  ros::NodeHandle nh("~");
  try {
    const ragdoll::GivenSettings given(nh);
    const ragdoll::Parameters parameters = ragdoll::readParameters(nh, given);
    if (!signals.defer()) return 0;
    // Whoever starts after this follows the clock that this node is going to publish.
    SimTime sim_time(parameters.publish_clock);
    const ragdoll::RosClock clock(parameters.publish_clock);
    ragdoll::World world = loadWorld(nh.resolveName("scene"), parameters, given);
    ragdoll::checkWorldFrame("parameter " + nh.resolveName("world_frame"), world, parameters);
    ragdoll::Simulation simulation(std::move(world), pace(parameters));
    simulation.call(
        [&](ragdoll::World& world) { world.setMaxFrameSpeed(parameters.max_frame_speed); });
    ragdoll::FrameLookup frames(parameters.world_frame);
    ragdoll::Attachments attachments(nh, simulation, clock, frames);
    ragdoll::Handles handles(nh, simulation, frames);
    std::unique_ptr<ragdoll::ClockPublisher> ticks;
    if (clock.own()) ticks = std::make_unique<ragdoll::ClockPublisher>(nh, simulation, clock);
    ragdoll::Publisher publisher(
        nh, simulation, clock, parameters,
        {[&] { return attachments.missing(); }, [&] { return frames.rivals(); },
         [&] { return ticks ? ticks->rivals() : std::vector<std::string>(); }},
        handles);
    ragdoll::Control control(nh, simulation, publisher);
    ragdoll::Pokes pokes(nh, simulation, clock, frames, parameters.wrench_timeout);
    ragdoll::Reconfigure reconfigure(nh, simulation, publisher, parameters, given);
    ragdoll::Scenes scenes(nh, simulation, publisher, clock, parameters,
                           [&] { reconfigure.refresh(); });
    const ragdoll::CallbackThreads callbacks(kCallbackThreads);
    signals.release();
    signals.wait();
    publisher.clearMarkers();
    if (ticks && ticks->isAlone()) sim_time.setAlone();
    ros::requestShutdown();
    simulation.end();  // else ROS would wait for a call that waits for its steps
    ros::waitForShutdown();
    given.restore();
  } catch (const ragdoll::Error& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
