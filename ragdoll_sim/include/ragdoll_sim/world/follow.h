// Obstacles and pins that follow frames of others: turns poses that are heard now and then into one
// for every step.
//
// A frame glides from where it was to what was heard last within kGlides times the interval between
// news of it: what it carries has the frame's own velocity, however seldom that is published, and
// lags by that time. When nothing more is heard it stays there. What fell behind is made up for no
// faster than kCatchUp beyond the frame's own speed. What is heard first, again after a silence, or
// farther away than the frame may move in that time, is a jump: an obstacle is put there without
// velocity; a particle is drawn from where it is to its frame. Knows nothing of ROS.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// How a frame glides from one step on.
struct Glide {
  struct Particle {
    int particle = 0;
    std::string name;            ///< "ragdoll/particle"
    Vec3 offset = Vec3::Zero();  ///< [m] from the frame at age 0; none is left at age kDraw
    double age = 0;              ///< [s] < 0 where it began farther away
  };
  std::string frame;
  Pose from, to;
  double age = 0;       ///< [s] on the way when the step begins
  double duration = 0;  ///< [s] > 0
  bool jump = false;    ///< what follows has no velocity in this step
  std::vector<Particle> held;

  Pose at(double passed) const;  ///< [s] after the beginning of the step
};

class Follow {
 public:
  static constexpr double kGlides = 2;
  static constexpr double kShortestGlide = 0.04;   ///< [s]
  static constexpr double kLongestInterval = 0.5;  ///< [s] between news; longer is a rest
  static constexpr double kDraw = 0.25;  ///< [s] a particle takes to reach the frame that holds it
  /// [m/s] after a jump at most, however long it takes: a body that is drawn whips its free limbs
  /// to up to 6 times as much. Of 300 random ways at up to 0.5 m/s 56 are beyond 3 m/s more than
  /// the frame with this and kCatchUp doubled, 4 with these.
  static constexpr double kDrawSpeed = 0.3;
  static constexpr double kCatchUp = 0.25;     ///< [m/s] a glide is at most so much too fast
  static constexpr double kMaxFrameSpeed = 5;  ///< [m/s] faster is a jump

  static constexpr double kAway = -1e4;  ///< [m] on z

  /// Begins anew with the frames that the model names; puts the obstacles where they are.
  void restart(const Model& model, State& state);
  /// Other pins; those that stay go on.
  void setPins(const Model& model);

  std::vector<std::string> frames() const;
  bool empty() const { return frames_.empty(); }
  /// Where a followed frame is, by its glide, after the last step; nothing: it was never heard.
  std::optional<Pose> pose(const std::string& frame) const;

  /// [m/s] > 0; of the farthest point of what follows a frame.
  void setMaxFrameSpeed(double speed) { max_frame_speed_ = speed; }
  double maxFrameSpeed() const { return max_frame_speed_; }

  /// pose: of the frame in the world, now; to be told whenever it is heard, where it is the same,
  /// too. back: it had not been heard for long.
  void hear(const std::string& frame, const Pose& pose, bool back = false);

  /// What apply() is about to do otherwise than was told by the last call.
  std::vector<Glide> takeChanges();
  void tellAll() { changed_all_ = true; }  ///< the next time
  /// Instead of hear(): what takeChanges() told, before the same step.
  void repeat(const Glide& glide, const Model& model, State& state);

  /// Where obstacles and pins are to be at the end of the next step, which lasts h.
  void apply(const Model& model, double h, State& state, Inputs& inputs);

 private:
  struct Frame {
    std::string name;
    bool heard = false, fresh = true;  ///< fresh: a jump, not yet applied
    Pose from, to, now;
    double age = 0;       ///< [s] of simulated time since `to` was heard
    double interval = 0;  ///< [s] of simulated time between news, smoothed; 0: not known yet
    double glide = kShortestGlide;   ///< [s] from `from` to `to`
    bool changed = false;            ///< not yet told
    double reach = 0;                ///< [m] from its origin to the farthest point that follows it
    Pose stood;                      ///< `to` when the last step began
    double silence = 0;              ///< [s] of simulated time since it was heard before that step
    bool told = false;               ///< it has been heard since
    std::array<double, 2> speeds{};  ///< [m/s] of its last motions, the newest first
  };
  struct Held {
    int frame = -1;  ///< -1: held where Pin::target says
    int particle = 0;
    bool drawn = false;          ///< its frame has been heard
    Vec3 offset = Vec3::Zero();  ///< as in Glide::Particle
    double age = 0;
  };
  static double span(const Frame& frame, const Pose& a, const Pose& b);
  static double speedOf(const Frame& frame, const Pose& pose);
  void glideTo(Frame& frame, const Pose& pose) const;
  static void draw(Held& held, const Frame& frame, const Vec3& x, double h);
  int use(const std::string& frame);  ///< index, -1 for ""
  Pose poseOf(const Obstacle& obstacle, int frame) const;

  std::vector<Frame> frames_;
  std::vector<int> obstacle_frame_;  ///< per obstacle, -1: fixed
  std::vector<Held> held_;           ///< per pin
  bool changed_all_ = false;
  double max_frame_speed_ = kMaxFrameSpeed;
};

}  // namespace ragdoll
