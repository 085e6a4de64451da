#include "ragdoll_sim/body/skin.h"

#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll {
namespace {

/// Product of quaternions (x, y, z, w) as coefficients.
Eigen::Vector4f product(const Eigen::Vector4f& a, const Eigen::Vector4f& b) {
  Eigen::Vector4f c;
  c.head<3>() = a[3] * b.head<3>() + b[3] * a.head<3>() + a.head<3>().cross(b.head<3>());
  c[3] = a[3] * b[3] - a.head<3>().dot(b.head<3>());
  return c;
}

}  // namespace

Skin::Skin(const BoundMesh& bound, const Skeleton& skeleton, const FrameTree& tree)
    : parts_(tree.parts),
      weights_(bound.weights),
      motions_(tree.parts.size()),
      vertices_(bound.mesh.vertices.cast<float>()),
      normals_(bound.mesh.normals.cast<float>()),
      rest_(bound.mesh) {
  for (const Part& part : parts_) anchors_.push_back(partAnchor(part, skeleton.rest));
}

void Skin::findMotions(const Eigen::Ref<const Points>& x, const Quat* parts) {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Motion& m = motions_[p];
    m.rotation = parts[p].toRotationMatrix().cast<float>();
    m.shift = (partAnchor(parts_[p], x) - parts[p] * anchors_[p]).cast<float>();
    m.real = parts[p].coeffs().cast<float>();
    // Neighbours' quaternions on the same side of the sphere, so that a blend takes the short way.
    const int parent = parts_[p].parent;
    if (parent >= 0 && motions_[parent].real.dot(m.real) < 0) m.real = -m.real;
    const Eigen::Vector4f shift(m.shift.x(), m.shift.y(), m.shift.z(), 0);
    m.dual = 0.5f * product(shift, m.real);
  }
}

Skin::Motion Skin::blendLinear(const Weights& w) const {
  Motion m;
  m.rotation.setZero();
  m.shift.setZero();
  for (int i = 0; i < w.count; ++i) {
    m.rotation += w.weight[i] * motions_[w.part[i]].rotation;
    m.shift += w.weight[i] * motions_[w.part[i]].shift;
  }
  return m;
}

Skin::Motion Skin::blendDual(const Weights& w) const {
  const Eigen::Vector4f& pivot = motions_[w.part[0]].real;
  Eigen::Vector4f real = Eigen::Vector4f::Zero(), dual = Eigen::Vector4f::Zero();
  for (int i = 0; i < w.count; ++i) {
    const Motion& m = motions_[w.part[i]];
    const float weight = m.real.dot(pivot) < 0 ? -w.weight[i] : w.weight[i];
    real += weight * m.real;
    dual += weight * m.dual;
  }
  // [Kavan2008, alg. 1]: divide by the norm of the real part; shift = 2 dual * conj(real).
  const float inverse = 1 / real.norm();
  real *= inverse;
  dual *= inverse;
  Motion m;
  const Eigen::Quaternionf q(real[3], real[0], real[1], real[2]);
  m.rotation = q.toRotationMatrix();
  m.shift = 2 * (real[3] * dual.head<3>() - dual[3] * real.head<3>() +
                 real.head<3>().cross(dual.head<3>()));
  return m;
}

void Skin::deform(const Eigen::Ref<const Points>& x, const Quat* parts, Blend blend, Mesh& out) {
  findMotions(x, parts);
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const Weights& w = weights_[i];
    const auto move = [&](const Motion& m, bool unit) {
      out.vertices.col(i) = (m.rotation * vertices_.col(i) + m.shift).cast<double>();
      Eigen::Vector3f normal = m.rotation * normals_.col(i);
      if (!unit) normal.normalize();
      out.normals.col(i) = normal.cast<double>();
    };
    if (w.count == 1)
      move(motions_[w.part[0]], true);
    else if (blend == Blend::kLinear)
      move(blendLinear(w), false);
    else
      move(blendDual(w), true);
    out.colors[i] = shade(rest_.colors[i], out.normals.col(i));
  }
}

}  // namespace ragdoll
