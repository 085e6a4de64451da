// What the body looks like: primitives for a viewer, free of ROS. Bodies of one skeleton can share
// a Coat, which is then where it was put last.
//
// none; sticks: spheres and lines of the particle system itself; boxes: a box around every bone and
// group (the thesis, sec. 5.5); capsules: one mesh of rounded limbs, trunk, head, hands and feet;
// skin: one closed mesh that blends at the joints (skin.h); a skeleton that is not the human wears
// capsules instead.
// All is built at construction; update() moves it and allocates nothing.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/body/mesh.h"

namespace ragdoll {

/// Of the coat `sticks`.
namespace sticks_look {
constexpr double kWidth = 0.012;         ///< [m]
constexpr double kParticleSize = 0.036;  ///< [m] diameter
constexpr Rgba kColor{0.95f, 0.75f, 0.25f, 1};
constexpr Rgba kParticleColor{0.85f, 0.25f, 0.20f, 1};
}  // namespace sticks_look

enum class CoatKind { kNone, kSticks, kBoxes, kCapsules, kSkin };

/// "none" | "sticks" | "boxes" | "capsules" | "skin". Throws Error that lists them.
CoatKind coatKind(const std::string& name);

/// One thing to draw, world frame.
struct CoatShape {
  enum class Type { kBox, kSphere, kSpheres, kLines, kMesh };
  Type type = Type::kBox;
  std::string name;          ///< stable, unique within the coat
  Pose pose;                 ///< box, sphere: its middle; the others: identity, or the mesh's pose
  Vec3 size = Vec3::Ones();  ///< [m] box: edges; sphere(s): diameters; lines: x is the width
  Rgba color;
  Points points;           ///< kSpheres: centres; kLines: pairs of ends
  Mesh mesh;               ///< kMesh; its vertex colours, if any, instead of `color`
  std::vector<int> parts;  ///< kMesh of rigid pieces: the part of the body that carries each vertex
};

class Coat {
 public:
  /// `tracker` is only read here; ragdoll is an index into model.ragdolls.
  Coat(CoatKind kind, const Model& model, const FrameTracker& tracker, int ragdoll);
  ~Coat();
  Coat(Coat&&) noexcept;
  Coat& operator=(Coat&&) noexcept;

  CoatKind kind() const { return kind_; }
  void update(const Posture& posture);
  /// Puts it on another of the ragdolls that have the same skeleton.
  void update(const Posture& posture, const FrameTracker& tracker, int ragdoll);
  const std::vector<CoatShape>& shapes() const { return shapes_; }

 private:
  struct Impl;
  CoatKind kind_;
  std::vector<CoatShape> shapes_;
  std::unique_ptr<Impl> impl_;
};

/// An obstacle for a viewer, in its own frame (put it at State::obstacles[i]); a plane becomes a
/// thin slab of `plane_size` [m] whose upper face is the plane.
CoatShape obstacleShape(const Obstacle& obstacle, double plane_size = 20);

}  // namespace ragdoll
