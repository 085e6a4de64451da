#include "ragdoll_sim/body/mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace ragdoll {
namespace {

Vec3 corner(const Mesh& mesh, const Triangle& t, int i) { return mesh.vertices.col(t[i]); }

/// Twice the area, along the outward normal.
Vec3 areaVector(const Mesh& mesh, const Triangle& t) {
  return (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
}

/// Rings of a sphere from latitude `from` to `to` (poles themselves left out).
void addSphereRings(const Vec3& centre, double radius, const Vec3& u, const Vec3& v, double from,
                    double to, int count, std::vector<Ring>& rings) {
  const Vec3 axis = u.cross(v);
  for (int i = 0; i < count; ++i) {
    const double latitude = from + (to - from) * (count == 1 ? 0.5 : double(i) / (count - 1));
    const double r = radius * std::cos(latitude);
    rings.push_back({centre + radius * std::sin(latitude) * axis, r * u, r * v});
  }
}

/// The nearest of `chosen` that may stand for the vertex; -1: none.
int standIn(const Mesh& mesh, int vertex, double reach, const std::vector<int>& classes,
            const std::vector<int>& chosen) {
  constexpr double kSameSide = 0.3;  // cosine: a limb keeps four or five sides
  int best = -1;
  double nearest = reach * reach;
  for (const int i : chosen) {
    const double distance = (mesh.vertices.col(i) - mesh.vertices.col(vertex)).squaredNorm();
    if (distance >= nearest || mesh.normals.col(i).dot(mesh.normals.col(vertex)) < kSameSide ||
        (!classes.empty() && classes[i] != classes[vertex]))
      continue;
    best = i;
    nearest = distance;
  }
  return best;
}

}  // namespace

Mesh tube(const Vec3& first, const std::vector<Ring>& rings, const Vec3& last, int sides) {
  Mesh mesh;
  const int n = static_cast<int>(rings.size());
  mesh.vertices.resize(3, n * sides + 2);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < sides; ++k) {
      const double t = 2 * M_PI * k / sides;
      mesh.vertices.col(i * sides + k) =
          rings[i].centre + std::cos(t) * rings[i].u + std::sin(t) * rings[i].v;
    }
  const int bottom = n * sides, top = bottom + 1;
  mesh.vertices.col(bottom) = first;
  mesh.vertices.col(top) = last;
  for (int k = 0; k < sides; ++k) {
    const int next = (k + 1) % sides;
    mesh.triangles.push_back({bottom, next, k});
    for (int i = 0; i + 1 < n; ++i) {
      const int a = i * sides + k, b = i * sides + next;
      mesh.triangles.push_back({a, b, b + sides});
      mesh.triangles.push_back({a, b + sides, a + sides});
    }
    mesh.triangles.push_back({(n - 1) * sides + k, (n - 1) * sides + next, top});
  }
  computeNormals(mesh);
  return mesh;
}

Mesh roundCone(const Vec3& a, double radius_a, const Vec3& b, double radius_b, int sides,
               int rings) {
  const double length = (b - a).norm();
  const Vec3 axis = length > kMinLength ? Vec3((b - a) / length) : Vec3::UnitZ();
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
  // Latitude at which the cone touches both spheres.
  const double sine = length > kMinLength ? (radius_a - radius_b) / length : 2;
  const double pole = M_PI / 2, lap = pole / (rings + 0.5);
  std::vector<Ring> list;
  if (std::abs(sine) >= 1) {  // one sphere is within the other
    const bool first = radius_a >= radius_b;
    const Vec3 centre = first ? a : b;
    const double radius = std::max(radius_a, radius_b);
    addSphereRings(centre, radius, u, v, lap - pole, pole - lap, 2 * rings + 1, list);
    return tube(centre - radius * axis, list, centre + radius * axis, sides);
  }
  const double tangent = std::asin(sine);
  const double lap_a = (tangent + pole) / (rings + 1), lap_b = (pole - tangent) / (rings + 1);
  addSphereRings(a, radius_a, u, v, lap_a - pole, tangent, rings + (rings == 1), list);
  addSphereRings(b, radius_b, u, v, tangent, pole - lap_b, rings + (rings == 1), list);
  return tube(a - radius_a * axis, list, b + radius_b * axis, sides);
}

Mesh ellipsoid(const Vec3& half, int sides, int rings) {
  std::vector<Ring> list;
  const double lap = M_PI / (rings + 1);
  addSphereRings(Vec3::Zero(), 1, Vec3::UnitX(), Vec3::UnitY(), lap - M_PI / 2, M_PI / 2 - lap,
                 rings, list);
  for (Ring& ring : list)
    for (Vec3* p : {&ring.centre, &ring.u, &ring.v}) *p = p->cwiseProduct(half);
  return tube(Vec3(0, 0, -half.z()), list, Vec3(0, 0, half.z()), sides);
}

