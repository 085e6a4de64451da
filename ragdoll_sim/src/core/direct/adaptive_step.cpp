#include "core/direct/adaptive_step.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/direct/angular_momentum.h"
#include "core/direct/begin_step.h"
#include "core/direct/constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/driving.h"
#include "core/direct/error_control.h"
#include "core/direct/motion.h"
#include "core/direct/moving_obstacles.h"
#include "core/direct/smooth_motion.h"
#include "core/direct/step_island.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using Impulses = std::vector<CachedImpulse>;

/// An island during a step that is taken in parts.
class StepParts {
 public:
  StepParts(const StepContext& whole, const std::vector<int>& bodies,
            const std::vector<int>& sleepers)
      : whole_(whole),
        s_(whole.ws.adaptive),
        part_{whole.model,  s_.inputs,   whole.h,  whole.force,    whole.guarded,
              false,        whole.state, whole.ws, whole.supports, whole.log,
              whole.worker, &s_.before,  whole.h},
        island_(part_, scratchOf(part_).island),
        bodies_(bodies),
        sleepers_(sleepers) {
    part_.tolerances = tolerancesWithin(whole.model.solver.tolerance * whole.h);
    makeRoom(whole.model, s_.coarse);
    s_.inputs = whole.inputs;
    s_.obstacles = whole.state.obstacles;
    s_.pins.clear();
    for (std::size_t p = 0; p < whole.inputs.pins.size(); ++p)
      s_.pins.push_back(whole.state.x.col(whole.model.pins[p].particle));
    s_.before = whole.state.impulses;
  }

  /// Obstacles as they were, for the islands that follow.
  void end() {
    if (!whole_.inputs.obstacles.empty()) whole_.state.obstacles = s_.obstacles;
    sweepObstacles(whole_.model, whole_.state, whole_.inputs.obstacles, whole_.ws.obstacles);
  }

  /// What a part begins with; and back to it.
  void save();
  void restore();
  /// What a part pressed with is what the next one begins with.
  void keep() { std::swap(s_.before, s_.after); }

  /// By rk without contact, error: what it made [m]. False: not in this way, and nothing is moved.
  bool takeFreely(double from, double part, double& error, StepReport& report);
  /// By rk from event to event, in pieces that follow their own errors; error: of all [m]. False:
  /// it is handed over, and nothing is moved.
  bool takeThroughEvents(double from, double part, double& error, StepReport& report);
  /// As it comes; allowed: [m] that its error may be. Returns that [m].
  double take(double from, double part, double allowed, StepReport& report);

  double& next() const {
    const Ragdoll& r = whole_.model.ragdolls[bodies_[0]];
    const StickRows& rows = *whole_.model.systemOf(r).direct.rows;
    return whole_.state.multipliers[whole_.ws.first_multiplier[bodies_[0]] + 2 * rows.s];
  }

 private:
  void saveIn(std::vector<SavedMotion>& saved) const;
  /// Where pins and obstacles are at both ends of a part.
  void lead(double from, double part);
  /// Makes ready for a part, from what pressed before it. events: whether it may go through them.
  void begin(double from, double part, const Impulses& before, bool events);
  /// after <- what presses at its end.
  void keepPressed(Impulses& after) const;
  /// From what pressed before it to what does so at its end; returns its defect [m].
  double takeOnce(double from, double part, const Impulses& before, Impulses& after,
                  StepReport& report);
  /// Instead of what it came to in one; returns the halves' error [m]. Where the motion is smooth
  /// it is taken out of them.
  double takeHalves(double from, double part, double allowed, StepReport& report);
  /// Whether nothing but the same limits pressed as before, in one and at each end.
  bool isSmooth(const StepReport& part, std::initializer_list<const Impulses*> ends) const;
  /// Whether springs are near, of contact that gives way or of limits.
  bool hasSprings() const;
  /// [m/s] What velocities have changed by, but for gravity.
  double kick(double part) const;
  /// Extrapolates the halves and what came in one to fourth order, and back onto the sticks.
  void refine();
  /// [m] of positions, or [m/s] of velocities.
  double distanceFromCoarse(bool velocities) const;

  const StepContext& whole_;
  AdaptiveScratch& s_;
  StepContext part_;  ///< in which the present part is taken
  Island island_;
  const std::vector<int>&bodies_, &sleepers_;
};

