#include "body_batch.h"

#include <OgreCamera.h>
#include <OgreHardwareBufferManager.h>
#include <OgreSceneNode.h>

#include <algorithm>
#include <utility>

namespace ragdoll_rviz {
namespace {

using ragdoll::Rgba;

std::uint8_t byte(float share) {
  return static_cast<std::uint8_t>(255 * std::clamp(share, 0.f, 1.f) + 0.5f);
}

}  // namespace

BodyBatch::BodyBatch(ragdoll::CoatMesh coat, const Ogre::MaterialPtr& material)
    : coat_(std::move(coat)), posed_(coat_.rest()) {
  setMaterial(material);
  mRenderOp.operationType = Ogre::RenderOperation::OT_TRIANGLE_LIST;
  mRenderOp.useIndexes = true;
  mRenderOp.vertexData = new Ogre::VertexData;
  mRenderOp.indexData = new Ogre::IndexData;
  Ogre::VertexDeclaration* layout = mRenderOp.vertexData->vertexDeclaration;
  layout->addElement(0, offsetof(Vertex, x), Ogre::VET_FLOAT3, Ogre::VES_POSITION);
  layout->addElement(0, offsetof(Vertex, r), Ogre::VET_COLOUR_ABGR, Ogre::VES_DIFFUSE);
}

BodyBatch::~BodyBatch() {
  delete mRenderOp.vertexData;
  delete mRenderOp.indexData;
}

/// Room for so many bodies; the same triangles for each.
void BodyBatch::reserve(std::size_t bodies) {
  if (bodies <= capacity_) return;
  capacity_ = bodies;
  const std::size_t vertices = posed_.colors.size();
  const auto& triangles = posed_.triangles;
  Ogre::HardwareBufferManager& manager = Ogre::HardwareBufferManager::getSingleton();
  mRenderOp.vertexData->vertexBufferBinding->setBinding(
      0, manager.createVertexBuffer(sizeof(Vertex), capacity_ * vertices,
                                    Ogre::HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE));
  std::vector<std::uint32_t> indices;
  indices.reserve(capacity_ * triangles.size() * 3);
  for (std::size_t body = 0; body < capacity_; ++body)
    for (const ragdoll::Triangle& t : triangles)
      for (const int i : t)
        indices.push_back(static_cast<std::uint32_t>(body * vertices + static_cast<std::size_t>(i)));
  mRenderOp.indexData->indexBuffer =
      manager.createIndexBuffer(Ogre::HardwareIndexBuffer::IT_32BIT, indices.size(),
                                Ogre::HardwareBuffer::HBU_STATIC_WRITE_ONLY);
  mRenderOp.indexData->indexBuffer->writeData(0, indices.size() * sizeof(std::uint32_t),
                                              indices.data(), true);
}

void BodyBatch::draw(float alpha) {
  const std::size_t vertices = posed_.colors.size();
  const bool any = !bodies_.empty() && vertices > 0;
  setVisible(any);
  if (!any) return;
  reserve(bodies_.size());
  low_.setConstant(std::numeric_limits<float>::max());
  high_ = -low_;
  const Ogre::HardwareVertexBufferSharedPtr buffer =
      mRenderOp.vertexData->vertexBufferBinding->getBuffer(0);
  auto* out = static_cast<Vertex*>(buffer->lock(Ogre::HardwareBuffer::HBL_DISCARD));
  for (const Body& body : bodies_) {
    write(body, alpha, out);
    out += vertices;
  }
  buffer->unlock();
  mRenderOp.vertexData->vertexCount = bodies_.size() * vertices;
  mRenderOp.indexData->indexCount = bodies_.size() * posed_.triangles.size() * 3;
  radius_ = low_.cwiseAbs().cwiseMax(high_.cwiseAbs()).norm();
  setBoundingBox({Ogre::Vector3(low_.x(), low_.y(), low_.z()),
                  Ogre::Vector3(high_.x(), high_.y(), high_.z())});
  if (getParentSceneNode()) getParentSceneNode()->needUpdate();
}

void BodyBatch::write(const Body& body, float alpha, Vertex* out) {
  const Eigen::Map<const ragdoll::Points> x(body.x, 3, body.particles);
  coat_.pose(x, body.parts, posed_);
  for (Eigen::Index i = 0; i < posed_.vertices.cols(); ++i) {
    const Eigen::Vector3f p = posed_.vertices.col(i).cast<float>();
    const Rgba c = body.color ? ragdoll::shade(*body.color, posed_.normals.col(i))
                              : posed_.colors[static_cast<std::size_t>(i)];
    out[i] = {p.x(), p.y(), p.z(), byte(c.r), byte(c.g), byte(c.b), byte(c.a * alpha)};
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
}

Ogre::Real BodyBatch::getSquaredViewDepth(const Ogre::Camera* camera) const {
  return getParentSceneNode() ? getParentSceneNode()->getSquaredViewDepth(camera) : 0;
}

}  // namespace ragdoll_rviz
