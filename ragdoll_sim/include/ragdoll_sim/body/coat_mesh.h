// A coat as one mesh, shared by all bodies of a skeleton: for viewers that draw many bodies and see
// most of them from afar. Coat (coat.h) is the coat of one body, shape by shape.
#pragma once

#include <memory>

#include "ragdoll_sim/body/coat.h"

namespace ragdoll {

class CoatMesh {
 public:
  /// loss: [m] detail that may be lost; 0: none. Boxes have none to lose. Without triangles for
  /// kNone.
  CoatMesh(CoatKind kind, const Skeleton& skeleton, const FrameTree& tree, double loss = 0);
  ~CoatMesh();
  CoatMesh(CoatMesh&&) noexcept;
  CoatMesh& operator=(CoatMesh&&) noexcept;

  /// The rest pose, with normals and colours that are not lit.
  const Mesh& rest() const;

  /// Vertices, normals and lit colours of one body, for its particles x (3 x n) and the
  /// orientations of its parts. `out` starts as a copy of rest(). Allocates nothing once it has run.
  void pose(const Eigen::Ref<const Points>& x, const Quat* parts, Mesh& out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ragdoll