void StepParts::lead(double from, double part) {
  const double start = from / whole_.h, end = std::min(1.0, (from + part) / whole_.h);
  for (std::size_t p = 0; p < s_.pins.size(); ++p)
    s_.inputs.pins[p] = s_.pins[p] + end * (whole_.inputs.pins[p] - s_.pins[p]);
  if (whole_.inputs.obstacles.empty()) return;
  for (std::size_t k = 0; k < s_.obstacles.size(); ++k) {
    const Pose& target = whole_.inputs.obstacles[k];
    whole_.state.obstacles[k] = between(s_.obstacles[k], target, start);
    s_.inputs.obstacles[k] = between(s_.obstacles[k], target, end);
  }
  sweepObstacles(whole_.model, whole_.state, s_.inputs.obstacles, whole_.ws.obstacles);
}

void StepParts::saveIn(std::vector<SavedMotion>& saved) const {
  makeRoom(whole_.model, saved);
  for (const int i : bodies_) ragdoll::save(whole_, i, saved[i]);
}

void StepParts::save() {
  saveIn(s_.start);
  s_.logged = whole_.log ? whole_.log->impulses.size() : 0;
}

void StepParts::restore() {
  for (const int i : bodies_) ragdoll::restore(whole_, i, s_.start[i]);
  if (whole_.log) whole_.log->impulses.resize(s_.logged);
}

double StepParts::distanceFromCoarse(bool velocities) const {
  const Points& fine = velocities ? whole_.state.v : whole_.state.x;
  double square = 0;
  for (const int i : bodies_) {
    const Points& coarse = velocities ? s_.coarse[i].v : s_.coarse[i].x;
    const int first = whole_.model.ragdolls[i].first;
    for (int k = 0; k < coarse.cols(); ++k)
      square = std::max(square, (fine.col(first + k) - coarse.col(k)).squaredNorm());
  }
  const double distance = std::sqrt(square);
  return std::isfinite(distance) ? distance : kUnknownRate;
}

bool StepParts::isSmooth(const StepReport& part,
                         std::initializer_list<const Impulses*> ends) const {
  const auto same = [](const CachedImpulse& a, const CachedImpulse& b) {
    return a.a < 0 && a.a == b.a && a.b == b.b && a.ragdoll == b.ragdoll;
  };
  const auto press = [&](const Impulses* now) {
    return std::equal(now->begin(), now->end(), s_.before.begin(), s_.before.end(), same);
  };
  return part.substeps == 1 && part.guarded == 0 && part.limited == 0 &&
         std::all_of(ends.begin(), ends.end(), press);
}

bool StepParts::hasSprings() const {
  const auto isSoft = [](const auto& spring) { return spring.isSoft(); };
  const auto& pairs = island_.pairs.contacts;
  return std::any_of(pairs.begin(), pairs.end(), isSoft) ||
         std::any_of(island_.bodies.begin(), island_.bodies.end(), [&](const Body* body) {
           const ConstraintSet& set = body->constraints;
           return std::any_of(set.contacts.begin(), set.contacts.end(), isSoft) ||
                  std::any_of(set.limits.begin(), set.limits.end(), isSoft);
         });
}

double StepParts::kick(double part) const {
  double most = 0;
  for (const int i : bodies_) {
    const SavedMotion& start = s_.start[i];
    const int first = whole_.model.ragdolls[i].first;
    const Vec3 fallen = part * whole_.model.gravity;
    for (int k = 0; k < start.v.cols(); ++k)
      most =
          std::max(most, (whole_.state.v.col(first + k) - start.v.col(k) - fallen).squaredNorm());
  }
  return std::sqrt(most);
}

void StepParts::refine() {
  const double share = 1 / kDoubling;
  for (Body* body : island_.bodies) {
    const SavedMotion& coarse = s_.coarse[body->index];
    body->motion.dx = share * (body->x() - coarse.x);
    if (!satisfySticksAlongNew(*body)) continue;
    const Vec3 angular = angularMomentumAt(*body, body->x(), body->v());  // of steps, exact
    body->x() += body->motion.dx;
    body->v() += share * (body->v() - coarse.v);
    BodyResponse& response = body->memory->response;
    response.setEnd(body->xData());
    response.projectAtEnd(body->vData());
    // A spin would change the rates of what an impact at the end has left touching.
    if (body->touching.contacts.empty() && island_.pairs.touching.contacts.empty())
      restoreInFlight(*body, angular, 0);
  }
}

void StepParts::begin(double from, double part, const Impulses& before, bool events) {
  lead(from, part);
  part_.h = part;
  part_.events = events;
  part_.before = &before;
  bindIsland(island_, bodies_, sleepers_);
  island_.s.defect = 0;
}

