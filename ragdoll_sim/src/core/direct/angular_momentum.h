// The angular momentum of bodies on which nothing outside acts but pokes and gravity.
//
// Three stages of a motion take from it. Backward Euler pulls along the sticks' directions at the
// end, on ends that have moved since their momentum was taken. Where contacts or limits press, so
// do explicit steps where they bring sticks back along their new directions. And friction between
// two capsules acts on their axes, as bones take no moment about their own: two opposite forces
// that are as far apart as the radii together, in place of one point of both surfaces. What they
// take comes back as a spin of all bodies that pressed on each other together, which changes no
// distance and no speed between them; who only came near gets none of it. The couple of friction
// does work on that spin. So what slips is measured against it, and bodies that turn together as
// one do not slip: then friction gives no energy. What the other two stages need is taken out of
// the motion within them.
#pragma once

#include "core/direct/energy.h"
#include "core/direct/velocity_solver.h"

namespace ragdoll {

/// Whether contacts between the bodies, or contacts or limits of one, pressed in the last motion.
bool pressesItself(const Island& island);

/// How the bodies turn together in their motions (dx), by their velocities, or by those from which
/// their motions began. Until the next call.
enum class TurnOf { kMotion, kVelocity, kStart };
const CommonTurns& findTurns(Island& island, TurnOf of, Held when);
/// Whether by what presses now they turn otherwise in their motions than they did when turns were
/// found last; finds them if so.
bool turnsAnew(Island& island);
/// That of both sides of a contact: between bodies none where they do not press on each other; of a
/// body's own contacts, whose turn is given.
Vec3 commonTurn(const Island& island, const CommonTurns& turns, const Contact& pair);
inline Vec3 commonTurn(const Vec3& turn, const Contact& own) {
  return own.obstacle < 0 ? turn : Vec3(Vec3::Zero());
}

/// After a motion over `took` [s] since the bodies were saved; nothing where pins, obstacles or
/// sleepers take part.
void restoreAngularMomentum(Island& island, double took, Held when = Held::kAfterImpact);

/// [kg m^2/s] Of a body at x that moves by v (3 x n), about its centre of mass.
Vec3 angularMomentumAt(Body& body, const Eigen::Ref<const Points>& x,
                       const Eigen::Ref<const Points>& v);
/// Gives back to a body that flies, as a spin, what a smooth motion over `took` [s] errs of its
/// angular momentum, which was `before`: a formula's error, of its order. Nothing where a pin or a
/// poke acts.
void restoreInFlight(Body& body, const Vec3& before, double took);

/// After an impact. Bodies that it pressed on each other, and nothing outside on them, whatever
/// held them until then, get back what its friction took. Energy that it gave (impact_energy.h) is
/// taken out. took: [s] by the trial, at the most.
void restoreAfterImpact(Island& island, const VelocitySolution& impact, double took);

}  // namespace ragdoll
