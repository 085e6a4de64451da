#include "core/direct/contact_log.h"

#include <algorithm>
#include <cmath>

#include "core/contact/detect.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/mode_rows.h"
#include "core/direct/spring.h"
#include "core/direct/velocity_solver.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using Kind = Schur::Row::Kind;

/// A contact without its impulse, as it stands at the state's positions.
ContactImpulse entryOf(const Model& model, const State& state, const Contact& c) {
  ContactImpulse e;
  e.ragdoll = c.ragdoll;
  e.obstacle = c.obstacle;
  e.other = c.other;
  const int own = c.count == 4 ? 2 : c.count;
  double radius = 0, along = 0;
  for (int k = 0; k < c.count; ++k) {
    const Vec3 x = state.x.col(c.particle[k]);
    along += c.weight[k] * c.normal.dot(x);
    if (k >= own) {
      e.other_particle[k - own] = c.particle[k];
      continue;
    }
    e.particle[k] = c.particle[k];
    e.point += c.weight[k] * x;
    radius += c.weight[k] * model.radius[c.particle[k]];
  }
  e.normal = c.normal;
  e.friction = c.friction;
  e.point -= radius * c.normal;
  e.depth = c.found - along;
  return e;
}

/// The contact's first body alone.
Contact ownOf(const Contact& c) {
  Contact own = c;
  own.count = c.count == 4 ? 2 : c.count;
  return own;
}

/// [m] of its surface, where its centre line is at `centre`.
Vec3 surfaceAt(const Model& model, const Contact& own, const Vec3& centre) {
  double radius = 0;
  for (int k = 0; k < own.count; ++k) radius += own.weight[k] * model.radius[own.particle[k]];
  return centre - radius * own.normal;
}

/// [m] where it was at the motion's start.
Vec3 pointBefore(const Island& island, const Contact& c) {
  const Contact own = ownOf(c);
  const Body& body = *island.bodies[island.placeOf(c.ragdoll)];
  Vec3 centre = Vec3::Zero();
  for (int k = 0; k < own.count; ++k)
    centre += own.weight[k] * body.saved.x.col(own.particle[k] - body.first);
  return surfaceAt(island.context.model, own, centre);
}

/// What the position stage gave to a contact along its rows, at the place of the motion's start.
void addPosition(const Island& island, const Contact& c, const Vec3& impulse) {
  const StepContext& step = island.context;
  ContactImpulse e = entryOf(step.model, step.state, c);
  e.point = pointBefore(island, c);
  e.impulse = impulse;
  e.approach = std::max(0.0, -openingRate(step, c));
  step.log->impulses.push_back(e);
}

/// [1/kg] that the rows of one body answer to a push along the first row of a pair.
double pairAnswer(const Island& island, int source) {
  double answer = 0;
  for (const Body* body : island.bodies) {
    const Schur& schur = body->memory->schur;
    for (int i = body->constraints.own_rows; i < schur.size(); ++i)
      if (schur.row(i).kind == Kind::kNormal && schur.row(i).source == source)
        answer += schur.matrix()(i, i);
  }
  return answer;
}

/// The impulse of a contact whose rows begin at `first` of the joint ones; nothing if it is zero.
bool takeImpulse(const Island& island, const RowValues& p, int first, double scale, Vec3& impulse) {
  const JointSchur& joint = island.s.joint;
  impulse = scale * p[first] * joint.row(first).direction;
  for (int i = first + 1; i < joint.size() && i < first + 3 && joint.row(i).kind == Kind::kTangent;
       ++i)
    impulse += scale * p[i] * joint.row(i).direction;
  return !impulse.isZero(0);
}

/// [s] that turn what the state has of a contact, half its force, into the impulse of a step.
double timeOfKept(const Model& model) { return 2 * model.solver.step; }

/// What pressed and has left since: where its particles are.
void addLeft(const Model& model, const State& state, const CachedImpulse& pressed,
             std::vector<ContactImpulse>& out) {
  if (pressed.a < 0 || pressed.impulse.isZero(0)) return;  // a limit's
  ContactImpulse e;
  e.ragdoll = pressed.ragdoll;
  e.particle = {pressed.a, pressed.b};
  e.obstacle = pressed.obstacle;
  e.other_particle = pressed.other;
  for (std::size_t i = 0; i < model.ragdolls.size() && pressed.other[0] >= 0; ++i) {
    const Ragdoll& r = model.ragdolls[i];
    const bool has =
        pressed.other[0] >= r.first && pressed.other[0] < r.first + model.skeletonOf(r).size();
    if (has && static_cast<int>(i) != e.ragdoll) e.other = static_cast<int>(i);
  }
  e.normal = pressed.impulse.normalized();
  const int b = pressed.b < 0 ? pressed.a : pressed.b;
  e.point = 0.5 * (state.x.col(pressed.a) + state.x.col(b)) -
            0.5 * (model.radius[pressed.a] + model.radius[b]) * e.normal;
  e.impulse = timeOfKept(model) * pressed.impulse;
  out.push_back(e);
}

