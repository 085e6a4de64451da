// One body's coat as markers. Rigid pieces are told once, each in the TF frame that its part turns
// with, and TF moves them; a piece is told again when its light, which is in its colours, has
// turned away, or after a minute, within a budget. What bends or stretches, and what has no frames
// on TF, is told anew each time.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/body/coat.h"

namespace ragdoll {

class BodyMarkers {
 public:
  using Clock = std::chrono::steady_clock;

  /// coat: shared by all bodies of its skeleton. first_id: of its markers, which use kIds of the
  /// namespace `coat`.
  BodyMarkers(std::shared_ptr<Coat> coat, const std::string& world_frame, int ragdoll,
              int first_id);

  static constexpr int kIds = 1000;

  /// What is told once, too, when it is told of next.
  void tellAll() { untold_ = true; }

  /// Appends what a listener needs at this moment. frames: all are on TF. lifetime: of what is told
  /// anew each time [s].
  void append(const Model& model, const FrameTracker& tracker, const Posture& posture,
              Clock::time_point now, bool frames, double lifetime,
              std::vector<visualization_msgs::Marker>& out);

 private:
  /// Some triangles of one part.
  struct Piece {
    int part = 0, frame = 0;     ///< of all ragdolls
    std::vector<int> triangles;  ///< of the coat's mesh
    Quat lit;                    ///< orientation of the part for which it was lit
    Clock::time_point told{};
    visualization_msgs::Marker marker;  ///< without points and colours
    double bytes() const;               ///< as it is told
  };

  bool isStraight(const Model& model, const Posture& posture) const;
  void makePieces(const FrameTracker& tracker);
  visualization_msgs::Marker light(Piece& piece, const Posture& posture,
                                   Clock::time_point now) const;
  void relight(const FrameTracker& tracker, const Posture& posture, Clock::time_point now,
               std::vector<visualization_msgs::Marker>& out);
  void stream(double lifetime, std::vector<visualization_msgs::Marker>& out) const;
  void clear(bool pieces, std::vector<visualization_msgs::Marker>& out) const;

  std::shared_ptr<Coat> coat_;
  int ragdoll_, first_id_;
  bool prepared_ = false, lockable_ = false;  ///< the pieces are made; can be told once
  bool streaming_ = false, untold_ = true;
  std::vector<Piece> pieces_;
  std::vector<visualization_msgs::Marker> shapes_;  ///< streamed; without points and colours
  Clock::time_point bent_{};                        ///< when it last was
  Clock::time_point relit_{};
  double budget_ = 0;  ///< [bytes]
};

}  // namespace ragdoll
