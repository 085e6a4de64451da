// Many bodies of one look as one mesh for Ogre: one vertex buffer that is written anew for each
// picture, and one index buffer that is not. So the number of draw calls does not grow with the
// number of bodies.
#pragma once

#include <OgreMaterial.h>
#include <OgreSimpleRenderable.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "ragdoll_sim/body/coat_mesh.h"

namespace ragdoll_rviz {

class BodyBatch : public Ogre::SimpleRenderable {
 public:
  /// The material must show colours of vertices.
  BodyBatch(ragdoll::CoatMesh coat, const Ogre::MaterialPtr& material);
  ~BodyBatch() override;
  BodyBatch(const BodyBatch&) = delete;
  BodyBatch& operator=(const BodyBatch&) = delete;

  /// One body to be drawn; the pointers hold until draw().
  struct Body {
    const double* x;              ///< [m] first of its particles, 3 x n by columns
    Eigen::Index particles;       ///< n
    const ragdoll::Quat* parts;   ///< orientations of its parts
    std::optional<ragdoll::Rgba> color;  ///< in place of the coat's own
  };
  void clear() { bodies_.clear(); }
  void add(const Body& body) { bodies_.push_back(body); }
  /// Shows what was added, so opaque [0, 1].
  void draw(float alpha);

  std::size_t triangles() const { return bodies_.size() * coat_.rest().triangles.size(); }

  // Of Ogre's interface.
  Ogre::Real getBoundingRadius() const override { return radius_; }
  Ogre::Real getSquaredViewDepth(const Ogre::Camera* camera) const override;

 private:
  struct Vertex {
    float x, y, z;
    std::uint8_t r, g, b, a;
  };
  void reserve(std::size_t bodies);
  void write(const Body& body, float alpha, Vertex* out);

  ragdoll::CoatMesh coat_;
  ragdoll::Mesh posed_;
  std::vector<Body> bodies_;
  std::size_t capacity_ = 0;  ///< [bodies]
  float radius_ = 0;          ///< [m] about the origin
  Eigen::Vector3f low_, high_;
};

}  // namespace ragdoll_rviz
