#include "body_markers.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

using visualization_msgs::Marker;

constexpr std::size_t kTriangles = 64;  ///< of a piece at most: 8 kB, so that each is told quickly
constexpr double kStretch = 0.005;      ///< of a stick; more is seen at the joints
constexpr double kTurn = 0.35;          ///< [rad] from which on the light looks wrong
constexpr double kRelightRate = 9000;   ///< [bytes/s]
constexpr double kMostRelit = 150.0 * kTriangles;  ///< [bytes] at once: one piece
constexpr std::chrono::seconds kCalm{1};           ///< after it was bent
constexpr std::chrono::seconds kAgain{60};         ///< what a viewer has lost it has again so soon

}  // namespace

double BodyMarkers::Piece::bytes() const {
  constexpr std::size_t kVertex = 24 + 16;  // its place and its colour
  return static_cast<double>(ros::serialization::serializationLength(marker) +
                             3 * triangles.size() * kVertex);
}

BodyMarkers::BodyMarkers(std::shared_ptr<Coat> coat, const std::string& world_frame, int ragdoll,
                         int first_id)
    : coat_(std::move(coat)), ragdoll_(ragdoll), first_id_(first_id) {
  for (std::size_t k = 0; k < coat_->shapes().size(); ++k) {
    Marker m;
    m.header.frame_id = world_frame;  // stamp 0: to be shown whenever it arrives
    m.ns = "coat";
    m.id = first_id_ + static_cast<int>(k);
    m.action = Marker::ADD;
    shapes_.push_back(std::move(m));
  }
}

/// None if a part has no frame that turns with it.
void BodyMarkers::makePieces(const FrameTracker& tracker) {
  prepared_ = true;
  if (coat_->shapes().size() != 1 || coat_->shapes()[0].parts.empty()) return;
  const CoatShape& shape = coat_->shapes()[0];
  const FrameTree& tree = tracker.tree(ragdoll_);
  std::map<int, std::vector<Piece>> by_part;
  for (std::size_t t = 0; t < shape.mesh.triangles.size(); ++t) {
    const int part = shape.parts[shape.mesh.triangles[t][0]];
    std::vector<Piece>& pieces = by_part[part];
    if (pieces.empty() || pieces.back().triangles.size() >= kTriangles) {
      const auto frame = std::find_if(tree.frames.begin(), tree.frames.end(),
                                      [&](const FrameSpec& f) { return f.part == part; });
      if (frame == tree.frames.end()) return;
      pieces.emplace_back();
      pieces.back().part = tracker.firstPart(ragdoll_) + part;
      pieces.back().frame =
          tracker.firstFrame(ragdoll_) + static_cast<int>(frame - tree.frames.begin());
    }
    pieces.back().triangles.push_back(static_cast<int>(t));
  }
  int id = first_id_ + static_cast<int>(shapes_.size());
  for (auto& [part, pieces] : by_part)
    for (Piece& piece : pieces) {
      Marker& m = piece.marker;
      m = shapes_[0];
      m.header.frame_id = tracker.name(piece.frame);
      m.id = id++;
      m.type = Marker::TRIANGLE_LIST;
      m.pose = toPose(Pose());
      m.scale = toVector3(Vec3::Ones());
      m.color = toColor(shape.color);
      m.frame_locked = true;
      pieces_.push_back(std::move(piece));
    }
  lockable_ = id <= first_id_ + kIds;
}

void BodyMarkers::append(const Model& model, const FrameTracker& tracker, const Posture& posture,
                         Clock::time_point now, bool frames, double lifetime,
                         std::vector<Marker>& out) {
  if (shapes_.empty()) return;
  if (frames && !prepared_) makePieces(tracker);
  // Not of what is shown: between two moments of a limb that turns fast it is on the chord.
  if (lockable_ && !isStraight(model, tracker.now())) bent_ = now;
  const bool bent = bent_ != Clock::time_point{} && now - bent_ < kCalm;
  const bool streaming = !lockable_ || !frames || bent;
  const bool other = streaming != streaming_;
  if (other) clear(streaming, out);
  streaming_ = streaming;
  const bool all = untold_ || other;
  untold_ = false;
  if (!streaming && !all) return relight(tracker, posture, now, out);
  coat_->update(posture, tracker, ragdoll_);
  if (streaming) return stream(lifetime, out);
  for (Piece& piece : pieces_) out.push_back(light(piece, posture, now));
  relit_ = now;
  budget_ = 0;
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
Marker BodyMarkers::light(Piece& piece, const Posture& posture, Clock::time_point now) const {
  const Mesh& mesh = coat_->shapes()[0].mesh;
  const Pose& frame = posture.frames[piece.frame];
  const Quat inverse = frame.orientation.conjugate();
  piece.lit = posture.parts[piece.part];
  piece.told = now;
  Marker m = piece.marker;
  for (const int t : piece.triangles)
    for (const int v : mesh.triangles[t]) {
      m.points.push_back(toPoint(inverse * (mesh.vertices.col(v) - frame.position)));
      m.colors.push_back(toColor(mesh.colors[v]));
    }
  return m;
}

/// The piece whose light is most wrong, or one that was told long ago, as soon as the budget allows
/// it.
void BodyMarkers::relight(const FrameTracker& tracker, const Posture& posture,
                          Clock::time_point now, std::vector<Marker>& out) {
  budget_ += kRelightRate * std::chrono::duration<double>(now - relit_).count();
  budget_ = std::min(budget_, kMostRelit);
  relit_ = now;
  Piece* worst = nullptr;
  double turn = kTurn;
  for (Piece& piece : pieces_) {
    const double turned = piece.lit.angularDistance(posture.parts[piece.part]);
    if (turned > turn) worst = &piece, turn = turned;
  }
  for (Piece& piece : pieces_)
    if (!worst && now - piece.told > kAgain) worst = &piece;
  if (!worst || budget_ < worst->bytes()) return;
  coat_->update(posture, tracker, ragdoll_);
  out.push_back(light(*worst, posture, now));
  budget_ -= worst->bytes();
}

/// The coat as it is now.
void BodyMarkers::stream(double lifetime, std::vector<Marker>& out) const {
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    out.push_back(shapes_[k]);
    out.back().lifetime = ros::Duration(lifetime);
    toMarker(coat_->shapes()[k], out.back());
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
