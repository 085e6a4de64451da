// One body's coat as markers. Rigid pieces of one colour are told once, each in the TF frame that
// its part turns with: TF moves them, and the viewer lights them. A viewer lights triangles flat,
// so each is told as four on the curved surface. A piece is told again after a minute, within a
// budget. What bends or stretches, and what has no frames on TF, is told anew each time, with the
// light in its colours.
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
  /// Some triangles of one part and colour.
  struct Piece {
    int frame = 0;               ///< of all ragdolls
    std::vector<int> triangles;  ///< of the coat's mesh
    Clock::time_point told{};
    visualization_msgs::Marker marker;
  };

  bool isStraight(const Model& model, const Posture& posture) const;
  void makePieces(const FrameTracker& tracker);
  Piece& pieceOf(int frame, const std_msgs::ColorRGBA& color);
  void setPoints(Piece& piece, const Posture& posture);
  void tellAgain(Clock::time_point now, std::vector<visualization_msgs::Marker>& out);
  void stream(const Posture& posture, std::vector<visualization_msgs::Marker>& out);
  void clear(bool pieces, std::vector<visualization_msgs::Marker>& out) const;

  Coat coat_;
  int ragdoll_, first_id_;
  std::string world_frame_;
  bool lockable_ = false, streaming_ = false;
  std::vector<Piece> pieces_;
  std::vector<visualization_msgs::Marker> shapes_;  ///< streamed
  Clock::time_point bent_{};                        ///< when it last was
  Clock::time_point told_{};
  double budget_ = 0;  ///< [bytes]
};

}  // namespace ragdoll
