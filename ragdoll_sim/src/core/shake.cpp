#include "ragdoll_sim/core/shake.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/detect.h"
#include "ragdoll_sim/core/joint_damping.h"
#include "ragdoll_sim/core/workspace.h"

namespace ragdoll {
namespace {

constexpr double kStable = 1.0;       ///< h sqrt(Omega2) of a substep; 2 is the edge of stability
constexpr int kMaxSubsteps = 16;      ///< above, one implicit step is cheaper
constexpr int kMaxImplicit = 60;      ///< Newton iterations of an implicit step
constexpr int kMaxNewton = 25;        ///< iterations; 2 to 4 are usual
constexpr double kTolerance = 1e-10;  ///< relative error of a stick's squared length
constexpr int kMaxRounds = 6;         ///< of contacts and sticks in turn
constexpr double kContactMargin = 0.02;     ///< [m]
constexpr double kLimitMargin = 0.3;        ///< [rad]
constexpr double kContactTolerance = 1e-6;  ///< [m]
constexpr double kBounceSteps = 4;          ///< bounce only above an approach speed of 4 g h
constexpr int kMaxBounces = 4;              ///< in one step; later ones do not bounce
constexpr double kRedoRise = 1e-3;  ///< of the kinetic energy (1 J at least): done again at half
constexpr double kReportedRise = 1e-6;  ///< [J] less is rounding
constexpr int kMaxSearches = 3;         ///< for contacts that others push the body into
constexpr int kAffineEvery = 256;       ///< [steps] rigid groups are put back into affine shape

/// One body during one step.
class ShakeStep {
  auto x() { return state_.x.middleCols(ragdoll_.first, n_); }
  auto v() { return state_.v.middleCols(ragdoll_.first, n_); }
  double* xData() { return state_.x.data() + 3 * ragdoll_.first; }
  double* vData() { return state_.v.data() + 3 * ragdoll_.first; }
  double* multipliers() { return state_.multipliers.data() + ws_.first_stick[index_]; }

 public:
  ShakeStep(const Model& model, Workspace::Impl& ws, State& state, int ragdoll, StepReport& report)
      : model_(model),
        ws_(ws),
        scratch_(ws.shake),
        state_(state),
        report_(report),
        index_(ragdoll),
        ragdoll_(model.ragdolls[ragdoll]),
        system_(model.systemOf(ragdoll_).direct),
        rows_(*system_.rows),
        body_(ws.bodies[ragdoll]),
        n_(rows_.n) {
    body_.start.resize(rows_);
    body_.end.resize(rows_);
  }

  void run(const Inputs& inputs, double h) {
    step_ = h;
    if (state_.step % kAffineEvery == 0) makeAffine();
    movePins(inputs, h);
    driven_ = !inputs.pins.empty() || obstaclesMove(inputs);
    scratch_.acceleration.noalias() = model_.gravity * system_.gravity;
    if (ws_.forced)
      scratch_.acceleration.noalias() += ws_.force.middleCols(ragdoll_.first, n_) * system_.W;
    if (model_.solver.damping > 0) v() *= std::exp(-model_.solver.damping * h);
    scratch_.touching.clear();
    scratch_.touching_limits.clear();
    if (model_.solver.joint_damping > 0)
      dampInnerMotion(model_.skeletonOf(ragdoll_).M, model_.systemOf(ragdoll_).pins,
                      std::exp(-model_.solver.joint_damping * h), x(), v());
    scratch_.presses.clear();
    for (const Press& last : state_.presses)
      if (last.ragdoll == index_ && last.other[0] < ragdoll_.first + n_)  // not on another body
        scratch_.presses.push_back(last);
    guard(h);
    for (const Press& press : scratch_.presses)
      if (press.obstacle >= 0) ws_.pressed[index_] = 1;
    ws_.presses.insert(ws_.presses.end(), scratch_.presses.begin(), scratch_.presses.end());
  }

