// One body's coat as markers. Rigid pieces are told once, each in the TF frame that its part turns
// with, and TF moves them; a piece is told again when its light, which is in its colours, has
// turned away, or after a minute, within a budget. What bends or stretches, and what has no frames
// on TF, is told anew each time.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <chrono>
#include <string>
#include <vector>

#include "ragdoll_sim/body/coat.h"

namespace ragdoll {

class BodyMarkers {
 public:
  using Clock = std::chrono::steady_clock;

  /// first_id: of its markers, which use kIds of the namespace `coat`.
  BodyMarkers(CoatKind kind, const std::string& world_frame, const Model& model,
              const FrameTracker& tracker, int ragdoll, int first_id);

  static constexpr int kIds = 1000;

  /// Appends what a listener needs at this moment: `all` of it, or what has changed. frames: all
  /// are on TF.
  void append(const Model& model, const FrameTracker& tracker, const Posture& posture,
              Clock::time_point now, bool all, bool frames,
              std::vector<visualization_msgs::Marker>& out);

 private:
  /// Some triangles of one part.
  struct Piece {
    int part = 0, frame = 0;     ///< of all ragdolls
    std::vector<int> triangles;  ///< of the coat's mesh
    Quat lit;                    ///< orientation of the part for which it was lit
    Clock::time_point told{};
    visualization_msgs::Marker marker;
  };

  bool isStraight(const Model& model, const Posture& posture) const;
  void makePieces(const FrameTracker& tracker);
  void light(Piece& piece, const Posture& posture);
  void relight(const Posture& posture, Clock::time_point now,
               std::vector<visualization_msgs::Marker>& out);
  void stream(const Posture& posture, std::vector<visualization_msgs::Marker>& out);
  void clear(bool pieces, std::vector<visualization_msgs::Marker>& out) const;

  Coat coat_;
  int ragdoll_, first_id_;
  std::string world_frame_;
  bool lockable_ = false, streaming_ = false;
  std::vector<Piece> pieces_;
  std::vector<visualization_msgs::Marker> shapes_;  ///< streamed
  Clock::time_point bent_{};                        ///< when it last was
  Clock::time_point relit_{};
  double budget_ = 0;  ///< [bytes]
};

}  // namespace ragdoll
