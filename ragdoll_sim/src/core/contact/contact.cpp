#include "core/contact/contact.h"

namespace ragdoll {

Vec3 Contact::slipOf(const Vec3& moved) const {
  if (!isSoft() || !touches_at_start) return moved;
  return tangentialPart(moved, (start_normal + normal).normalized());
}

Vec3 Contact::turned(const Vec3& at_start) const {
  if (!touches_at_start) return at_start;
  const std::array<Vec3, 3> from = atStart().directions(), to = directions();
  const Vec3 tangential = Eigen::Quaterniond::FromTwoVectors(start_normal, normal) *
                          (at_start[1] * from[1] + at_start[2] * from[2]);
  return {at_start[0], tangential.dot(to[1]), tangential.dot(to[2])};
}

}  // namespace ragdoll
