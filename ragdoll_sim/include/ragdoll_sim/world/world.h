// What is simulated: a scene's model, its state, what acts on it, and the frames that follow it.
// Belongs to one thread at a time; knows nothing of ROS, threads or clocks.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/snapshot.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/events.h"
#include "ragdoll_sim/world/follow.h"
#include "ragdoll_sim/world/imu.h"

namespace ragdoll {

class World {
 public:
  /// At the scene's start. `source`: name or path that the scene was loaded from, empty: none.
  /// `frame_prefix`: of the names of its own frames. Throws Error.
  explicit World(Scene scene, std::string source = "", const std::string& frame_prefix = "");

  const std::string& source() const { return source_; }

  const std::shared_ptr<const Scene>& scene() const { return scene_; }
  const std::shared_ptr<const Model>& model() const { return model_; }
  const State& state() const { return state_; }
  const StepReport& report() const { return report_; }
  double stepLength() const { return model_->solver.step; }  ///< [s]

  /// Grows with everything that changes the state.
  std::uint64_t revision() const { return revision_; }

  /// A run is what scene, beginning and events determine: a new one begins with everything else
  /// that changes the state, its settings or its pins.
  std::uint32_t run() const { return run_; }
  RunMark mark() const;
  /// Where the run began, as save() gives it; null: at the scene's start.
  const std::shared_ptr<const Bytes>& beginning() const { return beginning_; }

  void advance();                ///< one step
  void reset();                  ///< back to the scene's start: its pokes, its pins
  void replaceBy(World& other);  ///< becomes the other, which becomes this one

  /// Other settings for the same bodies: `scene` and `model` differ from `before` and its model in
  /// solver and gravity only. Throws Error if the present scene is not `before`.
  void configure(const std::shared_ptr<const Scene>& before, std::shared_ptr<const Scene> scene,
                 std::shared_ptr<const Model> model);

  Bytes save() const;
  void restore(const Bytes& bytes);  ///< throws Error, then nothing has changed

  /// Begins at poke.start, or now if that is past; start and duration are rounded to whole steps.
  /// Returns the step at which it begins. Throws Error if there are too many.
  std::uint64_t addPoke(Poke poke);
  std::size_t clearPokes();  ///< those that act and those to come; returns how many
  /// So many pokes may act or be to come (and clearings be to come) that more are refused; until
  /// another scene replaces this one.
  void setMaxPokes(std::size_t most) { max_pokes_ = most; }
  /// A poke, or a clearing of all pokes, at its recorded step. Throws Error if that is past.
  void replay(const Event& event);
  void replay(const FollowedFrame& followed);  ///< the same; those of a step in their order
  /// `pokes` replace those that the same source gave before and act for `seconds`, unless replaced.
  void stream(const std::string& source, std::vector<Poke> pokes, double seconds);

  /// Drags one particle to the target [m] until release(), a jump or a clearing. What acts is told
  /// as one poke for each step. Throws Error.
  void pull(const std::string& body, const Vec3& target);
  void release(const std::string& body);  ///< does nothing if it is not pulled
  const std::vector<Pull>& pulls() const { return pulls_; }

  /// Holds one particle at a frame of someone else's. Throws Error.
  void attach(const std::string& body, const std::string& frame);
  void detach(const std::string& body);  ///< lets go of a particle that is held; throws Error
  /// [J] that the velocities lost at the last start or change of what is held, to be consistent.
  double energyTaken() const { return energy_taken_; }
  std::vector<std::string> followedFrames() const { return follow_.frames(); }
  bool followsFrames() const { return !follow_.empty(); }
  /// As Follow::hear.
  void hear(const std::string& frame, const Pose& pose, bool back = false) {
    follow_.hear(frame, pose, back);
  }
  /// As Follow::setMaxFrameSpeed; stays with another scene.
  void setMaxFrameSpeed(double speed) { follow_.setMaxFrameSpeed(speed); }

