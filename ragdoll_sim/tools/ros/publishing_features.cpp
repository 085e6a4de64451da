// What the node's messages cost: made and serialised, as often as it publishes; not sent.
#include <ros/serialization.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "feature_list.h"
#include "ragdoll_sim/ros/convert.h"

namespace ragdoll::lab {
namespace {

enum class Topic { kTf, kState, kMarkers };

class Teller : public Follower {
 public:
  Teller(const Model& model, const State& state, Topic topic)
      : model_(model), topic_(topic), tracker_(model) {
    tracker_.reset(state);
    coat_ = std::make_unique<Coat>(CoatKind::kCapsules, model, tracker_, 0);
  }
  void stepped(const State& state) override {
    if (topic_ != Topic::kState) tracker_.update(state);
  }
  void publish(const State& state) override {
    const std_msgs::Header header = toHeader("world", ros::Time(1 + state.time));
    if (topic_ == Topic::kState) return send(toStateMsg(model_, state, {}, header));
    if (topic_ == Topic::kTf) {
      tf2_msgs::TFMessage message;
      message.transforms = toTransforms(tracker_, tracker_.now(), header);
      return send(message);
    }
    coat_->update(tracker_.now());
    markers_.markers.resize(coat_->shapes().size());
    for (std::size_t i = 0; i < markers_.markers.size(); ++i) {
      markers_.markers[i].header = header;
      toMarker(coat_->shapes()[i], markers_.markers[i]);
    }
    send(markers_);
  }

 private:
  template <class Message>
  void send(const Message& message) {
    sent_ = ros::serialization::serializeMessage(message);
  }

  const Model& model_;
  Topic topic_;
  FrameTracker tracker_;
  std::unique_ptr<Coat> coat_;
  visualization_msgs::MarkerArray markers_;
  ros::SerializedMessage sent_;
};

Feature telling(const std::string& name, Topic topic) {
  return {"publishing at 60 Hz", name, bareScene(), false,
          [topic](const Model& model, const State& state) {
            return std::make_unique<Teller>(model, state, topic);
          }};
}

}  // namespace

std::vector<Feature> publishingFeatures() {
  return {telling("frames and /tf", Topic::kTf), telling("~state", Topic::kState),
          telling("frames, coat capsules and ~markers", Topic::kMarkers)};
}

}  // namespace ragdoll::lab
