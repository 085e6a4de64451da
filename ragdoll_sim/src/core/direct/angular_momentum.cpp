#include "core/direct/angular_momentum.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/energy.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

constexpr double kRounding = 1e-15;  ///< of the angular momentum: less lost is nothing lost

/// The motion of the bodies' common centre of mass, at x, v of each: of(body).
template <class OfX, class OfV>
RigidMotion driftOf(const Island& island, const OfX& x, const OfV& v) {
  RigidMotion drift;
  double mass = 0;
  for (const Body* body : island.bodies) {
    const Eigen::VectorXd& own = body->rows->mass;
    drift.centre += x(*body).lazyProduct(own);
    drift.drift += v(*body).lazyProduct(own);
    mass += own.sum();
  }
  drift.centre /= mass;
  drift.drift /= mass;
  return drift;
}

template <class OfX, class OfV>
Rotation rotationOf(const Island& island, const RigidMotion& drift, const OfX& x, const OfV& v) {
  Rotation all;
  for (Body* body : island.bodies) {
    const Rotation own = rotationOf(massOf(*body), x(*body), v(*body), drift);
    all.angular += own.angular;
    all.inertia += own.inertia;
  }
  return all;
}

/// [kg m^2/s] By pokes over `took`, about the centre of mass: at the poses half way.
Vec3 givenByPokes(const Island& island, const Vec3& middle, double took) {
  Vec3 given = Vec3::Zero();
  if (!island.context.force) return given;
  for (const Body* body : island.bodies)
    for (int i = 0; i < body->n; ++i) {
      const Vec3 force = island.context.force->col(body->first + i);
      const Vec3 arm = 0.5 * (body->saved.x.col(i) + body->x().col(i)) - middle;
      given += took * arm.cross(force);
    }
  return given;
}

/// How much of a spin can be added without giving more energy than can be taken out again: after a
/// poke that turns a limb right round in a step the lost momentum belongs to a motion that no step
/// can follow.
double shareToGive(Island& island, const Vec3& spin, const Rotation& now) {
  const double given = spin.dot(now.angular), square = spin.dot(now.inertia * spin);
  double energy = 0;
  for (Body* body : island.bodies) energy += kineticEnergy(*body);
  double spare = std::max(0.0, -gainedEnergy(island, 0));
  if (!isSmooth(island)) spare += kMostGiven * energy;  // else no gain is taken out
  if (!(given + 0.5 * square > spare)) return 1;
  return (std::sqrt(given * given + 2 * square * spare) - given) / square;
}

}  // namespace

bool pressesItself(const Island& island) {
  const Model& model = island.context.model;
  return model.ragdoll_collision || model.self_collision || !island.pairs.pressing.empty() ||
         !island.pairs.touching.empty() ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
           return !body->cache.empty() || !body->touching.contacts.empty() ||
                  !body->touching.limits.empty();
         });
}

void restoreAngularMomentum(Island& island, double took) {
  if (isHeld(island)) return;
  const auto x0 = [](const Body& body) -> const Points& { return body.saved.x; };
  const auto v0 = [](const Body& body) -> const Points& { return body.saved.v; };
  const auto x1 = [](const Body& body) { return body.x(); };
  const auto v1 = [](const Body& body) { return body.v(); };
  const RigidMotion before = driftOf(island, x0, v0), after = driftOf(island, x1, v1);
  Vec3 wanted = rotationOf(island, before, x0, v0).angular;
  if (island.bodies[0]->damps_within)
    wanted *= std::exp(-island.context.model.solver.damping * took);
  wanted += givenByPokes(island, 0.5 * (before.centre + after.centre), took);
  const Rotation now = rotationOf(island, after, x1, v1);
  const Vec3 lost = wanted - now.angular;
  if (lost.norm() <= kRounding * now.angular.norm()) return;
  Vec3 spin = spinOf(now.inertia, lost);
  spin += spinOf(now.inertia, lost - now.inertia * spin);  // it is exact but for its guard
  spin *= shareToGive(island, spin, now);
  for (Body* body : island.bodies)
    for (int i = 0; i < body->n; ++i)
      body->v().col(i) += spin.cross(Vec3(body->x().col(i) - after.centre));
}

}  // namespace ragdoll
