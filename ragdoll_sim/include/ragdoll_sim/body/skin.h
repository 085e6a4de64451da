// The skin: one closed triangle mesh around the human's bones, made at bind time from rings of
// points around them (the thesis's "simplified skin from points", sec. 5.6), and blended at the
// joints.
//
// A vertex v of the rest pose is carried by up to four parts with weights w_i. Part i moves the
// rest pose by the rotation q_i and the shift t_i.
//   linear          sum w_i (q_i v + t_i) [Magnenat-Thalmann1988]. The mean of rotations is no
//   rotation:
//                   at a joint bent or twisted by an angle a the half-way ring shrinks by cos(a /
//                   2), the collapsing elbow and the candy wrapper of the thesis's sec. 5.3.
//   dual quaternion sum w_i (q_i + e t_i q_i / 2), normalised [Kavan2008, sec. 4]: always a rigid
//                   motion, so the half-way ring keeps its size. The default.
// Normals turn with the blend.
#pragma once

#include <array>
#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/body/mesh.h"

namespace ragdoll {

enum class Blend { kLinear, kDualQuaternion };

/// The parts that carry a vertex, by falling weight; unused ones have weight 0. Sums to 1.
struct Weights {
  std::array<int, 4> part{};
  std::array<float, 4> weight{};
  int count = 0;
};

/// A mesh with weights, in the rest pose and the model's frame.
struct BoundMesh {
  Mesh mesh;  ///< with normals and colours
  std::vector<Weights> weights;
};

/// Around the human's particles; its measures are those of a human of 1.75 m scaled by the length
/// of the thigh. REQUIRES: tree.human.
BoundMesh humanSkin(const Skeleton& skeleton, const FrameTree& tree);

class Skin {
 public:
  Skin(const BoundMesh& bound, const Skeleton& skeleton, const FrameTree& tree);

  const Mesh& rest() const { return rest_; }
  /// Vertices, normals and lit colours for the particles x (3 x n) and orientations of the parts.
  /// `out` starts as a copy of rest(); allocates nothing once it has run.
  void deform(const Eigen::Ref<const Points>& x, const Quat* parts, Blend blend, Mesh& out);

 private:
  /// Rigid motion of a part since the rest pose, in every form that the blends need.
  struct Motion {
    Eigen::Matrix3f rotation;
    Eigen::Vector3f shift;
    Eigen::Vector4f real, dual;  ///< (x, y, z, w)
  };
  void findMotions(const Eigen::Ref<const Points>& x, const Quat* parts);
  Motion blendLinear(const Weights& weights) const;
  Motion blendDual(const Weights& weights) const;

  std::vector<Part> parts_;
  std::vector<Vec3> anchors_;  ///< [m] per part, rest pose
  std::vector<Weights> weights_;
  std::vector<Motion> motions_;
  Eigen::Matrix3Xf vertices_, normals_;  ///< of the rest pose
  Mesh rest_;
};

}  // namespace ragdoll
