#include "ragdoll_sim/core/direction.h"

namespace ragdoll {
namespace {

void add(int column, const Vec3& g, LimitRow& row) {
  for (int k = 0; k < row.count; ++k)
    if (row.particle[k] == column) {
      row.gradient[k] += g;
      return;
    }
  row.particle[row.count] = column;
  row.gradient[row.count++] = g;
}

/// Through e / |e|.
void addBone(int from, int to, const Vec3& g, const double* x, int first, LimitRow& row) {
  const Vec3 e = pointAt(x, to) - pointAt(x, from);
  const double length = std::max(e.norm(), kMinLength);
  const Vec3 u = e / length;
  const Vec3 t = (g - u.dot(g) * u) / length;
  add(first + to, t, row);
  add(first + from, -t, row);
}

void addBase(const Direction& d, const Vec3& c, const Vec3& g, const double* x, int first,
             LimitRow& row) {
  const Vec3 e = pointAt(x, d.base[1]) - pointAt(x, d.base[0]);
  const Vec3 f = pointAt(x, d.base[2]) - pointAt(x, d.base[0]);
  const Vec3 q = c[0] * e + c[1] * f + c[2] * e.cross(f);
  const double length = std::max(q.norm(), kMinLength);
  const Vec3 u = q / length;
  const Vec3 t = (g - u.dot(g) * u) / length;
  const Vec3 on_e = c[0] * t + c[2] * f.cross(t);
  const Vec3 on_f = c[1] * t + c[2] * t.cross(e);
  add(first + d.base[0], -on_e - on_f, row);
  add(first + d.base[1], on_e, row);
  add(first + d.base[2], on_f, row);
}

/// Derivatives of g . swung(a, u, v) with respect to a, u and v.
struct SwingGradient {
  Vec3 a, u, v;
};

SwingGradient swingGradient(const Vec3& a, const Vec3& u, const Vec3& v, const Vec3& g) {
  const Vec3 s = a + u;
  const double divisor = 1 + a.dot(u);
  const double k = 1 / std::max(divisor, kMinSwing);
  const double sv = s.dot(v), sg = s.dot(g);
  const Vec3 on_s = -k * (sg * v + sv * g);
  const double on_divisor = divisor > kMinSwing ? k * k * sv * sg : 0;
  return {on_s + on_divisor * u + (2 * u.dot(g)) * v, on_s + on_divisor * a + (2 * a.dot(v)) * g,
          g - k * sg * s + (2 * u.dot(g)) * a};
}

void addCarried(const Direction& d, int swings, const Vec3& c, const Vec3& g, const double* x,
                int first, LimitRow& row) {
  if (swings == 0) return addBase(d, c, g, x, first, row);
  const Direction::Swing& bone = d.swing[swings - 1];
  const Vec3 a = carried(d, swings - 1, bone.axis, x), v = carried(d, swings - 1, c, x);
  const SwingGradient on = swingGradient(a, boneDirection(bone, x), v, g);
  addCarried(d, swings - 1, bone.axis, on.a, x, first, row);
  addCarried(d, swings - 1, c, on.v, x, first, row);
  addBone(bone.from, bone.to, on.u, x, first, row);
}

}  // namespace

void addGradient(const Direction& d, const Vec3& g, const double* x, int first, LimitRow& row) {
  if (d.bone) return addBone(d.base[0], d.base[1], g, x, first, row);
  addCarried(d, d.swings, d.c, g, x, first, row);
}

}  // namespace ragdoll