  /// Velocity stage once more, at the step's end: what touches there is known.
  void settle(double h, const std::vector<Contact>& touching, const std::vector<LimitRow>& limits) {
    step_ = h;
    scratch_.touching = touching;
    scratch_.touching_limits = limits;
    std::size_t rows = limits.size();
    for (const Contact& c : touching) rows += c.friction > 0 ? 3 : 1;
    scratch_.warm.assign(rows, 0.0);
    pushVelocities(body_.start, false);
  }

 private:
  /// The step guard. Explicit steps are stable while h sqrt(Omega2) < 2, Omega2 the largest
  /// eigenvalue of the tension's stiffness (docs/equations.md#guard): substeps keep it below
  /// kStable, a substep that fails or whose tension outgrew it is done again at half, and what
  /// would take more than kMaxSubsteps goes to one implicit step, which no tension can make
  /// unstable.
  void guard(double h) {
    int count = std::max(1, static_cast<int>(std::ceil(h * std::sqrt(stiffness()) / kStable)));
    int taken = 0;
    double left = h;
    bool implicit = count > kMaxSubsteps;
    double sub = implicit ? h : h / count;
    while (left > 1e-9 * h) {
      sub = std::min(sub, left);
      save();
      failed_ = false;
      double took = 0;
      if (implicit) {
        took = implicitStep(sub);
      } else {
        took = model_.solver.method == Method::kRk ? advanceSmooth(sub, taken)
                                                   : advance(sub, taken < kMaxBounces);
        const bool outgrown = sub * std::sqrt(stiffness()) > 2 * kStable && sub > h / kMaxSubsteps;
        if (failed_ || outgrown || !v().allFinite()) {
          restore();
          sub *= 0.5;
          if (sub < 0.99 * h / kMaxSubsteps) {
            implicit = true;
            sub = left;
          }
          continue;
        }
        const double rise = energyRise();
        if (rise > kRedoRise * std::max(1.0, kineticEnergy()) && sub > 1.01 * h / kMaxSubsteps) {
          restore();
          sub *= 0.5;
          continue;
        }
        if (rise > 0) limitEnergy(rise);
      }
      left -= took;
      ++taken;
    }
    report_.substeps = std::max(report_.substeps, taken);
    report_.guarded += implicit || taken > 1;
    report_.limited += limited_;
  }

  double kineticEnergy() {
    const Eigen::MatrixXd& M = model_.skeletonOf(ragdoll_).M;
    return 0.5 * (v() * M).cwiseProduct(v()).sum();
  }

  /// [J] by how much a motion with contact gained more than gravity, pokes and moving things gave
  /// it: an error of the contact solution, since contact only takes. 0 where nothing pressed.
  double energyRise() {
    if (driven_ || scratch_.presses.empty()) return 0;
    const Eigen::MatrixXd& M = model_.skeletonOf(ragdoll_).M;
    const Points moved = x() - scratch_.saved_x;
    double rise = kineticEnergy() -
                  0.5 * (scratch_.saved_v * M).cwiseProduct(scratch_.saved_v).sum() -
                  model_.gravity.dot((moved * M).rowwise().sum());
    if (ws_.forced) rise -= ws_.force.middleCols(ragdoll_.first, n_).cwiseProduct(moved).sum();
    return rise;
  }

  /// Takes the rise out of the motion within the body, which leaves its momentum; out of the whole
  /// motion only where that is not enough and a contact pressed.
  void limitEnergy(double rise) {
    const double before = kineticEnergy();
    scratch_.saved_v = v();
    dampInnerMotion(model_.skeletonOf(ragdoll_).M, model_.systemOf(ragdoll_).pins, 0, x(), v());
    const double rigid = kineticEnergy();
    const double inner = before - rigid;
    if (inner > rise) {
      v() += std::sqrt(1 - rise / inner) * (scratch_.saved_v - v());
    } else if (ws_.obstacles.empty()) {
      // v() is the rigid motion now: there is nothing more to take.
    } else {
      v() *= rigid > 0 ? std::sqrt(std::max(0.0, (before - rise) / rigid)) : 0;
    }
    limited_ = limited_ || rise > kReportedRise;
  }

