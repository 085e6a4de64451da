#include "core/direct/adaptive_step.h"

#include <algorithm>
#include <cmath>

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
      : whole_(whole), s_(whole.ws.adaptive), bodies_(bodies), sleepers_(sleepers) {
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
  /// As it comes, in two halves unless the step guard acts; returns the error that it made [m].
  double takeTwice(double from, double part, StepReport& report);

  double& next() const {
    const Ragdoll& r = whole_.model.ragdolls[bodies_[0]];
    const StickRows& rows = *whole_.model.systemOf(r).direct.rows;
    return whole_.state.multipliers[whole_.ws.first_multiplier[bodies_[0]] + 2 * rows.s];
  }

 private:
  StepContext contextOf(double part, const Impulses& before) const {
    StepContext context{whole_.model,  s_.inputs,    part,      whole_.force,    whole_.guarded,
                        false,         whole_.state, whole_.ws, whole_.supports, whole_.log,
                        whole_.worker, &before,      whole_.h};
    // Whatever its length: the two halves do not tell what else would follow if what counts as
    // touching were still open.
    context.tolerances = tolerancesFor(0);
    return context;
  }
  void saveIn(std::vector<SavedMotion>& saved) const;
  /// Where pins and obstacles are at both ends of a part.
  void lead(double from, double part);
  /// One part: as it comes, from what pressed before it to what does so at its end. second: of the
  /// two halves; their error is then known, and taken out where the motion is smooth.
  void take(double from, double part, const Impulses& before, Impulses& after, StepReport& report,
            bool second = false);
  /// Whether nothing but the same limits pressed, in one and in halves.
  bool isSmooth(const StepReport& part) const;
  /// Extrapolates the halves and what came in one to fourth order, and back onto the sticks.
  void refine(Island& island);
  /// [m]; swing: [s] in which a velocity's error becomes one of positions.
  double distanceFromCoarse(double swing) const;

  const StepContext& whole_;
  AdaptiveScratch& s_;
  const std::vector<int>&bodies_, &sleepers_;
  double error_ = 0;  ///< [m] of the last two halves
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

double StepParts::distanceFromCoarse(double swing) const {
  const State& state = whole_.state;
  double x = 0, v = 0;
  for (const int i : bodies_) {
    const SavedMotion& coarse = s_.coarse[i];
    const int first = whole_.model.ragdolls[i].first;
    for (int k = 0; k < coarse.x.cols(); ++k) {
      x = std::max(x, (state.x.col(first + k) - coarse.x.col(k)).squaredNorm());
      v = std::max(v, (state.v.col(first + k) - coarse.v.col(k)).squaredNorm());
    }
  }
  const double distance = std::max(std::sqrt(x), swing * std::sqrt(v));
  return std::isfinite(distance) ? distance : kUnknownRate;
}

bool StepParts::isSmooth(const StepReport& part) const {
  const auto same = [](const CachedImpulse& a, const CachedImpulse& b) {
    return a.a < 0 && a.a == b.a && a.b == b.b && a.ragdoll == b.ragdoll;
  };
  const auto press = [&](const Impulses& now) {
    return std::equal(now.begin(), now.end(), s_.before.begin(), s_.before.end(), same);
  };
  return part.substeps == 1 && part.guarded == 0 && part.limited == 0 && press(s_.once) &&
         press(s_.middle) && press(s_.after);
}

void StepParts::refine(Island& island) {
  for (Body* body : island.bodies) {
    const double share = 1 / kDoubling;
    const SavedMotion& coarse = s_.coarse[body->index];
    body->motion.dx = share * (body->x() - coarse.x);
    if (!satisfySticksAlongNew(*body)) continue;
    body->x() += body->motion.dx;
    body->v() += share * (body->v() - coarse.v);
    BodyResponse& response = body->memory->response;
    response.setEnd(body->xData());
    response.projectAtEnd(body->vData());
  }
}

void StepParts::take(double from, double part, const Impulses& before, Impulses& after,
                     StepReport& report, bool second) {
  lead(from, part);
  const StepContext context = contextOf(part, before);
  Island island(context, scratchOf(context).island);
  bindIsland(island, bodies_, sleepers_);
  stepIsland(island, report);
  after.clear();
  for (const Body* body : island.bodies) append(body->cache.impulses(), after);
  append(island.pairs.cache.impulses(), after);
  if (!second) return;
  const bool smooth = isSmooth(report);
  error_ = (smooth ? distanceFromCoarse(kSwingTime) : kOfJumps * distanceFromCoarse(0)) / kDoubling;
  if (smooth) refine(island);
}

bool StepParts::takeFreely(double from, double part, double& error, StepReport& report) {
  lead(from, part);
  const StepContext context = contextOf(part, s_.before);
  Island island(context, scratchOf(context).island);
  bindIsland(island, bodies_, sleepers_);
  if (!island.isLone()) return false;
  beginStep(island, report);
  if (!moveFreely(island, part, error)) {
    restore();
    return false;
  }
  s_.after.clear();
  return true;
}

double StepParts::takeTwice(double from, double part, StepReport& report) {
  StepReport once;
  take(from, part, s_.before, s_.once, once);
  if (once.guarded > 0) {  // in the substeps that the halves would take: the two would agree
    report += once;
    return kUnknownRate;
  }
  saveIn(s_.coarse);
  restore();
  const double half = 0.5 * part;
  take(from, half, s_.before, s_.middle, report);
  report.substeps = std::max(report.substeps, once.substeps);
  take(from + half, half, s_.middle, s_.after, report, true);
  return error_;
}

}  // namespace

void stepWithinTolerance(const StepContext& context, const std::vector<int>& bodies,
                         const std::vector<int>& sleepers, StepReport& report) {
  const SolverSpec& solver = context.model.solver;
  StepParts parts(context, bodies, sleepers);
  ErrorControl control(context.h, solver.tolerance, parts.next());
  StepReport stood;
  while (!control.done()) {
    StepReport part;
    double error = 0;
    parts.save();
    const bool free = solver.method == Method::kRk &&
                      parts.takeFreely(control.from(), control.part(), error, part);
    if (!free) error = parts.takeTwice(control.from(), control.part(), part);
    if (control.accepts(error, free ? kOrderOfRk : kOrderOfShake)) {
      parts.keep();
      stood.contacts = 0;  // those of the last one are told
      stood += part;
    } else {
      parts.restore();
    }
  }
  const int size = static_cast<int>(bodies.size());
  for (int* count : {&stood.guarded, &stood.limited, &stood.joining, &stood.unresolved})
    *count = std::min(*count, size);
  report += stood;
  control.tell(size, report);
  parts.end();
}

}  // namespace ragdoll