bool StepParts::takeFreely(double from, double part, double& error, StepReport& report) {
  begin(from, part, s_.before, whole_.events);
  if (!island_.isLone()) return false;
  beginStep(island_, report);
  if (!moveFreely(island_, part, error)) {
    restore();
    return false;
  }
  s_.after.clear();
  return true;
}

bool StepParts::takeThroughEvents(double from, double part, double& error, StepReport& report) {
  StepReport through;
  begin(from, part, s_.before, true);
  const bool taken = stepThroughEvents(island_, error, through);
  if (taken) {
    keepPressed(s_.after);
    report += through;
  } else {
    restore();
  }
  return taken;
}

void StepParts::keepPressed(Impulses& after) const {
  after.clear();
  for (const Body* body : island_.bodies) append(body->cache.impulses(), after);
  append(island_.pairs.cache.impulses(), after);
}

double StepParts::takeOnce(double from, double part, const Impulses& before, Impulses& after,
                           StepReport& report) {
  begin(from, part, before, false);
  stepIsland(island_, report);
  keepPressed(after);
  return island_.s.defect;
}

double StepParts::takeHalves(double from, double part, double allowed, StepReport& report) {
  saveIn(s_.coarse);
  restore();
  const double half = 0.5 * part;
  takeOnce(from, half, s_.before, s_.middle, report);
  takeOnce(from + half, half, s_.middle, s_.after, report);
  const double distance = distanceFromCoarse(false), error = distance / kDoubling;
  // What hits at the part's very end does so in one of the two: they are alike but for velocities.
  const double parting = part * distanceFromCoarse(true);
  if (parting > kStruckAtEnd * std::max(distance, allowed)) return std::max(error, parting);
  if (isSmooth(report, {&s_.middle, &s_.after})) refine();
  return error;
}

double StepParts::take(double from, double part, double allowed, StepReport& report) {
  StepReport once;
  const double error = kOfDefect * takeOnce(from, part, s_.before, s_.after, once);
  const bool guarded = once.guarded > 0, known = !guarded && error < kUnknownRate;
  const bool smooth = isSmooth(once, {&s_.after});
  // Whether parts that aim at what is allowed are longer than the least of second order.
  const double least = kLongPart * whole_.h;
  const bool long_enough = kAim * allowed * part * part > error * least * least;
  const bool stands = !hasSprings() && (!smooth || long_enough);
  // rk's motions have no defect, and a spring's force may come and go between the ends that the
  // defect sees: their halves tell. Where the guard acts, shorter parts are cheaper than its
  // substeps.
  if (known ? stands : guarded) {
    report += once;
    return known ? error : kUnknownRate;
  }
  report.substeps = once.substeps;
  const double halved = takeHalves(from, part, allowed, report);
  // A spring that is reached within the part is so in both solutions at one time: they agree about
  // all that follows.
  const bool reached = once.substeps > 1 && hasSprings();
  return reached ? std::max(halved, kOfKick * part * kick(part)) : halved;
}

/// Of so many bodies, though it was counted in every part.
StepReport atMost(int bodies, StepReport report) {
  for (int* count : {&report.guarded, &report.limited, &report.joining, &report.unresolved})
    *count = std::min(*count, bodies);
  return report;
}

}  // namespace

void stepWithinTolerance(const StepContext& context, const std::vector<int>& bodies,
                         const std::vector<int>& sleepers, StepReport& report) {
  const SolverSpec& solver = context.model.solver;
  StepParts parts(context, bodies, sleepers);
  ErrorControl control(context.h, solver.tolerance, parts.next());
  StepReport stood;
  const auto stand = [&](const StepReport& part) {
    parts.keep();
    stood.contacts = 0;  // those of the last one are told
    stood += part;
  };
  const int size = static_cast<int>(bodies.size());
  bool events = context.events;
  while (!control.done()) {
    StepReport part;
    double error = 0;
    parts.save();
    const bool free = solver.method == Method::kRk &&
                      parts.takeFreely(control.from(), control.part(), error, part);
    if (!free && events) {
      events = parts.takeThroughEvents(control.from(), control.left(), error, part);
      if (events) {
        control.takeRest(error);
        stand(part);
        break;
      }
      stood.handed_over += size;
    }
    if (!free)
      error = parts.take(control.from(), control.part(), control.allowed(kOrderOfShake), part);
    if (control.accepts(error, free ? kOrderOfRk : kOrderOfShake))
      stand(part);
    else
      parts.restore();
  }
  report += atMost(size, stood);
  control.tell(size, report);
  parts.end();
}

}  // namespace ragdoll
