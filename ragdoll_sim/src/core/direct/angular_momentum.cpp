#include "core/direct/angular_momentum.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/energy.h"
#include "core/direct/group_motion.h"
#include "core/direct/impact_energy.h"

namespace ragdoll {
namespace {

template <class OfX, class OfV>
Vec3 angularOf(const std::vector<Body*>& bodies, const RigidMotion& drift, const OfX& x,
               const OfV& v) {
  Vec3 all = Vec3::Zero();
  for (Body* body : bodies) all += angularOf(massOf(*body), x(*body), v(*body), drift);
  return all;
}

/// [kg m^2/s] By pokes over `took`, about the centre of mass: at the poses half way.
Vec3 givenByPokes(const std::vector<Body*>& bodies, const Vec3& middle, double took) {
  Vec3 given = Vec3::Zero();
  const Points* force_on = bodies[0]->context->force;
  if (!force_on) return given;
  for (const Body* body : bodies)
    for (int i = 0; i < body->n; ++i) {
      const Vec3 force = force_on->col(body->first + i);
      const Vec3 arm = 0.5 * (body->saved.x.col(i) + body->x().col(i)) - middle;
      given += took * arm.cross(force);
    }
  return given;
}

void addSpin(const std::vector<Body*>& bodies, const Vec3& centre, const Vec3& spin) {
  for (Body* body : bodies)
    for (int i = 0; i < body->n; ++i)
      body->v().col(i) += spin.cross(Vec3(body->x().col(i) - centre));
}

/// [rad/s] that makes a rotation's angular momentum that which is wanted.
Vec3 spinFor(const Rotation& now, const Vec3& wanted) {
  return exactSpinOf(now.inertia, wanted - now.angular);
}

/// Turns the bodies together by an angle [rad], beside their common drift: by which a spin that has
/// grown evenly over the motion has. It has pushed at the arms half way, where those at the end are
/// shorter by half of the motion; so velocities turn back by as much before the spin is given.
void turn(const std::vector<Body*>& bodies, const RigidMotion& common, const Vec3& angle) {
  if (angle.isZero(0)) return;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle.norm(), angle.normalized()).toRotationMatrix();
  for (Body* body : bodies) {
    for (int i = 0; i < body->n; ++i) {
      body->x().col(i) = common.centre + R * (body->x().col(i) - common.centre);
      body->v().col(i) = common.drift + R.transpose() * (body->v().col(i) - common.drift);
    }
    BodyResponse& response = body->memory->response;
    response.setEnd(body->xData());
    response.projectAtEnd(body->vData());
    response.endIsStart();
  }
}

/// [J] that a spin may give: what the motion has lost, and what is taken out again of one that is
/// not smooth. took: [s] by the trial.
double energyToGive(Island& island, const std::vector<Body*>& bodies, bool smooth, double took) {
  double energy = 0;
  for (Body* body : bodies) energy += kineticEnergy(*body);
  return std::max(0.0, -gainedEnergy(island, bodies, took, 0)) + (smooth ? 0 : kMostGiven * energy);
}

/// Gives a spin. What energy that needs beyond is taken out of the motion within the bodies. Only a
/// part of the spin is given where there is not so much: after a poke that turns a limb right round
/// in a step the lost momentum belongs to a motion that no step can follow; or where nothing is to
/// be taken out: of smooth motions, and beside springs, whose next substeps give back what this one
/// took.
void giveSpin(Island& island, const std::vector<Body*>& bodies, const Vec3& centre,
              const Vec3& spin, const Rotation& now, double took) {
  const double given = spin.dot(now.angular), square = spin.dot(now.inertia * spin);
  const double needed = given + 0.5 * square;
  const bool smooth = needed > 0 && isSmooth(island);
  const double spare = needed > 0 ? energyToGive(island, bodies, smooth, took) : 0;
  addSpin(bodies, centre, spin);
  const double excess = needed - spare;
  if (!(excess > 0)) return;
  const bool takes = !smooth && !island.context.model.compliant;
  if (takes && takeEnergyOut(island, bodies, isHeld(island, bodies), excess) <= 0) return;
  if (takes)
    for (Body* body : bodies) body->v() = island.s.removal.before.middleCols(body->first, body->n);
  const double share = (std::sqrt(given * given + 2 * square * spare) - given) / square;
  addSpin(bodies, centre, (share - 1) * spin);
}

/// Gives back to bodies that pressed on each other what they lost together over `took`: evenly over
/// that time, so that half of the spin's turn is missing as well. What an impact took came back in
/// it (restoreAfterImpact).
void restoreGroup(Island& island, const std::vector<Body*>& bodies, double took, Held when) {
  // One alone has lost little until an obstacle hits it: less than is known of what pokes gave it.
  if (bodies.size() == 1) when = Held::kAfterImpact;
  const bool turns = bodies.size() > 1 || bodies[0]->n > 1;
  if (!turns || isHeld(island, bodies, when)) return;
  const auto x0 = [](const Body& body) -> const Points& { return body.saved.x; };
  const auto v0 = [](const Body& body) -> const Points& { return body.saved.v; };
  const auto x1 = [](const Body& body) { return body.x(); };
  const auto v1 = [](const Body& body) { return body.v(); };
  const RigidMotion before = driftOf(bodies, x0, v0), after = driftOf(bodies, x1, v1);
  Vec3 wanted = angularOf(bodies, before, x0, v0);
  if (bodies[0]->damps_within) wanted *= std::exp(-island.context.model.solver.damping * took);
  wanted += givenByPokes(bodies, 0.5 * (before.centre + after.centre), took);
  Rotation now = rotationOf(bodies, after, x1, v1);
  if ((wanted - now.angular).norm() <= kNothingLost * now.angular.norm()) return;
  if (bodies.size() > 1) {
    turn(bodies, after, 0.5 * took * spinFor(now, wanted));
    now = rotationOf(bodies, after, x1, v1);
  }
  giveSpin(island, bodies, after.centre, spinFor(now, wanted), now, took);
}

/// Joins the groups of two ragdolls; a sleeper's does not move.
void join(const Island& island, int first, int second, std::vector<int>& group_of) {
  const int a = island.placeOf(first), b = island.placeOf(second);
  if (a >= 0 && b >= 0) joinGroups(a, b, group_of);
}

/// What pressed with p in a solution of velocities: of(contact, its first row).
template <class Of>
void forEachPushed(const Island& island, const RowValues& p, const Of& of) {
  forEachTouching(island, [&](const Contact& c, int row, const Body*, int) {
    if (p[row] > 0) of(c, row);
  });
}

/// What an impact did to bodies that it pressed on each other.
struct Pushed {
  bool held = false;           ///< something outside holds them
  Vec3 couple = Vec3::Zero();  ///< [kg m^2/s] of friction, whose two forces are apart
};

/// Whether a body lies on an obstacle. One that slides along it may have been pressed with 1e-17 or
/// with nothing, which is a matter of rounding.
bool staysOnObstacle(const Body& body) {
  const Schur& schur = body.memory->schur;
  for (int i = 0; i < body.constraints.own_rows; ++i) {
    if (schur.row(i).kind != Schur::Row::Kind::kNormal) continue;
    const Contact& c = body.touching.contacts[schur.row(i).source];
    if (c.obstacle >= 0 && openingRate(*body.context, c) < kParting) return true;
  }
  return false;
}

Pushed pushedBy(const RowValues& p, const Island& island, const std::vector<Body*>& bodies) {
  const JointSchur& joint = island.s.joint;
  Pushed pushed;
  const auto isOf = [&](int ragdoll) {
    return std::any_of(bodies.begin(), bodies.end(),
                       [&](const Body* body) { return body->index == ragdoll; });
  };
  forEachPushed(island, p, [&](const Contact& c, int row) {
    const bool one = isOf(c.ragdoll), other = c.other < 0 ? one : isOf(c.other);
    pushed.held = pushed.held || one != other || (one && c.obstacle >= 0);
    if (!one || !other || c.obstacle >= 0 || !(c.friction > 0)) return;
    Vec3 friction = Vec3::Zero();
    for (int k = row + 1; k < row + 3; ++k) friction += p[k] * joint.row(k).direction;
    pushed.couple += c.of(island.context.state.x).cross(friction);
  });
  for (const Body* body : bodies)
    pushed.held = pushed.held || !body->pinned->pins.empty() || staysOnObstacle(*body);
  return pushed;
}

/// As a spin, what friction took by its couple.
void giveCoupleBack(Island& island, const std::vector<Body*>& bodies, const Pushed& pushed,
                    double took) {
  const auto x = [](const Body& body) { return body.x(); };
  const auto v = [](const Body& body) { return body.v(); };
  const RigidMotion drift = driftOf(bodies, x, v);
  const Rotation now = rotationOf(bodies, drift, x, v);
  giveSpin(island, bodies, drift.centre, exactSpinOf(now.inertia, -pushed.couple), now, took);
}

/// Takes out what an impact gave to bodies that it pressed together. before: [J] of each of the
/// island. What moves obstacles and pins may give energy (energy.h).
void takeImpactGain(Island& island, const std::vector<Body*>& bodies, bool held,
                    const std::vector<double>& before) {
  if (isDriven(bodies)) return;
  const auto energyOf = [](Body& body) { return kineticEnergy(body); };
  const double gain = impactGain(island, bodies, before, energyOf);
  if (gain > 0) takeEnergyOut(island, bodies, held, gain);
}

/// Whether a contact between two bodies presses in the present stage.
bool pressesNow(const Island& island, std::size_t i, TurnOf of) {
  const PairSet& pairs = island.pairs;
  if (of != TurnOf::kMotion) return true;  // of those that touch
  const int row = pairs.row[i];
  if (row < 0) return false;
  const bool pushed = row < island.s.total.size() && island.s.total[row] > 0;
  return pushed || !isOnlyNear(pairs.role[i]) || pairs.cache.find(pairs.contacts[i]);
}

bool pressesOnSleeper(const Island& island, const std::vector<Contact>& contacts, TurnOf of,
                      const std::vector<Body*>& bodies) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const int a = island.placeOf(contacts[i].ragdoll), b = island.placeOf(contacts[i].other);
    if ((a >= 0 && b >= 0) || !pressesNow(island, i, of)) continue;
    const Body* awake = island.bodies[std::max(a, b)];
    if (std::find(bodies.begin(), bodies.end(), awake) != bodies.end()) return true;
  }
  return false;
}

