#include "feature_list.h"

#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/imu.h"

namespace ragdoll::lab {
namespace {

/// A body that stands nearly on the ground, leans, and turns.
std::string body(const std::string& model, const std::string& more = "") {
  return "ragdolls:\n  - {name: ragdoll, model: " + model +
         ", position: [0, 0, 1.15], rpy_deg: [10, 25, 0], angular_velocity: [0.5, 1, 0.5]" + more +
         "}\n";
}

Feature steps(const std::string& group, const std::string& name, const std::string& scene,
              bool limits = false) {
  return {group, name, scene, limits, {}};
}

std::string on(const std::string& obstacle) {
  return body("human_lumped") + "obstacles:\n  - {" + obstacle + "}\n";
}

/// The frames, and the coat that they carry.
class Wearer : public Follower {
 public:
  Wearer(const Model& model, const State& state, CoatKind kind) : tracker_(model) {
    tracker_.reset(state);
    coat_ = std::make_unique<Coat>(kind, model, tracker_, 0);
  }
  void stepped(const State& state) override { tracker_.update(state); }
  void publish(const State&) override { coat_->update(tracker_.now()); }

 private:
  FrameTracker tracker_;
  std::unique_ptr<Coat> coat_;
};

/// What sensors say.
class Sensed : public Follower {
 public:
  Sensed(const Model& model, const State& state) : model_(model), imus_(model) {
    imus_.reset(state);
  }
  void stepped(const State& state) override {
    samples_.clear();
    imus_.update(model_, state, samples_);
  }
  void publish(const State&) override {}

 private:
  const Model& model_;
  Imus imus_;
  std::vector<ImuSample> samples_;
};

/// What contacts give.
class Felt : public Follower {
 public:
  explicit Felt(const Model& model)
      : model_(model), inputs_(startInputs(model)), contacts_(model) {}
  void begin(Workspace& workspace) override { workspace.keepContacts(&contacts_.log()); }
  void beforeStep(const State& state) override { contacts_.begin(state); }
  void stepped(const State& state) override { contacts_.end(model_, inputs_, state); }
  void publish(const State&) override { contacts_.take(); }

 private:
  const Model& model_;
  Inputs inputs_;
  Contacts contacts_;
};

std::vector<Feature> senses() {
  const std::string plane = on("type: plane, friction: 0.6");
  const std::string imu = "sensors: [{name: imu, type: imu, segment: left_forearm, rate: 10}]\n";
  return {{"senses", "imu, one", bareScene() + imu, false,
           [](const Model& model, const State& state) {
             return std::make_unique<Sensed>(model, state);
           }},
          {"senses", "contacts, on a plane", plane, false,
           [](const Model& model, const State&) { return std::make_unique<Felt>(model); }}};
}

Feature wearing(const std::string& coat) {
  return {"frames and coat", coat, bareScene(), false,
          [kind = coatKind(coat)](const Model& model, const State& state) {
            return std::make_unique<Wearer>(model, state, kind);
          }};
}

}  // namespace

const std::string& bareScene() {
  static const std::string text = body("human_lumped");
  return text;
}

std::vector<Feature> features() {
  const std::string other =
      "  - {name: other, model: human_lumped, position: [1.2, 0.1, 1.15], rpy_deg: [0, -20, 180],"
      " velocity: [-1.5, 0, 0]}\n";
  const std::string floor = "obstacles:\n  - {type: plane, friction: 0.6}\n";
  std::vector<Feature> all = {
      steps("bare", "lumped masses, joints free", bareScene()),
      steps("inertia", "segments", body("human")),
      steps("joints", "limits", bareScene(), true),
      steps("joints", "damping", bareScene() + "solver: {joint_damping: 2}\n"),
      steps("pin", "a hand", bareScene() + "pins: [right_hand]\n"),
      steps("obstacle", "plane, out of reach", on("type: plane, point: [0, 0, -1000]")),
      steps("obstacle", "plane", on("type: plane, friction: 0.6")),
      steps("obstacle", "plane without friction", on("type: plane, friction: 0")),
      steps("obstacle", "plane with restitution",
            on("type: plane, friction: 0.6, restitution: 0.5")),
      steps("obstacle", "plane, compliant",
            on("type: plane, friction: 0.6, stiffness: 75000, damping: 300")),
      steps("the same", "regions that give way, as the plane",
            body("human", ", contact: compliant") +
                "obstacles:\n  - {type: plane, friction: 0.6, stiffness: 75000, damping: 300}\n",
            true),
      steps("obstacle", "box", on("type: box, position: [0, 0, -1], size: [4, 4, 2]")),
      steps("obstacle", "sphere", on("type: sphere, position: [0, 0, -3], radius: 3")),
      steps("obstacle", "capsule",
            on("type: capsule, from: [0, -4, -3], to: [0, 4, -3], radius: 3")),
      steps("bodies", "self_collision", bareScene() + "self_collision: true\n"),
      steps("bodies", "ragdoll_collision, two that meet",
            body("human_lumped") + other + "ragdoll_collision: true\n"),
      steps("segments, limits, plane", "as most scenes", body("human") + floor, true),
      steps("the same", "and self_collision", body("human") + floor + "self_collision: true\n",
            true),
  };
  for (const Feature& feature : senses()) all.push_back(feature);
  for (const char* coat : {"none", "sticks", "boxes", "capsules", "skin"})
    all.push_back(wearing(coat));
  for (const Feature& feature : publishingFeatures()) all.push_back(feature);
  return all;
}

#ifndef RAGDOLL_WITH_ROS
std::vector<Feature> publishingFeatures() { return {}; }
#endif

}  // namespace ragdoll::lab
