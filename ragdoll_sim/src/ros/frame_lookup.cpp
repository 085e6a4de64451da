#include "frame_lookup.h"

#include <ros/console.h>
#include <ros/this_node.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/ros/convert.h"
#include "ragdoll_sim/world/text.h"

namespace ragdoll {
namespace {

constexpr double kRivalry = 5;  ///< [s] without a frame of the other's, then it is over
constexpr std::chrono::milliseconds kHearPeriod{250};  ///< between two times that it hears unasked
constexpr int kMessageQueue = 10000;                   ///< messages that may come meanwhile
constexpr std::size_t kOwnKept = 600;  ///< messages: 10 s at 60 Hz, as long as tf2 keeps any

/// TF lets numbers of any size through, infinite ones, too.
bool isPlace(const Pose& pose) {
  return isWithinReach(pose.position) && pose.orientation.coeffs().allFinite();
}

}  // namespace

FrameLookup::FrameLookup(const std::string& world_frame) : world_frame_(world_frame) {
  node_.setCallbackQueue(&queue_);
  // tf2_ros::TransformListener does not say who has published a frame, and in its own thread what
  // tf2 throws at stamps near 2^32 s would end the node.
  const auto subscribe = [&](const char* topic, bool is_static) {
    return node_.subscribe<tf2_msgs::TFMessage, const Event&>(
        topic, kMessageQueue,
        boost::function<void(const Event&)>(
            [this, is_static](const Event& e) { hear(e, is_static); }));
  };
  moving_ = subscribe("/tf", false);
  static_ = subscribe("/tf_static", true);
  thread_ = std::thread(&FrameLookup::run, this);
}

FrameLookup::~FrameLookup() {
  {
    std::lock_guard<std::mutex> lock(end_mutex_);
    ends_ = true;
  }
  end_.notify_all();
  thread_.join();
}

void FrameLookup::run() {
  std::unique_lock<std::mutex> lock(end_mutex_);
  while (!end_.wait_for(lock, kHearPeriod, [this] { return ends_; })) listen();
}

void FrameLookup::listen() const {
  std::lock_guard<std::mutex> lock(hearing_);
  queue_.callAvailable();
}

void FrameLookup::hear(const Event& event, bool is_static) {
  const ros::Time came = event.getReceiptTime();
  if (came < last_heard_) forget();  // a bag that begins anew, as tf2_ros does
  last_heard_ = came;
  const std::string publisher = event.getPublisherName();
  if (publisher == ros::this_node::getName()) return hearOwn(*event.getConstMessage());
  for (const geometry_msgs::TransformStamped& t : event.getConstMessage()->transforms)
    if (take(t, publisher, is_static)) claim(normal(t.child_frame_id), publisher, true);
}

/// 60 times a second all frames of all bodies, which hardly anyone asks for.
void FrameLookup::hearOwn(const tf2_msgs::TFMessage& message) {
  constexpr double kClaimPeriod = 1;  // [s]
  const std::vector<geometry_msgs::TransformStamped>& all = message.transforms;
  if (all.empty()) return;
  const auto same = [](const geometry_msgs::TransformStamped& t, const Link& link) {
    return t.child_frame_id == link.child && t.header.frame_id == link.parent;
  };
  if (!own_links_ ||
      !std::equal(all.begin(), all.end(), own_links_->begin(), own_links_->end(), same)) {
    std::vector<Link> links;
    for (const geometry_msgs::TransformStamped& t : all)
      links.push_back({t.header.frame_id, t.child_frame_id});
    own_links_ = std::make_shared<const std::vector<Link>>(std::move(links));
  }
  OwnFrames own{all.front().header.stamp, own_links_, {}};
  own.transforms.reserve(all.size());
  for (const geometry_msgs::TransformStamped& t : all) own.transforms.push_back(t.transform);
  {
    std::lock_guard<std::mutex> lock(mutex_);
    own_.push_back(std::move(own));
    while (own_.size() > kOwnKept) own_.pop_front();
  }
  const ros::WallTime now = ros::WallTime::now();
  if (!claimed_.isZero() && (now - claimed_).toSec() < kClaimPeriod) return;
  claimed_ = now;
  for (const geometry_msgs::TransformStamped& t : all)
    claim(normal(t.child_frame_id), ros::this_node::getName(), false);
}

void FrameLookup::takeOwn() const {
  // All the while: who looks at the same time has them, too.
  std::lock_guard<std::mutex> lock(mutex_);
  geometry_msgs::TransformStamped t;
  for (const OwnFrames& own : own_)
    for (std::size_t i = 0; i < own.transforms.size(); ++i) {
      const Link& link = (*own.links)[i];
      t.header.stamp = own.stamp;
      t.header.frame_id = link.parent;
      t.child_frame_id = link.child;
      t.transform = own.transforms[i];
      take(t, ros::this_node::getName(), false);
    }
  own_.clear();
}

bool FrameLookup::take(const geometry_msgs::TransformStamped& transform,
                       const std::string& publisher, bool is_static) const {
  try {
    return buffer_.setTransform(transform, publisher, is_static);
  } catch (const std::exception& e) {
    ROS_WARN_THROTTLE(1, "/tf ignored: %s", e.what());
    return false;
  }
}

void FrameLookup::forget() {
  std::lock_guard<std::mutex> lock(mutex_);
  own_.clear();
  buffer_.clear();
}

void FrameLookup::claim(const std::string& frame, const std::string& publisher, bool other) {
  std::lock_guard<std::mutex> lock(mutex_);
  const ros::WallTime now = ros::WallTime::now();
  Owner& owner = owners_[frame];
  owner.other = other;
  if (!other) owner.own = now;
  if (!other || owner.own.isZero() || (now - owner.own).toSec() > kRivalry) return;
  Claim& claim = claims_[publisher];
  if (claim.frame.empty() || (now - claim.at).toSec() > kRivalry) {
    ROS_WARN(
        "%s publishes the frame '%s', which this node publishes, too; give one of them "
        "another ~frame_prefix",
        publisher.c_str(), frame.c_str());
    claim.frame = frame;
  }
  claim.at = now;
}

std::vector<std::string> FrameLookup::rivals() const {
  listen();
  std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [publisher, claim] : claims_)
    if ((ros::WallTime::now() - claim.at).toSec() < kRivalry)
      names.push_back(publisher + " publishes " + claim.frame + ", too");
  return names;
}