  /// Follows the bodies; updated every stepsPerFollow() steps, so that its last two updates are
  /// evenly spaced for interpolation.
  const FrameTracker& tracker() const { return tracker_; }
  std::uint64_t followedStep() const { return followed_step_; }
  std::uint64_t stepsPerFollow() const { return steps_per_follow_; }

  /// Pose of one of the world's own frames at this very step; nothing if it has none of that name.
  std::optional<Pose> frame(const std::string& name) const;
  bool hasFrame(const std::string& name) const;
  std::vector<std::string> frameNames() const;

  std::vector<Poke> takeActed();    ///< pokes that acted in some step since the last call, once
  std::vector<Event> takeEvents();  ///< pokes that were accepted since the last call
  std::vector<FollowedFrame> takeFollowed();  ///< that acted first since the last call

  /// Samples of the scene's sensors that ended since the last call.
  std::vector<ImuSample> takeImuSamples();
  /// Begins, or ends, to tell of contacts; what was is forgotten. Changes nothing else.
  void keepContacts(bool keep);
  bool keepsContacts() const { return contacts_.has_value(); }
  /// Since the last call; nothing: they are not kept.
  std::optional<ContactReport> takeContacts();
  /// "pin_<particle>", "attach_<particle>" of each of the model's pins; of another than the first
  /// ragdoll "<ragdoll>_<particle>".
  std::vector<std::string> pinNames() const;
  /// As Follow::pose.
  std::optional<Pose> followedPose(const std::string& frame) const { return follow_.pose(frame); }
  /// The sensors; nothing: the scene has none.
  const std::optional<Imus>& imus() const { return imus_; }

 private:
  struct Accepted {
    Poke poke;
    std::uint64_t order = 0;  ///< of acceptance
  };
  struct Clearing {
    std::uint64_t step = 0, order = 0;  ///< ends at that step what was accepted before
  };
  struct Stream {
    std::string source;
    std::uint64_t first = 0;  ///< step
    double end = 0;           ///< [s]
    std::vector<Poke> pokes;
  };

  void restart();  ///< what is derived begins anew at the present state
  void endRun();   ///< tells what its streams have done; to be called before anything changes
  void beginRun(bool at_start);
  void checkForeign(const std::string& where, const std::string& frame) const;
  void changePins(const std::vector<Pin>& pins);
  void setPokes(const std::vector<Poke>& pokes);
  void followFrames();
  void checkToCome(std::uint64_t step) const;
  void checkRoom(std::size_t pokes) const;
  void beginPokes();
  void gatherPokes();
  void addPulls();
  void sortPokes();
  std::size_t clear(std::uint64_t order);
  void tellStream(const Stream& stream);  ///< what it has done in this run
  Poke rounded(Poke poke, std::uint64_t& first) const;

  std::string source_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Model> model_;
  double energy_taken_ = 0;
  State state_;
  Inputs inputs_;
  Workspace workspace_;
  StepReport report_;
  Follow follow_;
  FrameTracker tracker_;
  std::optional<Imus> imus_;
  std::vector<ImuSample> imu_samples_;
  std::optional<Contacts> contacts_;
  std::uint64_t followed_step_ = 0, steps_per_follow_ = 1, revision_ = 0;
  std::uint32_t run_ = 0;
  std::shared_ptr<const Bytes> beginning_;

  std::vector<Pin> start_pins_;
  std::vector<Accepted> pokes_;              ///< that act, streams apart
  std::multimap<double, Accepted> to_come_;  ///< by Poke::start [s]
  std::size_t max_pokes_ = 100000;
  std::uint64_t next_order_ = 1;
  std::vector<Stream> streams_;
  std::vector<Clearing> clearings_;  ///< to come
  std::vector<Pull> pulls_;
  bool pokes_changed_ = false;  ///< since inputs_.pokes was gathered
  std::vector<Poke> acted_;
  bool acted_taken_ = true;  ///< since the last step
  std::vector<Event> events_;
  std::vector<FollowedFrame> followed_;
  std::uint32_t followed_count_ = 0;                    ///< in this run
  std::map<std::uint64_t, std::vector<Glide>> glides_;  ///< to come, by step
};

}  // namespace ragdoll