/// Whether a body presses on an obstacle in its motion, or goes on touching it: not what an impact
/// has thrown off just before it, nor what is reached with its end.
bool staysInMotion(const Body& body) {
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    const int row = set.row[i];
    if (c.obstacle < 0 || row < 0 || isReached(set.role[i])) continue;
    if (row < body.total.size() && body.total[row] > 0) return true;
    if (!c.isSoft() && gapAfter(body, c) < body.context->tolerances.touching) return true;
  }
  return false;
}

/// Whether something outside holds bodies of a group, other than sleepers.
bool isHeld(const Island& island, const std::vector<Body*>& bodies, TurnOf of, Held when) {
  if (of != TurnOf::kMotion) return isHeld(island, bodies, when);
  return std::any_of(bodies.begin(), bodies.end(), [](const Body* body) {
    return !body->pinned->pins.empty() || staysInMotion(*body);
  });
}

/// How many contacts between bodies press in their motions, and bodies on obstacles.
int countPressing(const Island& island) {
  int count = 0;
  for (std::size_t i = 0; i < island.pairs.contacts.size(); ++i)
    count += pressesNow(island, i, TurnOf::kMotion);
  for (const Body* body : island.bodies) count += staysInMotion(*body);
  return count;
}

/// How many bodies turn, and in how many groups: other groups are more or fewer.
std::array<int, 2> countTurning(const CommonTurns& turns) {
  std::array<int, 2> count{0, 0};
  for (std::size_t k = 0; k < turns.turn.size(); ++k) {
    if (turns.turn[k].isZero(0)) continue;
    ++count[0];
    count[1] += turns.first[k] == static_cast<int>(k);
  }
  return count;
}

