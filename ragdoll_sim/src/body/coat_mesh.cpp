#include "ragdoll_sim/body/coat_mesh.h"

#include "body/rigid_coat.h"
#include "ragdoll_sim/body/part_motion.h"
#include "ragdoll_sim/body/skin.h"

namespace ragdoll {
namespace {

/// Fewer vertices of each piece for itself: it keeps its part and its colour.
std::vector<RigidPiece> coarsened(std::vector<RigidPiece> pieces, double loss) {
  std::vector<int> kept;
  for (RigidPiece& piece : pieces) piece.mesh = coarsened(piece.mesh, loss, {}, kept);
  return pieces;
}

/// What different parts carry is never merged: no web between an arm and the trunk.
BoundMesh coarsened(const BoundMesh& bound, double loss) {
  std::vector<int> first_part, kept;
  for (const Weights& w : bound.weights) first_part.push_back(w.part[0]);
  BoundMesh result;
  result.mesh = coarsened(bound.mesh, loss, first_part, kept);
  for (const int i : kept) result.weights.push_back(bound.weights[i]);
  return result;
}

}  // namespace

/// Sticks and particles themselves, as the coat `sticks` shows them.
class StickMesh {
 public:
  StickMesh(const Skeleton& skeleton, double loss)
      : sticks_(skeleton.sticks), named_(skeleton.named) {
    const bool fine = loss <= 0;
    const double stick = sticks_look::kWidth / 2, ball = sticks_look::kParticleSize / 2;
    rod_ = tube(Vec3::Zero(),
                {{Vec3::Zero(), stick * Vec3::UnitX(), stick * Vec3::UnitY()},
                 {Vec3::UnitZ(), stick * Vec3::UnitX(), stick * Vec3::UnitY()}},
                Vec3::UnitZ(), fine ? 6 : 3);
    ball_ = fine ? ellipsoid(Vec3::Constant(ball), 10, 5) : ellipsoid(Vec3::Constant(ball), 4, 1);
    rod_.colors.assign(rod_.vertices.cols(), sticks_look::kColor);
    ball_.colors.assign(ball_.vertices.cols(), sticks_look::kParticleColor);
    for (std::size_t k = 0; k < sticks_.size(); ++k) append(rod_, Pose(), rest_);
    for (int p = 0; p < named_; ++p) append(ball_, Pose(), rest_);
    pose(skeleton.rest, rest_);
    for (Eigen::Index i = 0; i < rest_.vertices.cols(); ++i)
      rest_.colors[i] = i < rods() ? sticks_look::kColor : sticks_look::kParticleColor;
  }

  const Mesh& rest() const { return rest_; }

  void pose(const Eigen::Ref<const Points>& x, Mesh& out) const {
    Eigen::Index first = 0;
    for (const Stick& s : sticks_) {
      const Vec3 along = x.col(s.b) - x.col(s.a);
      const double length = along.norm();
      const Quat turn = length > kMinLength
                            ? smallestRotation(Vec3::UnitZ(), along / length, Vec3::UnitX())
                            : Quat::Identity();
      place(rod_, turn, x.col(s.a), length, first, out);
    }
    for (int p = 0; p < named_; ++p) place(ball_, Quat::Identity(), x.col(p), 1, first, out);
  }

 private:
  Eigen::Index rods() const {
    return static_cast<Eigen::Index>(sticks_.size()) * rod_.vertices.cols();
  }

  /// z is made `stretch` times as long. Moves `first` on.
  static void place(const Mesh& mesh, const Quat& turn, const Vec3& origin, double stretch,
                    Eigen::Index& first, Mesh& out) {
    const Eigen::Matrix3d r = turn.toRotationMatrix();
    const Eigen::Matrix3d stretched = r * Eigen::DiagonalMatrix<double, 3>(1, 1, stretch);
    for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i, ++first) {
      out.vertices.col(first).noalias() = stretched * mesh.vertices.col(i) + origin;
      out.normals.col(first).noalias() = r * mesh.normals.col(i);
      out.colors[first] = shade(mesh.colors[i], out.normals.col(first));
    }
  }

  std::vector<Stick> sticks_;
  int named_;
  Mesh rod_;  ///< of length 1 along z
  Mesh ball_, rest_;
};

struct CoatMesh::Impl {
  Mesh none;
  std::unique_ptr<StickMesh> sticks;
  std::unique_ptr<RigidCoat> rigid;
  std::unique_ptr<Skin> skin;
};

CoatMesh::CoatMesh(CoatKind kind, const Skeleton& skeleton, const FrameTree& tree, double loss)
    : impl_(std::make_unique<Impl>()) {
  if (kind == CoatKind::kNone) return;
  if (kind == CoatKind::kSticks) {
    impl_->sticks = std::make_unique<StickMesh>(skeleton, loss);
  } else if (kind == CoatKind::kSkin && tree.human) {
    const BoundMesh skin = humanSkin(skeleton, tree);
    impl_->skin = std::make_unique<Skin>(loss > 0 ? coarsened(skin, loss) : skin, skeleton, tree);
  } else if (kind == CoatKind::kBoxes) {
    impl_->rigid = std::make_unique<RigidCoat>(boxPieces(skeleton, tree), skeleton, tree);
  } else {
    const std::vector<RigidPiece> pieces = capsulePieces(skeleton, tree);
    impl_->rigid =
        std::make_unique<RigidCoat>(loss > 0 ? coarsened(pieces, loss) : pieces, skeleton, tree);
  }
}

CoatMesh::~CoatMesh() = default;
CoatMesh::CoatMesh(CoatMesh&&) noexcept = default;
CoatMesh& CoatMesh::operator=(CoatMesh&&) noexcept = default;

const Mesh& CoatMesh::rest() const {
  if (impl_->sticks) return impl_->sticks->rest();
  if (impl_->rigid) return impl_->rigid->rest();
  return impl_->skin ? impl_->skin->rest() : impl_->none;
}

void CoatMesh::pose(const Eigen::Ref<const Points>& x, const Quat* parts, Mesh& out) {
  if (impl_->sticks)
    impl_->sticks->pose(x, out);
  else if (impl_->rigid)
    impl_->rigid->pose(x, parts, out);
  else if (impl_->skin)
    impl_->skin->deform(x, parts, Blend::kDualQuaternion, out);
}

}  // namespace ragdoll