  /// Omega2 [1/s^2], a bound: largest row sum of |G| |2 m|, m the multipliers of the last motion.
  double stiffness() {
    const double* m = multipliers();
    scratch_.residual.setZero(rows_.width);
    for (int s = 0; s < rows_.s; ++s) scratch_.residual[s] = 2 * std::abs(m[s]);
    double worst = 0;
    for (int s = 0; s < rows_.s; ++s) {
      const double* g = rows_.G.data() + s * rows_.width;
      double sum = 0;
      for (int t = 0; t < rows_.s; ++t) sum += std::abs(g[t]) * scratch_.residual[t];
      worst = std::max(worst, sum);
    }
    return worst;
  }

  void save() {
    scratch_.saved_x = x();
    scratch_.saved_v = v();
    scratch_.saved_multipliers.assign(multipliers(), multipliers() + 2 * rows_.s);
  }

  void restore() {
    x() = scratch_.saved_x;
    v() = scratch_.saved_v;
    std::copy(scratch_.saved_multipliers.begin(), scratch_.saved_multipliers.end(), multipliers());
  }

  /// Backward Euler: the free motion, then Newton along the NEW stick directions. First order and
  /// dissipative; finite whatever the tension.
  double implicitStep(double h) {
    ++report_.implicit;
    scratch_.dx = h * v() + (h * h) * scratch_.acceleration;
    scratch_.lambda.setZero(rows_.width);
    body_.start.setPose(rows_, xData());
    relaxAlongNew();
    findConstraints(h);
    press(h, false);
    finish(h, false);
    for (int s = 0; s < rows_.s; ++s)
      multipliers()[s] = multipliers()[s + rows_.s] = scratch_.lambda[s] / (h * h);
    return h;
  }

  bool relaxAlongNew() {
    for (int iteration = 0; iteration < kMaxImplicit; ++iteration) {
      ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
      body_.end.setPose(rows_, ws_.x1.data() + 3 * ragdoll_.first);
      const Eigen::Map<const PaddedRows> D(body_.end.D(), 3, rows_.width);
      double worst = 0;
      scratch_.residual.setZero(rows_.width);
      for (int s = 0; s < rows_.s; ++s) {
        // (L / |d| - 1) |d|^2: the length itself, not its square, so that far sticks come in
        // evenly.
        const double q = std::max(D.col(s).squaredNorm(), kMinLength * kMinLength);
        scratch_.residual[s] = std::sqrt(rows_.length2[s] * q) - q;
        worst = std::max(worst, std::abs(rows_.length2[s] - q) / rows_.length2[s]);
      }
      if (worst < kTolerance) return true;
      body_.end.solve(rows_, scratch_.residual.data());
      scratch_.lambda += scratch_.residual;
      body_.end.move(rows_, scratch_.residual.data(), 1, scratch_.dx.data());
    }
    ++report_.unresolved;
    return false;
  }

  void makeAffine() {
    x() = (x() * system_.affine.transpose()).eval();
    v() = (v() * system_.affine.transpose()).eval();
  }

  bool obstaclesMove(const Inputs& inputs) const {
    for (std::size_t k = 0; k < inputs.obstacles.size(); ++k)
      if (inputs.obstacles[k].position != state_.obstacles[k].position ||
          inputs.obstacles[k].orientation.coeffs() != state_.obstacles[k].orientation.coeffs())
        return true;
    return false;
  }

  /// Pinned particles move evenly to their targets and carry what is rigid with them.
  void movePins(const Inputs& inputs, double h) {
    if (inputs.pins.empty()) return;
    const std::vector<int>& pins = model_.systemOf(ragdoll_).pins;
    for (std::size_t p = 0; p < inputs.pins.size(); ++p) {
      const Pin& pin = model_.pins[p];
      if (pin.ragdoll != index_) continue;
      const auto row =
          std::find(pins.begin(), pins.end(), pin.particle - ragdoll_.first) - pins.begin();
      const Vec3 speed = (inputs.pins[p] - state_.x.col(pin.particle)) / h;
      v() += (speed - state_.v.col(pin.particle)) * system_.pin_motion.row(row);
    }
  }