/// What friction lacks of what is dragged along a line on which it cannot give way, as a rod by its
/// end: no impulse changes its motion, so that sweeps end before they find it, but what drags it
/// feels it all.
Vec3 lockedFriction(const StepContext& step, const Body& body, const Contact& c, int row,
                    const Vec3& impulse) {
  const Schur& schur = body.memory->schur;
  if (body.pinned->pins.empty() || row + 2 >= schur.size() ||
      schur.row(row + 1).kind != Kind::kTangent)
    return Vec3::Zero();
  const double normal = impulse.dot(c.normal);
  Vec3 slip = slipOf(step, c);
  const double speed = slip.norm();
  if (!(normal > 0) || !(speed > kLeastSlip)) return Vec3::Zero();
  slip /= speed;
  const double t1 = slip.dot(schur.row(row + 1).direction);
  const double t2 = slip.dot(schur.row(row + 2).direction);
  const auto A = schur.matrix();
  const double answer = t1 * t1 * A(row + 1, row + 1) + t2 * t2 * A(row + 2, row + 2) +
                        2 * t1 * t2 * A(row + 1, row + 2);
  if (answer * body.rows->mass.sum() > kLockedAnswer) return Vec3::Zero();
  return -(c.friction * normal + impulse.dot(slip)) * slip;
}

/// [m/s] at which the contact opened at the motion's start.
double rateBefore(const Island& island, const Contact& c) {
  Vec3 rate = Vec3::Zero();
  visitMoving(island, c,
              [&](int k, const Body& body, int i) { rate += c.weight[k] * body.saved.v.col(i); });
  return c.normal.dot(rate - c.surface_start / island.context.h);
}

/// How much larger than its part along the normal a force is: by its friction, which is as much of
/// it at the peak as in the mean, within the cone.
double withFriction(const Contact& c, const Vec3& impulse) {
  const double normal = impulse.dot(c.normal);
  return normal > 0 ? std::min(impulse.norm() / normal, std::hypot(1.0, c.friction)) : 1;
}

/// What a spring tells of a motion over h whose second half of the impulse e has.
void addSpring(const Island& island, const Contact& c, double answer, double h, ContactImpulse& e) {
  const StepContext& step = island.context;
  SpringMotion m;
  m.h = h;
  m.gap[0] = c.before;
  m.gap[1] = c.gapAt(step.state.x);
  m.rate[0] = rateBefore(island, c);
  m.rate[1] = openingRate(step, c);
  m.answer = answer;
  m.force = 2 * e.impulse.dot(c.normal) / h;
  e.peak = withFriction(c, e.impulse) * peakForce(c, m);
  if (c.before > -island.context.tolerances.touching) e.approach = std::max(0.0, -m.rate[0]);
}

ContactLog& logOf(const Island& island) { return *island.context.log; }

/// The two springs of a stick that lies on a face, told one after the other, press where both
/// together do, not each at its end.
void joinEnds(const Contact& c, std::vector<ContactImpulse>& entries, std::size_t first) {
  if (!c.isSoft() || c.count != 2 || entries.size() < first + 2) return;
  ContactImpulse &a = entries[entries.size() - 2], &b = entries.back();
  if (a.obstacle != b.obstacle || a.particle != b.particle || a.normal != b.normal) return;
  const double from_a = a.impulse.dot(a.normal), from_b = b.impulse.dot(b.normal);
  if (!(from_a > 0 && from_b > 0)) return;
  const double share = from_b / (from_a + from_b);
  a.point = b.point = Vec3(a.point + share * (b.point - a.point));
  a.depth = b.depth = a.depth + share * (b.depth - a.depth);
}

/// Two sticks that lie along each other, or one on a face, have two springs: together they press at
/// their peak.
void addPeaks(std::vector<ContactImpulse>& entries, std::size_t first) {
  for (std::size_t i = first; i + 1 < entries.size(); ++i) {
    ContactImpulse &a = entries[i], &b = entries[i + 1];
    if (a.obstacle != b.obstacle || a.other != b.other || a.ragdoll != b.ragdoll ||
        a.particle != b.particle || a.other_particle != b.other_particle)
      continue;
    a.peak += b.peak;
    b.peak = 0;
  }
}

}  // namespace

