#include "body_markers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

using visualization_msgs::Marker;

constexpr std::size_t kTriangles = 32;  ///< of a piece at most: 9 kB, so that each is told quickly
constexpr double kStretch = 0.005;      ///< of a stick; more is seen at the joints
constexpr double kLifetime = 0.5;       ///< [s] of what is told anew each time
constexpr double kAgainRate = 12000;    ///< [bytes/s]
constexpr std::chrono::seconds kCalm{1};    ///< after it was bent
constexpr std::chrono::seconds kAgain{60};  ///< what a viewer has lost it has again so soon

double sizeOf(const Marker& marker) {
  return static_cast<double>(ros::serialization::serializationLength(marker));
}

}  // namespace

BodyMarkers::BodyMarkers(CoatKind kind, const std::string& world_frame, const Model& model,
                         const FrameTracker& tracker, int ragdoll, int first_id)
    : coat_(kind, model, tracker, ragdoll),
      ragdoll_(ragdoll),
      first_id_(first_id),
      world_frame_(world_frame) {
  for (std::size_t k = 0; k < coat_.shapes().size(); ++k) {
    Marker m;
    m.header.frame_id = world_frame;  // stamp 0: to be shown whenever it arrives
    m.ns = "coat";
    m.id = first_id_ + static_cast<int>(k);
    m.action = Marker::ADD;
    m.lifetime = ros::Duration(kLifetime);
    shapes_.push_back(std::move(m));
  }
  makePieces(tracker);
}

/// None if a part has no frame that turns with it.
void BodyMarkers::makePieces(const FrameTracker& tracker) {
  if (coat_.shapes().size() != 1 || coat_.shapes()[0].parts.empty()) return;
  const CoatShape& shape = coat_.shapes()[0];  // at rest, not lit
  const FrameTree& tree = tracker.tree(ragdoll_);
  for (std::size_t t = 0; t < shape.mesh.triangles.size(); ++t) {
    const int vertex = shape.mesh.triangles[t][0], part = shape.parts[vertex];
    const auto frame = std::find_if(tree.frames.begin(), tree.frames.end(),
                                    [&](const FrameSpec& f) { return f.part == part; });
    if (frame == tree.frames.end()) return;
    const int index = tracker.firstFrame(ragdoll_) + static_cast<int>(frame - tree.frames.begin());
    const Rgba& color = shape.mesh.colors.empty() ? shape.color : shape.mesh.colors[vertex];
    pieceOf(index, toColor(color)).triangles.push_back(static_cast<int>(t));
  }
  for (Piece& piece : pieces_) piece.marker.header.frame_id = tracker.name(piece.frame);
  lockable_ = shapes_.size() + pieces_.size() <= static_cast<std::size_t>(kIds);
}

/// The last one of that frame and colour, or another when it is full.
BodyMarkers::Piece& BodyMarkers::pieceOf(int frame, const std_msgs::ColorRGBA& color) {
  const auto same = [&](const Piece& p) { return p.frame == frame && p.marker.color == color; };
  const auto last = std::find_if(pieces_.rbegin(), pieces_.rend(), same);
  if (last != pieces_.rend() && last->triangles.size() < kTriangles) return *last;
  Piece piece;
  piece.frame = frame;
  Marker& m = piece.marker;
  m = shapes_[0];
  m.id = first_id_ + static_cast<int>(shapes_.size() + pieces_.size());
  m.type = Marker::TRIANGLE_LIST;
  m.pose = toPose(Pose());
  m.scale = toVector3(Vec3::Ones());
  m.color = color;
  m.lifetime = ros::Duration(0);
  m.frame_locked = true;
  pieces_.push_back(std::move(piece));
  return pieces_.back();
}

void BodyMarkers::append(const Model& model, const FrameTracker& tracker, const Posture& posture,
                         Clock::time_point now, bool all, bool frames, std::vector<Marker>& out) {
  if (shapes_.empty()) return;
  // Not of what is shown: between two moments of a limb that turns fast it is on the chord.
  if (lockable_ && !isStraight(model, tracker.now())) bent_ = now;
  const bool bent = bent_ != Clock::time_point{} && now - bent_ < kCalm;
  const bool streaming = !lockable_ || !frames || bent;
  const bool other = streaming != streaming_;
  if (other) clear(streaming, out);
  streaming_ = streaming;
  if (streaming) {
    stream(posture, out);
  } else if (all || other) {
    coat_.update(posture);
    for (Piece& piece : pieces_) {
      setPoints(piece, posture);
      piece.told = now;
      out.push_back(piece.marker);
    }
    told_ = now;
    budget_ = 0;
  } else {
    tellAgain(now, out);
  }
}

bool BodyMarkers::isStraight(const Model& model, const Posture& posture) const {
  const Ragdoll& r = model.ragdolls[ragdoll_];
  for (const Stick& s : model.skeletonOf(r).sticks) {
    const double length = (posture.x.col(r.first + s.a) - posture.x.col(r.first + s.b)).norm();
    if (std::abs(length - s.length) > kStretch * s.length) return false;
  }
  return true;
}

/// From the coat as it is now.
void BodyMarkers::setPoints(Piece& piece, const Posture& posture) {
  const Mesh& mesh = coat_.shapes()[0].mesh;
  const Pose& frame = posture.frames[piece.frame];
  const Quat inverse = frame.orientation.conjugate();
  piece.marker.points.clear();
  for (const int index : piece.triangles) {
    const Triangle& t = mesh.triangles[index];
    const std::array<Vec3, 3> middles = curvedMiddles(mesh, t);
    std::array<geometry_msgs::Point, 6> at;
    for (int k = 0; k < 3; ++k) {
      at[k] = toPoint(inverse * (mesh.vertices.col(t[k]) - frame.position));
      at[3 + k] = toPoint(inverse * (middles[k] - frame.position));
    }
    for (const int k : {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5}) piece.marker.points.push_back(at[k]);
  }
}

/// A piece that was told long ago, as soon as the budget allows it.
void BodyMarkers::tellAgain(Clock::time_point now, std::vector<Marker>& out) {
  budget_ += kAgainRate * std::chrono::duration<double>(now - told_).count();
  told_ = now;
  const auto oldest =
      std::min_element(pieces_.begin(), pieces_.end(),
                       [](const Piece& a, const Piece& b) { return a.told < b.told; });
  if (oldest == pieces_.end()) return;
  budget_ = std::min(budget_, sizeOf(oldest->marker));
  if (now - oldest->told < kAgain || budget_ < sizeOf(oldest->marker)) return;
  oldest->told = now;
  budget_ = 0;
  out.push_back(oldest->marker);
}

void BodyMarkers::stream(const Posture& posture, std::vector<Marker>& out) {
  coat_.update(posture);
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    toMarker(coat_.shapes()[k], shapes_[k]);
    out.push_back(shapes_[k]);
  }
}

/// Takes away the pieces, or what was streamed.
void BodyMarkers::clear(bool pieces, std::vector<Marker>& out) const {
  const auto remove = [&](const Marker& marker) {
    Marker m;
    m.header = marker.header;
    m.ns = marker.ns;
    m.id = marker.id;
    m.action = Marker::DELETE;
    m.pose.orientation.w = 1;
    out.push_back(std::move(m));
  };
  if (pieces)
    for (const Piece& piece : pieces_) remove(piece.marker);
  else
    for (const Marker& shape : shapes_) remove(shape);
}

}  // namespace ragdoll