  /// Moves the body by `h` or to its first bounce, whichever comes first; returns the time it took.
  double advance(double h, bool may_bounce) {
    body_.start.setPose(rows_, xData());
    freeMotion(h);
    findConstraints(h);
    if (may_bounce) {
      const double until = firstBounce(h);
      if (until < h) {
        if (until > 0) {
          freeMotion(until);
          press(until);
          finish(until, true, true);
        } else {
          bounce();
        }
        return std::max(until, 1e-6 * h);
      }
    }
    press(h);
    finish(h);
    return h;
  }

  /// As advance, by Dormand-Prince 5 where nothing touches.
  double advanceSmooth(double h, int taken) {
    double* m = multipliers();
    rungeKutta(rows_, body_.end, xData(), vData(), scratch_.acceleration, h, scratch_.stages,
               scratch_.dx, scratch_.v1, m);
    for (int s = 0; s < rows_.s; ++s) m[s] = m[s + rows_.s] = 0.5 * m[s];  // per h^2 of x, not of v
    body_.start.setPose(rows_, xData());
    scratch_.lambda.setZero(rows_.width);
    if (!satisfySticks()) failed_ = true;
    findConstraints(h);
    bool free = true;
    for (const Contact& c : scratch_.contacts)
      free = free && gapAt(c, scratch_.dx.data()) > kTouching && c.gap_start > kTouching;
    for (const LimitRow& l : scratch_.limits) free = free && l.value > 0;
    if (!free) return advance(h, taken < kMaxBounces);
    scratch_.presses.clear();
    x() += scratch_.dx;
    v() = scratch_.v1;
    body_.end.setPose(rows_, xData());
    body_.end.projectVelocities(rows_, vData());
    std::swap(body_.start, body_.end);
    return h;
  }

  /// dx and the sticks' multipliers over h, without contacts.
  void freeMotion(double h) {
    scratch_.dx = h * v() + (0.5 * h * h) * scratch_.acceleration;
    scratch_.lambda.setZero(rows_.width);
    double* warm = multipliers();     // per h^2: of the last motion,
    double* before = warm + rows_.s;  // and of the one before it; extrapolated to this one
    for (int s = 0; s < rows_.s; ++s) scratch_.lambda[s] = (2 * warm[s] - before[s]) * h * h;
    body_.start.move(rows_, scratch_.lambda.data(), 1, scratch_.dx.data());
    if (!satisfySticks()) failed_ = true;
    for (int s = 0; s < rows_.s; ++s) {
      before[s] = warm[s];
      warm[s] = scratch_.lambda[s] / (h * h);
    }
  }

  /// Newton along the old directions until every stick has its length.
  bool satisfySticks() {
    scratch_.D1.resize(3, rows_.width);
    scratch_.residual.setZero(rows_.width);
    const Eigen::Map<const PaddedRows> D0(body_.start.D(), 3, rows_.width);
    for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
      kernels::multiplyPoints(scratch_.dx.data(), rows_.BT.data(), n_, rows_.width,
                              scratch_.D1.data());
      scratch_.D1 += D0;
      const double worst = kernels::lengthResiduals(scratch_.D1.data(), rows_.length2.data(),
                                                    rows_.width, scratch_.residual.data());
      if (worst < kTolerance) return true;
      if (!(worst < 1e6)) return false;
      body_.start.solve(rows_, scratch_.residual.data());
      scratch_.lambda += scratch_.residual;
      body_.start.move(rows_, scratch_.residual.data(), 1, scratch_.dx.data());
    }
    return false;
  }