std::string FrameLookup::normal(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

bool FrameLookup::isWorld(const std::string& frame) const {
  return frame.empty() || normal(frame) == world_frame_;
}

std::vector<std::string> FrameLookup::others() const {
  listen();
  std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [frame, owner] : owners_)
    if (owner.other) names.push_back(frame);
  return names;
}

/// False for what this node has published itself, in this scene or in one before.
bool FrameLookup::isOthers(const std::string& frame) const {
  std::lock_guard<std::mutex> lock(mutex_);
  const auto found = owners_.find(normal(frame));
  return found == owners_.end() || found->second.other;
}

Pose FrameLookup::inWorld(const std::string& frame, const Names& own) const {
  if (isWorld(frame)) return Pose();
  listen();
  takeOwn();
  try {
    if (!isOthers(frame)) throw tf2::LookupException(frame);
    const Pose pose =
        fromTransform(buffer_.lookupTransform(world_frame_, normal(frame), ros::Time(0)).transform);
    if (!isPlace(pose))
      throw Error("", "frame '" + frame + "' is at " + shown(pose.position) +
                          " m in TF; its pose must be finite numbers, coordinates from " +
                          numberText(-kFarthest) + " to " + numberText(kFarthest));
    return pose;
  } catch (const tf2::LookupException&) {
    const std::vector<std::string> others = this->others();
    throw Error("", "unknown frame '" + frame + "'; there are " + world_frame_ +
                        "; of other nodes: " + (others.empty() ? "none" : listed(others)) +
                        (own ? "; of the ragdolls: " + listed(own()) : ""));
  } catch (const tf2::TransformException& e) {
    throw Error("",
                "frame '" + frame + "' is not connected to '" + world_frame_ + "': " + e.what());
  }
}

std::optional<StampedPose> FrameLookup::find(const std::string& frame) const {
  if (isWorld(frame)) return StampedPose();
  listen();
  if (!isOthers(frame)) return std::nullopt;
  takeOwn();
  try {
    const auto t = buffer_.lookupTransform(world_frame_, normal(frame), ros::Time(0));
    const StampedPose found{fromTransform(t.transform), t.header.stamp};
    if (!isPlace(found.pose)) return std::nullopt;
    return found;
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

}  // namespace ragdoll