Mesh box(const Vec3& size) {
  Mesh mesh;
  mesh.vertices.resize(3, 24);
  mesh.normals.resize(3, 24);
  int n = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const int j = (axis + 1) % 3, k = (axis + 2) % 3;
      for (int i = 0; i < 4; ++i) {
        Vec3 p;
        p[axis] = side;
        p[j] = (i == 1 || i == 2) ? 1 : -1;
        p[k] = side * (i >= 2 ? 1 : -1);
        mesh.vertices.col(n + i) = p.cwiseProduct(size) / 2;
        mesh.normals.col(n + i) = side * Vec3::Unit(axis);
      }
      mesh.triangles.push_back({n, n + 1, n + 2});
      mesh.triangles.push_back({n, n + 2, n + 3});
      n += 4;
    }
  return mesh;
}

void computeNormals(Mesh& mesh) {
  mesh.normals.setZero(3, mesh.vertices.cols());
  for (const Triangle& t : mesh.triangles)
    for (const int i : t) mesh.normals.col(i) += areaVector(mesh, t);
  mesh.normals.colwise().normalize();
}

void append(const Mesh& part, const Pose& pose, Mesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.cols());
  assert(first == 0 || (mesh.normals.cols() > 0) == (part.normals.cols() > 0));
  assert(first == 0 || mesh.colors.empty() == part.colors.empty());
  const auto put = [&](Points& to, const Points& from, const Vec3& shift) {
    to.conservativeResize(3, to.cols() + from.cols());
    to.rightCols(from.cols()) = (pose.orientation.toRotationMatrix() * from).colwise() + shift;
  };
  put(mesh.vertices, part.vertices, pose.position);
  put(mesh.normals, part.normals, Vec3::Zero());
  for (const Triangle& t : part.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  mesh.colors.insert(mesh.colors.end(), part.colors.begin(), part.colors.end());
}

Mesh coarsened(const Mesh& mesh, double reach, const std::vector<int>& classes,
               std::vector<int>& kept) {
  const int count = static_cast<int>(mesh.vertices.cols());
  kept.clear();
  for (int i = 0; i < count; ++i)
    if (standIn(mesh, i, reach, classes, kept) < 0) kept.push_back(i);
  std::vector<int> stands_for(count);
  for (int i = 0; i < count; ++i) stands_for[i] = standIn(mesh, i, reach, classes, kept);
  Mesh result;
  result.vertices.resize(3, static_cast<Eigen::Index>(kept.size()));
  result.normals.resize(3, result.vertices.cols());
  std::vector<int> place(count, -1);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    place[kept[k]] = static_cast<int>(k);
    result.vertices.col(k) = mesh.vertices.col(kept[k]);
    result.normals.col(k) = mesh.normals.col(kept[k]);
    if (!mesh.colors.empty()) result.colors.push_back(mesh.colors[kept[k]]);
  }
  std::set<Triangle> known;  // a piece that has become flat may have some twice
  for (const Triangle& t : mesh.triangles) {
    const Triangle other = {place[stands_for[t[0]]], place[stands_for[t[1]]],
                            place[stands_for[t[2]]]};
    const bool flat = other[0] == other[1] || other[1] == other[2] || other[2] == other[0];
    if (!flat && known.insert(other).second) result.triangles.push_back(other);
  }
  return result;
}

Rgba shade(const Rgba& color, const Vec3& normal) {
  static const Vec3 sun = Vec3(0.55, -0.35, 0.75).normalized();
  constexpr double kAmbient = 0.55, kSky = 0.20, kSun = 0.35;
  const double light =
      kAmbient + kSky * (1 + normal.z()) / 2 + kSun * std::max(0.0, normal.dot(sun));
  const float l = static_cast<float>(light);
  return {std::min(1.f, color.r * l), std::min(1.f, color.g * l), std::min(1.f, color.b * l),
          color.a};
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += corner(mesh, t, 0).dot(corner(mesh, t, 1).cross(corner(mesh, t, 2)));
  return sum / 6;
}

bool isClosed(const Mesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i)
      if (!edges.insert({t[i], t[(i + 1) % 3]}).second) return false;
  return std::all_of(edges.begin(), edges.end(), [&](const std::pair<int, int>& e) {
    return edges.count({e.second, e.first}) == 1;
  });
}

double smallestArea(const Mesh& mesh) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles)
    smallest = std::min(smallest, areaVector(mesh, t).norm() / 2);
  return smallest;
}

}  // namespace ragdoll