Vec3 pointOf(const Island& island, const Contact& c, const double* x) {
  const Contact own = ownOf(c);
  return surfaceAt(island.context.model, own, motionOf(island, own, x));
}

void logImpulse(const Island& island, const Contact& c, const LoggedImpact& impact, const double* x,
                const double* v) {
  const StepContext& step = island.context;
  ContactImpulse e = entryOf(step.model, step.state, c);
  e.point = pointOf(island, c, x) + impact.back;
  e.depth = c.found - c.normal.dot(motionOf(island, c, x));
  e.impulse = impact.impulse;
  e.approach = impact.approach;
  e.peak = withFriction(c, impact.impulse) * impact.peak;
  e.slip = tangentialPart(motionOf(island, c, v) - c.surface_end / step.h, c.normal).norm();
  e.effective_mass = impact.answer > 0 ? 1 / impact.answer : 0;
  e.normal = (c.normal + impact.turn).normalized();
  e.normal = turnedIntoCone(e);
  step.log->impulses.push_back(e);
}

Vec3 turnedIntoCone(const ContactImpulse& c) {
  const double normal = c.impulse.dot(c.normal), size = c.impulse.norm();
  if (!(size > 0) || tangentialPart(c.impulse, c.normal).norm() <= c.friction * normal)
    return c.normal;
  const Vec3 along = c.impulse / size, across = tangentialPart(c.normal, along);
  if (!(across.norm() > 0)) return along;
  return (along + c.friction * across.normalized()).normalized();
}

bool isLogged(const Island& island) { return island.context.log != nullptr; }

std::size_t logSize(const Island& island) {
  return isLogged(island) ? logOf(island).impulses.size() : 0;
}

void cutLog(Island& island, std::size_t size) {
  if (isLogged(island)) logOf(island).impulses.resize(size);
}

void logPositions(Island& island, double h, bool leapfrog) {
  const auto as_rows = [&](const Contact& c) { return leapfrog ? c.atStart() : c; };
  const IslandScratch& s = island.s;
  const std::size_t before = logSize(island);
  Vec3 impulse;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const Body& body = *island.bodies[k];
    const ConstraintSet& set = body.constraints;
    for (std::size_t i = 0; i < set.contacts.size() && i < set.row.size(); ++i) {
      const int row = set.row[i];
      if (row < 0 || row >= body.total.size()) continue;
      const int first = s.joint.firstOf(static_cast<int>(k)) + row;
      if (!takeImpulse(island, s.total, first, 1 / h, impulse)) continue;
      const Contact c = as_rows(set.contacts[i]);
      impulse += lockedFriction(island.context, body, c, row, impulse);
      addPosition(island, c, impulse);
      joinEnds(c, island.context.log->impulses, before);
    }
  }
  const PairSet& pairs = island.pairs;
  for (std::size_t i = 0; i < pairs.contacts.size() && i < pairs.row.size(); ++i) {
    if (pairs.row[i] < 0 || pairs.row[i] >= s.total.size()) continue;
    if (!takeImpulse(island, s.total, pairs.row[i], 1 / h, impulse)) continue;
    addPosition(island, as_rows(pairs.contacts[i]), impulse);
  }
}

void logVelocities(Island& island, const RowValues& p, const RowValues& rates,
                   const LoggedStage& at) {
  std::vector<ContactImpulse>& entries = logOf(island).impulses;
  const std::size_t begin = entries.size();
  forEachTouching(island, [&](const Contact& c, int first, const Body* body, int place) {
    Vec3 impulse;
    if (!takeImpulse(island, p, first, 1, impulse)) return;
    if (body) impulse += lockedFriction(island.context, *body, c, place, impulse);
    ContactImpulse e = entryOf(island.context.model, island.context.state, c);
    e.impulse = impulse;
    e.slip = slipOf(island.context, c).norm();
    if (at.impact) e.approach = std::max(0.0, -rates[first]);
    const double answer =
        body ? body->memory->schur.matrix()(place, place) : pairAnswer(island, place);
    e.effective_mass = answer > 0 ? 1 / answer : 0;
    if (c.isSoft()) addSpring(island, c, answer, at.h, e);
    entries.push_back(e);
    joinEnds(c, entries, begin);
  });
  addPeaks(entries, begin);
}