/// Of bodies that press on each other.
Vec3 turnOf(const std::vector<Body*>& bodies, TurnOf of) {
  if (of == TurnOf::kVelocity)
    return spinOfGroup(
               bodies, [](const Body& body) { return body.x(); },
               [](const Body& body) { return body.v(); })
        .rate;
  if (of == TurnOf::kStart)
    return spinOfGroup(
               bodies, [](const Body& body) -> const Points& { return body.saved.x; },
               [](const Body& body) -> const Points& { return body.saved.v; })
        .rate;
  for (Body* body : bodies) body->moved = body->x() + 0.5 * body->motion.dx;
  return spinOfGroup(
             bodies, [](const Body& body) -> const Points& { return body.moved; },
             [](const Body& body) -> const Points& { return body.motion.dx; })
      .rate;
}

/// Whether something rubs on another body, or on its own.
bool anyRubs(const Island& island, const std::vector<Contact>& pairs, TurnOf of) {
  const auto rubs = [](const Contact& c) { return c.obstacle < 0 && c.friction > 0; };
  return std::any_of(pairs.begin(), pairs.end(), rubs) ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [&](const Body* body) {
           const std::vector<Contact>& own =
               of == TurnOf::kMotion ? body->constraints.contacts : body->touching.contacts;
           return std::any_of(own.begin(), own.end(), rubs);
         });
}

}  // namespace

