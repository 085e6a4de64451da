#include "body/rigid_coat.h"

#include <algorithm>

#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll {
namespace {

constexpr double kMostStretch = 2;  ///< a bone's pieces follow its length within this factor

double boneLength(const Part& part, const Eigen::Ref<const Points>& x) {
  return (x.col(part.particles[1]) - x.col(part.particles[0])).norm();
}

}  // namespace

RigidCoat::RigidCoat(const std::vector<RigidPiece>& pieces, const Skeleton& skeleton,
                     const FrameTree& tree)
    : parts_(tree.parts) {
  for (const Part& part : parts_) {
    anchors_.push_back(partAnchor(part, skeleton.rest));
    lengths_.push_back(part.group ? 0 : boneLength(part, skeleton.rest));
  }
  for (const RigidPiece& piece : pieces) {
    const int first = static_cast<int>(rest_.vertices.cols());
    const int count = static_cast<int>(piece.mesh.vertices.cols());
    spans_.push_back({piece.part, first, count});
    Mesh mesh = piece.mesh;
    mesh.colors.assign(count, piece.color);
    append(mesh, Pose(), rest_);
  }
}

std::vector<int> RigidCoat::partOfVertex() const {
  std::vector<int> parts;
  for (const Span& span : spans_) parts.insert(parts.end(), span.count, span.part);
  return parts;
}

void RigidCoat::pose(const Eigen::Ref<const Points>& x, const Quat* parts, Mesh& out) const {
  for (const Span& span : spans_) {
    const Part& part = parts_[span.part];
    const Eigen::Matrix3d r = parts[span.part].toRotationMatrix();
    Eigen::Matrix3d stretched = r;
    if (!part.group && lengths_[span.part] > kMinLength) {
      const double s =
          std::clamp(boneLength(part, x) / lengths_[span.part], 1 / kMostStretch, kMostStretch);
      const Vec3& d = part.rest_direction;
      stretched += (s - 1) * (r * d) * d.transpose();
    }
    const Vec3 shift = partAnchor(part, x) - stretched * anchors_[span.part];
    for (int i = span.first; i < span.first + span.count; ++i) {
      out.vertices.col(i).noalias() = stretched * rest_.vertices.col(i) + shift;
      out.normals.col(i).noalias() = r * rest_.normals.col(i);
      out.colors[i] = shade(rest_.colors[i], out.normals.col(i));
    }
  }
}

}  // namespace ragdoll