namespace {

/// Those of each body.
std::vector<std::vector<CachedImpulse>> byBody(const std::vector<CachedImpulse>& impulses,
                                               std::size_t bodies) {
  std::vector<std::vector<CachedImpulse>> parts(bodies);
  for (const CachedImpulse& impulse : impulses) parts[impulse.ragdoll].push_back(impulse);
  return parts;
}

/// Whether a contact of one body is among those that pressed on it.
bool hasPressed(const std::vector<CachedImpulse>& before, const CachedImpulse& key) {
  return std::any_of(before.begin(), before.end(),
                     [&](const CachedImpulse& c) { return isOfSame(c, key); });
}

/// Of bodies with each other; sleepers, too.
std::vector<Contact> nearEachOther(const Model& model, State state, PairDetector& detector) {
  std::vector<Contact> near;
  std::fill(state.asleep.begin(), state.asleep.end(), std::uint8_t(0));
  if (model.ragdoll_collision)
    detector.appendBetween(model, state, state.x, state.x, PairSearch::touches(kRestsWithin), near);
  return near;
}

/// [kg] that a push along a contact's normal meets, as a state alone tells it.
double effectiveMass(const Model& model, const State& state, const Contact& c) {
  const auto answerOf = [&](int ragdoll, int begin, int end) {
    const Ragdoll& r = model.ragdolls[ragdoll];
    BodyResponse response;
    response.bind(model.systemOf(r).direct);
    response.setStart(state.x.data() + 3 * r.first);
    Schur schur;
    schur.start(r.first);
    schur.addContact(c, 0, begin, end);
    response.assemble(schur, false);
    return schur.entry(0, 0);
  };
  const double answer = c.other < 0 ? answerOf(c.ragdoll, 0, c.count)
                                    : answerOf(c.ragdoll, 0, 2) + answerOf(c.other, 2, 4);
  return answer > 0 ? 1 / answer : 0;
}

/// What lies by one body, as a state alone tells it, but for other bodies.
void appendNear(const Model& model, const State& state, int ragdoll,
                const std::vector<SweptObstacle>& obstacles, PairDetector& detector,
                std::vector<Contact>& contacts) {
  const Ragdoll& body = model.ragdolls[ragdoll];
  const auto v = state.v.middleCols(body.first, model.skeletonOf(body).size());
  const double way = model.solver.step * std::sqrt(v.colwise().squaredNorm().maxCoeff());
  appendContacts(model, obstacles, state.x, state.x, ragdoll, kRestsWithin + way, contacts);
  if (model.self_collision)
    detector.appendSelf(model, state.x, state.x, ragdoll, PairSearch::touches(kRestsWithin),
                        contacts);
}

}  // namespace

void appendPressing(const Model& model, const State& state, const std::vector<std::uint8_t>& wanted,
                    std::vector<ContactImpulse>& out, const PressedBefore* before) {
  std::vector<SweptObstacle> obstacles;
  sweepObstacles(model, state, {}, obstacles);
  PairDetector detector;
  std::vector<Contact> contacts;
  const std::size_t count = model.ragdolls.size();
  std::vector<std::vector<Contact>> between(count);  // of each one's own
  for (const Contact& c : nearEachOther(model, state, detector)) between[c.ragdoll].push_back(c);
  const auto kept = byBody(state.impulses, count);
  const auto pressed_before =
      byBody(before ? before->impulses : std::vector<CachedImpulse>(), count);
  ImpulseCache cache;
  for (std::size_t i = 0; i < count; ++i) {
    if (!wanted[i]) continue;
    contacts.clear();
    appendNear(model, state, static_cast<int>(i), obstacles, detector, contacts);
    append(between[i], contacts);
    cache.clear();
    for (const CachedImpulse& impulse : kept[i]) cache.add(impulse);
    cache.startHandingOut();
    for (Contact& c : contacts) {
      const CachedImpulse* pressed = cache.handOut(c);
      // Of sleepers the state keeps what obstacles gave, not what they gave each other.
      if (!pressed && !cache.empty() && c.other < 0) continue;
      c.found = c.offset;
      ContactImpulse& entry = out.emplace_back(entryOf(model, state, c));
      if (pressed) {
        entry.impulse = timeOfKept(model) * pressed->impulse;
        entry.normal = turnedIntoCone(entry);
      }
      if (!before || (pressed && hasPressed(pressed_before[i], keyOf(c)))) continue;
      entry.approach = std::max(0.0, -c.normal.dot(c.of(before->v)));
      if (entry.approach > kImpactSpeed) entry.effective_mass = effectiveMass(model, state, c);
    }
    for (std::size_t k = 0; k < cache.impulses().size(); ++k)
      if (!cache.isHandedOut(k)) addLeft(model, state, cache.impulses()[k], out);
  }
}

}  // namespace ragdoll