const CommonTurns& findTurns(Island& island, TurnOf of, Held when) {
  const std::vector<Contact>& pairs =
      of == TurnOf::kMotion ? island.pairs.contacts : island.pairs.touching.contacts;
  CommonTurns& turns = island.s.turns;
  turns.turn.assign(island.bodies.size(), Vec3::Zero());
  turns.pressing = -1;
  startGroups(island, turns.first);
  if (!anyRubs(island, pairs, of)) return turns;
  turns.pressing = of == TurnOf::kMotion ? countPressing(island) : 0;
  std::vector<int>& group_of = island.s.group;
  startGroups(island, group_of);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pressesNow(island, i, of)) join(island, pairs[i].ragdoll, pairs[i].other, group_of);
  forEachGroup(island, group_of, [&](const std::vector<Body*>& bodies) {
    if (isHeld(island, bodies, of, when) || pressesOnSleeper(island, pairs, of, bodies)) return;
    const Vec3 turn = turnOf(bodies, of);
    const int first = island.placeOf(bodies[0]->index);
    for (const Body* body : bodies) {
      const int place = island.placeOf(body->index);
      turns.turn[place] = turn;
      turns.first[place] = first;
    }
  });
  return turns;
}

bool turnsAnew(Island& island) {
  const CommonTurns& turns = island.s.turns;
  if (turns.pressing < 0 || countPressing(island) == turns.pressing) return false;
  const std::array<int, 2> before = countTurning(turns);
  return countTurning(findTurns(island, TurnOf::kMotion, Held::kAfterImpact)) != before;
}

Vec3 commonTurn(const Island& island, const CommonTurns& turns, const Contact& pair) {
  const int a = island.placeOf(pair.ragdoll), b = island.placeOf(pair.other);
  if (a < 0 || b < 0 || turns.first[a] != turns.first[b]) return Vec3::Zero();
  return turns.turn[a];
}

bool pressesItself(const Island& island) {
  return !island.pairs.pushed.empty() || !island.pairs.touching.contacts.empty() ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
           return !body->cache.empty() || !body->touching.contacts.empty() ||
                  !body->touching.limits.empty();
         });
}

void restoreAngularMomentum(Island& island, double took, Held when) {
  std::vector<int>& group_of = island.s.group;
  startGroups(island, group_of);
  for (const BodyPair& pair : island.pairs.pushed) join(island, pair.first, pair.second, group_of);
  forEachGroup(island, group_of,
               [&](const std::vector<Body*>& bodies) { restoreGroup(island, bodies, took, when); });
}

Vec3 angularMomentumAt(Body& body, const Eigen::Ref<const Points>& x,
                       const Eigen::Ref<const Points>& v) {
  const MassMatrix mass = massOf(body);
  return angularOf(mass, x, v, driftOf(mass, x, v));
}

void restoreInFlight(Body& body, const Vec3& before, double took) {
  if (!body.pinned->pins.empty() || isPoked(body)) return;
  const MassMatrix mass = massOf(body);
  const RigidMotion now = driftOf(mass, body.x(), body.v());
  const double kept = body.damps_within ? std::exp(-body.context->model.solver.damping * took) : 1;
  const Vec3 spin = spinFor(rotationOf(mass, body.x(), body.v(), now), kept * before);
  for (int i = 0; i < body.n; ++i)
    body.v().col(i) += spin.cross(Vec3(body.x().col(i) - now.centre));
}

void restoreAfterImpact(Island& island, const VelocitySolution& impact, double took) {
  if (!impact.impulses) return;
  const RowValues& p = *impact.impulses;
  std::vector<int>& group_of = island.s.group;
  startGroups(island, group_of);
  forEachPushed(island, p, [&](const Contact& c, int) {
    if (c.other >= 0) join(island, c.ragdoll, c.other, group_of);
  });
  forEachGroup(island, group_of, [&](const std::vector<Body*>& bodies) {
    const Pushed pushed = pushedBy(p, island, bodies);
    if (!pushed.held && !pushed.couple.isZero(0)) giveCoupleBack(island, bodies, pushed, took);
    takeImpactGain(island, bodies, pushed.held, *impact.energies);
  });
}

}  // namespace ragdoll