  void findConstraints(double h) {
    scratch_.contacts.clear();
    scratch_.limits.clear();
    if (ws_.obstacles.empty() && model_.skeletonOf(ragdoll_).joints.empty() &&
        !model_.self_collision)
      return;
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    if (!ws_.obstacles.empty())
      appendContacts(model_, ws_.obstacles, state_.x, ws_.x1, index_, kContactMargin,
                     scratch_.contacts);
    if (model_.self_collision)
      ws_.pairs.appendSelf(model_, state_.x, ws_.x1, index_, kContactMargin, scratch_.contacts);
    // An overlap found at the start opens at a bounded speed, so that nothing is shot out.
    for (Contact& c : scratch_.contacts)
      if (c.gap_start < 0) c.offset -= std::max(0.0, -c.gap_start - kRecoverySpeed * h);
    appendLimits(model_, ws_.x1, state_, index_, kLimitMargin, scratch_.limits);
  }

  double gapAt(const Contact& c, const double* dx) const {
    double gap = -c.offset;
    for (int k = 0; k < c.count; ++k) {
      const int i = c.particle[k];
      gap += c.weight[k] *
             c.normal.dot(state_.x.col(i) + Eigen::Map<const Vec3>(dx + 3 * (i - ragdoll_.first)));
    }
    return gap;
  }

  Vec3 motionOf(const Contact& c, const double* dx) const {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < c.count; ++k)
      sum += c.weight[k] * Eigen::Map<const Vec3>(dx + 3 * (c.particle[k] - ragdoll_.first));
    return sum;
  }

  /// [m/s] approach above which a contact bounces: slower is rest.
  double bounceSpeed(const Contact& c) const {
    return kBounceSteps * step_ * std::abs(c.normal.dot(model_.gravity));
  }

  bool bounces(const Contact& c, double h) const {
    if (!(c.restitution > 0) || c.gap_start < -kContactTolerance) return false;
    const double speed =
        -c.normal.dot(motionOf(c, scratch_.dx.data()) / h - c.surface_motion / step_);
    return speed > bounceSpeed(c) && gapAt(c, scratch_.dx.data()) < 0;
  }

  /// Time of the earliest bounce within h (gap falling as a parabola), or h.
  double firstBounce(double h) const {
    double first = h;
    for (const Contact& c : scratch_.contacts) {
      if (!bounces(c, h)) continue;
      const double end = gapAt(c, scratch_.dx.data());
      const double v0 = c.normal.dot(motionOf(c, state_.v.data() + 3 * ragdoll_.first)) -
                        c.normal.dot(c.surface_motion) / step_;
      const double g0 = std::max(
          0.0, end - c.normal.dot(motionOf(c, scratch_.dx.data()) - h / step_ * c.surface_motion));
      const double q = (end - g0 - v0 * h) / (h * h);  // gap = g0 + v0 t + q t^2
      const double root = std::sqrt(std::max(0.0, v0 * v0 - 4 * q * g0));
      const double t = g0 > 0 ? 2 * g0 / (-v0 + root) : 0;
      if (t >= 0 && t < first) first = t;
    }
    return first;
  }

