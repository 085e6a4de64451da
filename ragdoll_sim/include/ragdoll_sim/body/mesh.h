// Triangle meshes: indexed, counter-clockwise seen from outside, [m].
#pragma once

#include <array>
#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct Rgba {
  float r = 1, g = 1, b = 1, a = 1;
};

using Triangle = std::array<int, 3>;

struct Mesh {
  Points vertices;                  ///< [m] 3 x V
  Points normals;                   ///< unit, one per vertex, or empty
  std::vector<Triangle> triangles;  ///< vertex indices
  std::vector<Rgba> colors;         ///< one per vertex, or empty: the owner's colour
};

/// An ellipse of points, centre + cos(t) u + sin(t) v; u x v points along the tube.
struct Ring {
  Vec3 centre, u, v;
};

/// Skin over rings in a row, closed by a point at either end: `first` and `last`.
Mesh tube(const Vec3& first, const std::vector<Ring>& rings, const Vec3& last, int sides);

/// Round cone: the hull of two spheres (a capsule if the radii are equal, a sphere if a == b).
/// sides >= 3 around, each cap of `rings` >= 1 rings.
Mesh roundCone(const Vec3& a, double radius_a, const Vec3& b, double radius_b, int sides = 12,
               int rings = 3);
Mesh ellipsoid(const Vec3& half, int sides = 16, int rings = 9);  ///< about the origin, poles on z
Mesh box(const Vec3& size);  ///< about the origin; corners are not shared, so that edges stay sharp

/// Area-weighted vertex normals of a mesh without them.
void computeNormals(Mesh& mesh);

/// Appends `part` moved by `pose`. Both have normals, and colours, or neither.
void append(const Mesh& part, const Pose& pose, Mesh& mesh);

/// The mesh with fewer vertices: each becomes one of those kept, nearer than `reach` [m], on the
/// same side (so what is thin keeps both its sides) and of the same class (`classes`: one per
/// vertex, or empty). kept: the old index of each vertex, ascending. REQUIRES: normals.
Mesh coarsened(const Mesh& mesh, double reach, const std::vector<int>& classes,
               std::vector<int>& kept);

/// Colour of a surface with unit `normal` in daylight from above and ahead. Viewers like rviz do
/// not light meshes with colours per vertex, so the light is put into the colours.
Rgba shade(const Rgba& color, const Vec3& normal);

double volume(const Mesh& mesh);  ///< [m^3] enclosed, by the divergence theorem; < 0: inside out
bool isClosed(const Mesh& mesh);  ///< every edge is used once in each direction
double smallestArea(const Mesh& mesh);  ///< [m^2] of the smallest triangle

}  // namespace ragdoll
