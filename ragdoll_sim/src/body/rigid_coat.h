// Coats of rigid pieces, each carried by one part of the body: boxes (the thesis, sec. 5.2 and 5.5)
// and rounded limbs. A bone's pieces stretch with it, so that they meet at the joints whatever a
// coarse solver leaves of the stick's length.
#pragma once

#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/body/mesh.h"

namespace ragdoll {

struct RigidPiece {
  Mesh mesh;  ///< [m] rest pose, model frame; with normals
  int part = 0;
  Rgba color;
};

/// Palette of the human coats.
namespace palette {
constexpr Rgba kSkin{0.93f, 0.73f, 0.60f, 1};
constexpr Rgba kHair{0.36f, 0.25f, 0.18f, 1};
constexpr Rgba kShirt{0.25f, 0.58f, 0.70f, 1};
constexpr Rgba kTrousers{0.30f, 0.34f, 0.46f, 1};
constexpr Rgba kShoes{0.22f, 0.21f, 0.22f, 1};
constexpr Rgba kBone{0.85f, 0.62f, 0.25f, 1};
constexpr Rgba kGroup{0.45f, 0.55f, 0.62f, 1};
}  // namespace palette

/// Human: trunk, head, hands and feet of human shape; any other: a round cone along every stick
/// with the particles' radii.
std::vector<RigidPiece> capsulePieces(const Skeleton& skeleton, const FrameTree& tree);
/// A box along every bone and around every group; for the human head, hands and feet, too.
std::vector<RigidPiece> boxPieces(const Skeleton& skeleton, const FrameTree& tree);

class RigidCoat {
 public:
  RigidCoat(const std::vector<RigidPiece>& pieces, const Skeleton& skeleton, const FrameTree& tree);

  const Mesh& rest() const { return rest_; }
  std::vector<int> partOfVertex() const;
  /// Vertices, normals and lit colours for the particles x (3 x n) and orientations of the parts.
  /// `out` starts as a copy of rest(); allocates nothing.
  void pose(const Eigen::Ref<const Points>& x, const Quat* parts, Mesh& out) const;

 private:
  struct Span {
    int part, first, count;  ///< vertices first ... first + count - 1
  };
  std::vector<Part> parts_;
  std::vector<Vec3> anchors_;    ///< [m] per part, rest pose
  std::vector<double> lengths_;  ///< [m] per part, bones
  std::vector<Span> spans_;
  Mesh rest_;
};

}  // namespace ragdoll