  /// Rows of contacts and limits that may act; b at the present dx.
  void gather(double h, bool velocities) {
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    Schur& schur = scratch_.schur;
    schur.start(ragdoll_.first);
    for (std::size_t i = 0; i < scratch_.contacts.size(); ++i)
      schur.addContact(scratch_.contacts[i], static_cast<int>(i));
    for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
      LimitRow& limit = scratch_.limits[i];
      if (!velocities) evaluateLimit(model_, ws_.x1, limit);
      schur.addLimit(limit, static_cast<int>(i), velocities ? 0 : limit.compliance / (h * h));
    }
  }

  /// Contacts that the body was pushed into by those it was free to meet; whether there are any.
  bool findMissed() {
    if (ws_.obstacles.empty()) return false;
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    scratch_.missed.clear();
    appendContacts(model_, ws_.obstacles, state_.x, ws_.x1, index_, 0, scratch_.missed);
    bool any = false;
    for (Contact& c : scratch_.missed) {
      if (c.gap_start < 0) c.offset -= std::max(0.0, -c.gap_start - kRecoverySpeed * step_);
      if (gapAt(c, scratch_.dx.data()) >= -kMissed) continue;
      scratch_.contacts.push_back(c);
      any = true;
    }
    return any;
  }

  /// Solves for the constraints found.
  void pressFound(double h) {
    Schur& schur = scratch_.schur;
    gather(h, false);
    schur.assemble(rows_, body_.start, system_.W);
    Eigen::VectorXd& p = scratch_.p;
    scratch_.total.setZero(schur.size());
    recall(h);
    for (int round = 0; round < kMaxRounds; ++round) {
      fillGaps(h);
      if (round > 0) p = scratch_.total;
      scratch_.b -= schur.matrix() * scratch_.total;
      schur.solve(scratch_.b, p);
      const Eigen::VectorXd change = p - scratch_.total;
      scratch_.total = p;
      schur.move(rows_, body_.start, system_.W, change, scratch_.dx.data());
      if (!satisfySticks() && !relaxAlongNew()) failed_ = true;
      if (failed_ || worstViolation() < kContactTolerance) break;
    }
  }

  /// Position stage: dx so that no contact and no limit is violated and every stick has its length.
  void press(double h, bool leapfrog = true) {
    if (scratch_.contacts.empty() && scratch_.limits.empty()) {
      scratch_.presses.clear();
      return;
    }
    Schur& schur = scratch_.schur;
    for (int search = 0; search < kMaxSearches; ++search) {
      if (search > 0) freeMotion(h);
      pressFound(h);
      if (!leapfrog || failed_ || !findMissed()) break;
      if (search + 1 < kMaxSearches) continue;
      failed_ = true;  // smaller steps meet fewer things at once
      scratch_.total.resize(0);
      return;
    }
    failed_ = failed_ || (leapfrog && worstViolation() > kUnsettled);
    for (int i = 0; i < schur.size(); ++i)
      if (schur.row(i).kind == Schur::Row::Kind::kNormal && scratch_.total[i] > 0)
        ++report_.contacts;
    remember(h);
  }

  /// The impulse that contact or limit `row.source` pressed with last; null: none.
  const Press* lastPress(const Schur::Row& row) const {
    Press key = keyOf(row);
    for (const Press& last : scratch_.presses)
      if (last.a == key.a && last.b == key.b && last.obstacle == key.obstacle &&
          last.other == key.other)
        return &last;
    return nullptr;
  }

  Press keyOf(const Schur::Row& row) const {
    Press key;
    key.ragdoll = index_;
    if (row.kind == Schur::Row::Kind::kLimit) {
      key.a = -1 - scratch_.limits[row.source].limit;
      key.b = scratch_.limits[row.source].joint;
    } else {
      const Contact& c = scratch_.contacts[row.source];
      key.a = c.particle[0];
      key.b = c.count > 1 ? c.particle[1] : -1;
      key.obstacle = c.obstacle;
      if (c.count == 4) key.other = {c.particle[2], c.particle[3]};
    }
    return key;
  }

  /// Starts p at what pressed in the last step.
  void recall(double h) {
    Eigen::VectorXd& p = scratch_.p;
    p.setZero(scratch_.schur.size());
    if (scratch_.presses.empty()) return;
    const Press* last = nullptr;
    for (int i = 0; i < p.size(); ++i) {
      const Schur::Row& row = scratch_.schur.row(i);
      if (row.kind != Schur::Row::Kind::kTangent) last = lastPress(row);
      if (!last) continue;
      if (row.kind == Schur::Row::Kind::kLimit)
        p[i] = last->impulse.x() * h * h;
      else
        p[i] = last->impulse.dot(row.direction) * h * h;
      if (row.kind == Schur::Row::Kind::kNormal) p[i] = std::max(0.0, p[i]);
    }
  }

  void remember(double h) {
    scratch_.presses.clear();
    for (int i = 0; i < scratch_.schur.size(); ++i) {
      const Schur::Row& row = scratch_.schur.row(i);
      const double force = scratch_.total[i] / (h * h);
      if (row.kind == Schur::Row::Kind::kLimit) {
        if (force == 0) continue;
        scratch_.presses.push_back(keyOf(row));
        scratch_.presses.back().impulse = Vec3(force, 0, 0);
      } else if (row.kind == Schur::Row::Kind::kNormal) {
        if (force == 0) continue;
        scratch_.presses.push_back(keyOf(row));
        scratch_.presses.back().impulse = force * row.direction;
      } else if (force != 0) {
        scratch_.presses.back().impulse += force * row.direction;
      }
    }
  }

  void fillGaps(double h) {
    const double share = h / step_;
    Schur& schur = scratch_.schur;
    scratch_.b.resize(schur.size());
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    for (int i = 0; i < schur.size(); ++i) {
      const Schur::Row& row = schur.row(i);
      if (row.kind == Schur::Row::Kind::kLimit) {
        LimitRow limit = scratch_.limits[row.source];
        evaluateLimit(model_, ws_.x1, limit);
        scratch_.b[i] = limit.value + row.compliance * scratch_.total[i];
      } else if (row.kind == Schur::Row::Kind::kNormal) {
        scratch_.b[i] = gapAt(scratch_.contacts[row.source], scratch_.dx.data());
      } else {
        const Contact& c = scratch_.contacts[row.source];
        scratch_.b[i] =
            schur.along(i, scratch_.dx.data()) - row.direction.dot(share * c.surface_motion);
      }
    }
  }

  double worstViolation() {
    double worst = 0;
    for (const Contact& c : scratch_.contacts)
      worst = std::max(worst, -gapAt(c, scratch_.dx.data()));
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    for (const LimitRow& l : scratch_.limits) {
      if (l.compliance > 0) continue;
      LimitRow limit = l;
      evaluateLimit(model_, ws_.x1, limit);
      worst = std::max(worst, -limit.value * 0.1);  // 0.1 m: the lever of a radian that is seen
    }
    return worst;
  }

  /// Velocity stage at the end of the motion dx over h.
  void finish(double h, bool leapfrog = true, bool impact = false) {
    ws_.x1.middleCols(ragdoll_.first, n_) = x() + scratch_.dx;
    v() = scratch_.dx / h;
    if (leapfrog) v() += (0.5 * h) * scratch_.acceleration;
    restrictToTouching(h);
    x() += scratch_.dx;
    body_.end.setPose(rows_, xData());
    body_.end.projectVelocities(rows_, vData());
    pushVelocities(body_.end, impact);
    std::swap(body_.start, body_.end);
  }

  /// Keeps the contacts and limits that touch at the end of dx: the others do not act on
  /// velocities.
  void restrictToTouching(double h) {
    scratch_.touching.clear();
    scratch_.warm.clear();
    const bool known = scratch_.total.size() == scratch_.schur.size();
    int row = 0;  // of the position stage
    for (const Contact& c : scratch_.contacts) {
      const int rows = c.friction > 0 ? 3 : 1;
      if (gapAt(c, scratch_.dx.data()) < kTouching) {
        scratch_.touching.push_back(c);
        for (int k = 0; k < rows; ++k)
          scratch_.warm.push_back(known && h > 0 ? scratch_.total[row + k] / h : 0);
      }
      row += rows;
    }
    scratch_.touching_limits.clear();
    for (LimitRow limit : scratch_.limits) {
      const double pressed = known && h > 0 ? scratch_.total[row] / h : 0;
      ++row;
      if (limit.compliance > 0) continue;
      evaluateLimit(model_, ws_.x1, limit);
      if (limit.value < kTouchingAngle && limit.count > 0) {
        scratch_.touching_limits.push_back(limit);
        scratch_.warm.push_back(pressed);
      }
    }
  }

  /// No touching contact approaches, none slips more than friction allows; on impact the fast ones
  /// bounce.
  void pushVelocities(StickSolver& sticks, bool impact) {
    if (scratch_.touching.empty() && scratch_.touching_limits.empty()) return;
    Schur& schur = scratch_.schur;
    schur.start(ragdoll_.first);
    for (std::size_t i = 0; i < scratch_.touching.size(); ++i)
      schur.addContact(scratch_.touching[i], static_cast<int>(i));
    for (std::size_t i = 0; i < scratch_.touching_limits.size(); ++i)
      schur.addLimit(scratch_.touching_limits[i], static_cast<int>(i), 0);
    schur.assemble(rows_, sticks, system_.W);
    scratch_.b.resize(schur.size());
    for (int i = 0; i < schur.size(); ++i) {
      const Schur::Row& row = schur.row(i);
      scratch_.b[i] = schur.along(i, vData());
      if (row.kind == Schur::Row::Kind::kLimit) continue;
      const Contact& c = scratch_.touching[row.source];
      scratch_.b[i] -= row.direction.dot(c.surface_motion) / step_;
      if (impact && row.kind == Schur::Row::Kind::kNormal && -scratch_.b[i] > bounceSpeed(c))
        scratch_.b[i] *= 1 + c.restitution;
    }
    scratch_.p = Eigen::Map<const Eigen::VectorXd>(scratch_.warm.data(), schur.size());
    schur.solve(scratch_.b, scratch_.p);
    schur.move(rows_, sticks, system_.W, scratch_.p, vData());
  }

  /// Newton's impact law at the present pose for the contacts that touch.
  void bounce() {
    scratch_.dx.setZero(3, n_);
    body_.start.setPose(rows_, xData());
    ws_.x1.middleCols(ragdoll_.first, n_) = x();
    restrictToTouching(0);
    pushVelocities(body_.start, true);
  }

  static constexpr double kRecoverySpeed = 2;  ///< [m/s]
  static constexpr double kUnsettled =
      5e-4;  ///< [m] a contact solution this bad is done again at half
  static constexpr double kMissed = 1e-4;    ///< [m] deeper than that is found and solved again
  static constexpr double kTouching = 1e-5;  ///< [m]
  static constexpr double kTouchingAngle = 1e-4;  ///< [rad]

  const Model& model_;
  Workspace::Impl& ws_;
  ShakeScratch& scratch_;
  State& state_;
  StepReport& report_;
  const int index_;
  const Ragdoll& ragdoll_;
  const DirectSystem& system_;
  const StickRows& rows_;
  ShakeBody& body_;
  const int n_;
  double step_ = 0;       ///< [s] the whole step
  bool failed_ = false;   ///< the present substep
  bool driven_ = false;   ///< something moves that gives energy: obstacles, pins
  bool limited_ = false;  ///< energy was taken out
};

}  // namespace

