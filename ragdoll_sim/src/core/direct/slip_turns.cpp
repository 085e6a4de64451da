#include "core/direct/slip_turns.h"

#include <algorithm>
#include <limits>

#include "core/direct/angular_momentum.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"

namespace ragdoll {
namespace {

/// A contact that touches all along a motion.
struct Sliding {
  const Contact* contact = nullptr;
  const Body* body = nullptr;  ///< whose own it is; null: of two
  int row = 0;                 ///< its first, of the joint ones
  Vec3 warm = Vec3::Zero();    ///< [N s] of the position stage, along its directions at the end
  Vec3 end = Vec3::Zero();     ///< [m/s] its slip at the end
};

template <class Visit>
void visitPoints(const Island& island, const Sliding& s, const Visit& visit) {
  if (s.body)
    visitMoving(*s.body, *s.contact, visit);
  else
    visitMoving(island, *s.contact, visit);
}

Vec3 turnOf(const Island& island, const CommonTurns& turns, const Sliding& s) {
  const Contact& c = *s.contact;
  if (!s.body) return commonTurn(island, turns, c);
  return commonTurn(turns.turn[island.placeOf(c.ragdoll)], c);
}

Vec3 slipAtEnd(const Island& island, const Sliding& s, const Vec3& turn) {
  const StepContext& step = island.context;
  const Contact& c = *s.contact;
  return tangentialPart(Vec3(rateOf(step, c) - turn.cross(c.of(step.state.x))), c.normal);
}

Vec3 slipAtStart(const Island& island, const Sliding& s, const Vec3& turn) {
  const Contact& c = *s.contact;
  Vec3 slip = -c.surface_start / island.context.h;
  visitPoints(island, s, [&](int k, const Body& body, int i) {
    const Vec3 x = body.saved.x.col(i), v = body.saved.v.col(i);
    slip += c.start_weight[k] * (v - turn.cross(x));
  });
  return tangentialPart(slip, c.start_normal);
}

/// [m/s] The mean one.
Vec3 meanSlip(const Island& island, const Sliding& s, const Vec3& turn, double h) {
  const Contact& c = *s.contact;
  Vec3 slip = -c.surfaceMean() / island.context.h;
  visitPoints(island, s, [&](int k, const Body& body, int i) {
    const Vec3 dx = body.motion.dx.col(i), x = 0.5 * (body.saved.x.col(i) + body.x().col(i));
    slip += c.middleWeight(k) * (dx / h - turn.cross(x));
  });
  return slip;
}

using Vec2 = Eigen::Vector2d;

/// [N s] Worth a shorter motion: less friction over h hardly moves the lighter of the two, by what
/// is of second order.
double leastFriction(const Island& island, const Sliding& s, double h) {
  double mass = std::numeric_limits<double>::infinity();
  for (const int ragdoll : {s.contact->ragdoll, s.contact->other}) {
    const int place = island.placeOf(ragdoll);
    if (place >= 0) mass = std::min(mass, island.bodies[place]->rows->mass.sum());
  }
  const double share = kWorthATurn * std::min(1.0, h / kCoarseStep);
  return share * h * std::max(kLeastPull, island.context.model.gravity.norm()) * mass;
}

/// [s] When a slip that begins with `start` has turned by 45 degrees, or ended. Until then it
/// changes at an even rate, by friction against its start and by what else acts, G over h: known
/// from what the slip came to, end - start = A (f + G) with f the friction. It goes on if G is more
/// than friction can hold.
double timeOfTurn(const Island& island, const RowValues& p, const Sliding& s, const Vec3& start,
                  const Vec3& turn, double h) {
  const double never = 2 * h, speed = start.norm();
  // Slower than that it stays within what a solution of that length may leave.
  if (!(speed > tolerancesFor(island.context.h).contact / island.context.h)) return never;
  const JointSchur& joint = island.s.joint;
  const int i = s.row + 1;
  const auto along = [&](const Vec3& v) {
    return Vec2(v.dot(joint.row(i).direction), v.dot(joint.row(i + 1).direction));
  };
  const Vec2 u = along(start) / speed, end = along(s.end);
  const double ahead = end.dot(u), aside = (end - ahead * u).norm();
  if (ahead > kStillSlides * speed && aside < ahead) return never;
  Eigen::Matrix2d A;
  A << joint.entry(i, i), joint.entry(i, i + 1), joint.entry(i + 1, i), joint.entry(i + 1, i + 1);
  const Vec2 change = end - speed * u, held = s.warm.tail<2>(), f = held + p.segment<2>(i);
  const double most = s.contact->friction * (s.warm[0] + p[s.row]);
  if (!(most > leastFriction(island, s, h))) return never;
  if (!((A.inverse() * change - f).norm() > kSlidesBack * most)) return never;
  // Where friction held against it in all of the position stage, the way tells it exactly.
  const bool known = -held.dot(u) > (1 - kAcross) * s.contact->friction * s.warm[0];
  const Vec2 rate = known ? Vec2(2 / h * (along(meanSlip(island, s, turn, h)) - speed * u))
                          : Vec2((change - A * (most * u + f)) / h);
  const double slows = -rate.dot(u), across = (rate + slows * u).norm();
  const double time = speed / (slows + across);
  return time > kSnap * h && time < (1 - kSnap) * h ? time : never;
}

/// of(Sliding) of all that has pressed and does so, and rubs.
template <class Of>
void forEachSliding(const Island& island, const RowValues& p, const Of& of) {
  forEachTouching(island, [&](const Contact& c, int row, const Body* body, int place) {
    if (!c.touches_at_start || !(c.friction > 0) || !(p[row] > 0)) return;
    const double* warm =
        body ? body->touching.warm.data() + place : island.pairs.touching.warm.data() + 3 * place;
    if (warm[0] > 0) of(Sliding{&c, body, row, Vec3(warm[0], warm[1], warm[2])});
  });
}

}  // namespace

double timeOfTurn(Island& island, const VelocitySolution& solution, double h) {
  const double never = 2 * h;
  if (!solution.impulses) return never;
  for (const Body* body : island.bodies)
    if (body->located >= kMaxLocated) return never;
  const RowValues& p = *solution.impulses;
  double first = never;
  Sliding turns;
  forEachSliding(island, p, [&](Sliding s) {
    const Vec3 turn = turnOf(island, island.s.turns, s);
    s.end = slipAtEnd(island, s, turn);
    const double time = timeOfTurn(island, p, s, slipAtStart(island, s, turn), turn, h);
    if (time >= first) return;
    first = time;
    turns = s;
  });
  if (!turns.contact || turns.contact->obstacle >= 0) return first;
  // Bodies that slide on each other turn together otherwise than at the end.
  const Vec3 end = turnOf(island, island.s.turns, turns);
  const Vec3 start = turnOf(island, findTurns(island, TurnOf::kStart, Held::kBeforeImpact), turns);
  return timeOfTurn(island, p, turns, slipAtStart(island, turns, start), 0.5 * (start + end), h);
}

}  // namespace ragdoll