void stepBodyShake(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                   State& state, int ragdoll, StepReport& report) {
  ShakeStep(model, ws, state, ragdoll, report).run(inputs, h);
}

void settleBodyShake(const Model& model, double h, Workspace::Impl& ws, State& state, int ragdoll,
                     const std::vector<Contact>& touching, const std::vector<LimitRow>& limits) {
  StepReport report;
  ShakeStep(model, ws, state, ragdoll, report).settle(h, touching, limits);
}

void stepShake(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
               State& state, StepReport& report) {
  ws.bodies.resize(model.ragdolls.size());
  ws.first_stick.clear();
  int sticks = 0;
  for (const Ragdoll& r : model.ragdolls) {
    ws.first_stick.push_back(sticks);
    sticks += 2 * model.systemOf(r).direct.rows->s;
  }
  if (static_cast<int>(state.multipliers.size()) != sticks) state.multipliers.assign(sticks, 0.0);
  ws.x1.resize(3, model.size());
  sweepObstacles(model, state, inputs.obstacles, ws.obstacles);
  ws.presses.clear();
  if (model.ragdoll_collision)
    stepTogether(model, inputs, h, ws, state, report);
  else
    for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
      if (!state.asleep[i]) stepBodyShake(model, inputs, h, ws, state, static_cast<int>(i), report);
  for (const Press& press : state.presses) {
    const Ragdoll& r = model.ragdolls[press.ragdoll];
    if (state.asleep[press.ragdoll] && press.other[0] < r.first + model.skeletonOf(r).size())
      ws.presses.push_back(press);
  }
  std::swap(state.presses, ws.presses);
  keepAllowed(model, state);
}

}  // namespace ragdoll
