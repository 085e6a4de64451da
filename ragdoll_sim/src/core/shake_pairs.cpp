#include "ragdoll_sim/core/shake_pairs.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/pair_energy.h"
#include "ragdoll_sim/core/shake.h"
#include "ragdoll_sim/core/sleep.h"
#include "ragdoll_sim/core/workspace.h"

namespace ragdoll {
namespace {

constexpr double kMargin = 0.005;     ///< [m]
constexpr int kRounds = 5;            ///< of all touching bodies' steps
constexpr int kIterations = 30;       ///< of Gauss-Seidel in a round
constexpr int kVelocityRounds = 6;    ///< of bodies' contacts and their own in turn
constexpr double kTolerance = 1e-5;   ///< [m] gap of a pressing contact
constexpr double kUnresolved = 1e-3;  ///< [m] overlap left that a user should know of
constexpr double kTouching = 1e-4;    ///< [m]
constexpr double kRecoverySpeed = 2;  ///< [m/s] at which overlap found at the start opens
constexpr double kHeld = 1e-9;        ///< [1/kg] an answer below cannot be moved

using Axes = Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>>;

class Together {
 public:
  Together(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws, State& state,
           StepReport& report)
      : model_(model),
        inputs_(inputs),
        h_(h),
        ws_(ws),
        p_(ws.together),
        state_(state),
        report_(report),
        count_(static_cast<int>(model.ragdolls.size())) {}

  void run() {
    save();
    for (int i = 0; i < count_; ++i)
      if (!state_.asleep[i]) stepBody(i);
    findContacts();
    if (!p_.contacts.empty()) {
      recall();
      for (int round = 0; round < kRounds; ++round) {
        restep();
        if (correct()) break;
        if (round + 1 == kRounds) restep();
      }
      velocities();
    }
    finish();
  }

 private:
  int first(int i) const { return model_.ragdolls[i].first; }
  int size(int i) const { return model_.skeletonOf(model_.ragdolls[i]).size(); }
  static int bodyOf(const Contact& c, int side) { return side == 0 ? c.ragdoll : c.other; }

  void save() {
    p_.x0 = state_.x;
    p_.v0 = state_.v;
    p_.multipliers0 = state_.multipliers;
    p_.kick.setZero(3, state_.x.cols());
    p_.own.resize(count_);
    p_.changed.assign(count_, 0);
  }

  /// One body's own step from the saved start and its kick.
  void stepBody(int i) {
    state_.x.middleCols(first(i), size(i)) = p_.x0.middleCols(first(i), size(i));
    state_.v.middleCols(first(i), size(i)) =
        p_.v0.middleCols(first(i), size(i)) + p_.kick.middleCols(first(i), size(i));
    std::copy_n(p_.multipliers0.begin() + ws_.first_stick[i],
                multiplierCount(*model_.systemOf(model_.ragdolls[i]).direct.rows),
                state_.multipliers.begin() + ws_.first_stick[i]);
    ShakePairs::Own& own = p_.own[i];
    ws_.presses.clear();
    ws_.pressed[i] = 0;
    own.report = StepReport();
    stepBodyShake(model_, inputs_, h_, ws_, state_, i, own.report);
    own.presses = ws_.presses;
    own.touching = ws_.shake.touching;
    own.limits = ws_.shake.touching_limits;
  }

  void findContacts() {
    do {
      p_.found.clear();
      ws_.pairs.appendBetween(model_, state_, p_.x0, state_.x, kMargin, p_.found);
      const std::vector<std::uint8_t> asleep = state_.asleep;
      if (!wakeTouched(p_.found, state_.x, state_)) break;
      for (int i = 0; i < count_; ++i)
        if (asleep[i] && !state_.asleep[i]) stepBody(i);
    } while (true);
    p_.contacts.clear();
    p_.pool.clear();
    for (const Contact& c : p_.found) {
      BodyContact b;
      b.contact = c;
      b.offset = c.offset;
      if (c.gap_start < 0) b.offset -= std::max(0.0, -c.gap_start - kRecoverySpeed * h_);
      b.A.setZero();
      for (int side = 0; side < 2; ++side)
        if (c.moves[side]) addResponse(b, side);
      b.wn = c.normal.dot(b.A * c.normal);
      b.wt = b.A.trace() - b.wn;
      if (b.wn > kHeld) p_.contacts.push_back(b);
    }
  }

  void addResponse(BodyContact& b, int side) {
    const Contact& c = b.contact;
    const int i = bodyOf(c, side), n = size(i), from = first(i);
    const DirectSystem& system = model_.systemOf(model_.ragdolls[i]).direct;
    b.response[side] = p_.pool.size();
    p_.pool.resize(p_.pool.size() + 9 * n, 0.0);
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Map<Points> r(p_.pool.data() + b.response[side] + 3 * n * axis, 3, n);
      for (int k = 2 * side; k < 2 * side + 2; ++k)
        r.row(axis) += c.weight[k] * system.W.row(c.particle[k] - from);
      ws_.bodies[i].start.projectVelocities(*system.rows, r.data());
      for (int k = 2 * side; k < 2 * side + 2; ++k)
        b.A.col(axis) += c.weight[k] * r.col(c.particle[k] - from);
    }
  }

  /// x += the answer to impulse J on the contact.
  void apply(const BodyContact& b, const Vec3& J, Points& x) const {
    for (int side = 0; side < 2; ++side) {
      if (!b.contact.moves[side]) continue;
      const int i = bodyOf(b.contact, side), n = size(i);
      const double* r = p_.pool.data() + b.response[side];
      x.middleCols(first(i), n) +=
          J.x() * Axes(r, 3, n) + J.y() * Axes(r + 3 * n, 3, n) + J.z() * Axes(r + 6 * n, 3, n);
    }
  }

  static Vec3 pointOf(const Contact& c, const Points& x) {
    return c.weight[0] * x.col(c.particle[0]) + c.weight[1] * x.col(c.particle[1]) +
           c.weight[2] * x.col(c.particle[2]) + c.weight[3] * x.col(c.particle[3]);
  }

  void markChanged(const BodyContact& b) {
    for (int side = 0; side < 2; ++side)
      if (b.contact.moves[side]) p_.changed[bodyOf(b.contact, side)] = 1;
  }

  /// Bodies whose kicks changed take their step again.
  void restep() {
    p_.kick.setZero();
    for (const BodyContact& b : p_.contacts)
      if (!b.impulse.isZero(0)) apply(b, b.impulse / h_, p_.kick);
    for (int i = 0; i < count_; ++i)
      if (p_.changed[i]) stepBody(i);
    std::fill(p_.changed.begin(), p_.changed.end(), 0);
  }

  /// The Coulomb cone's projection of a correction of the impulse by `miss` (normal: gap).
  static Vec3 corrected(const BodyContact& b, double gap, const Vec3& slip) {
    const Vec3& n = b.contact.normal;
    const double before = n.dot(b.impulse);
    const double normal = std::max(0.0, before - gap / b.wn);
    Vec3 across = b.impulse - before * n;
    if (b.wt > kHeld) across -= (slip - n.dot(slip) * n) / b.wt;
    const double size = across.norm(), limit = b.contact.friction * normal;
    if (size > limit) across *= limit / size;
    return normal * n + across;
  }

  /// One Newton step of the impulses; true if none was needed.
  bool correct() {
    residual_ = 0;
    overlap_ = 0;
    for (const BodyContact& b : p_.contacts) {
      const double gap = b.contact.normal.dot(pointOf(b.contact, state_.x)) - b.offset;
      residual_ = std::max(residual_, b.impulse.isZero(0) ? -gap : std::abs(gap));
      overlap_ = std::max(overlap_, -gap);
    }
    if (residual_ < kTolerance) return true;
    p_.u.setZero(3, state_.x.cols());
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      double change = 0;
      for (BodyContact& b : p_.contacts) {
        const Contact& c = b.contact;
        const Vec3 moved = pointOf(c, p_.u), point = pointOf(c, state_.x) + moved;
        const Vec3 after = corrected(b, c.normal.dot(point) - b.offset, point - pointOf(c, p_.x0));
        const Vec3 step = after - b.impulse;
        if (step.isZero(0)) continue;
        change = std::max(change, step.norm() * b.wn);
        b.impulse = after;
        apply(b, step, p_.u);
        markChanged(b);
      }
      if (change < 0.1 * kTolerance) break;
    }
    return false;
  }

  /// No touching pair approaches at the step's end; each body's sticks and own contacts in turn.
  void velocities() {
    std::vector<BodyContact*> touching;
    std::vector<int> bodies;
    p_.changed.assign(count_, 0);
    for (BodyContact& b : p_.contacts) {
      if (b.contact.normal.dot(pointOf(b.contact, state_.x)) - b.offset > kTouching) continue;
      touching.push_back(&b);
      markChanged(b);
    }
    for (int i = 0; i < count_; ++i)
      if (p_.changed[i]) bodies.push_back(i);
    std::vector<Vec3> kept;
    for (BodyContact* b : touching) {
      kept.push_back(b->impulse);
      b->impulse.setZero();
    }
    for (int round = 0; round < kVelocityRounds && !touching.empty(); ++round) {
      double change = 0;
      for (BodyContact* b : touching) {
        const Vec3 rate = pointOf(b->contact, state_.v);
        const Vec3 after = corrected(*b, b->contact.normal.dot(rate), rate);
        const Vec3 step = after - b->impulse;
        change = std::max(change, step.norm() * b->wn);
        b->impulse = after;
        apply(*b, step, state_.v);
      }
      if (change < 1e-9) break;
      for (const int i : bodies) {
        ShakePairs::Own& own = p_.own[i];
        ws_.bodies[i].start.projectVelocities(*model_.systemOf(model_.ragdolls[i]).direct.rows,
                                              state_.v.data() + 3 * first(i));
        settleBodyShake(model_, h_, ws_, state_, i, own.touching, own.limits);
      }
    }
    for (std::size_t k = 0; k < touching.size(); ++k) touching[k]->impulse = kept[k];
  }

  static std::array<int, 4> keyOf(const Press& p) { return {p.a, p.b, p.other[0], p.other[1]}; }

  Press pressOf(const BodyContact& b) const {
    Press press;
    press.ragdoll = b.contact.ragdoll;
    press.a = b.contact.particle[0];
    press.b = b.contact.particle[1];
    press.other = {b.contact.particle[2], b.contact.particle[3]};
    press.impulse = b.impulse / (h_ * h_);
    return press;
  }

  bool isBetween(const Press& press) const {
    return press.other[0] >= first(press.ragdoll) + size(press.ragdoll);
  }

  /// Starts the impulses at those of the last step.
  void recall() {
    p_.known.clear();
    for (const Press& press : state_.presses)
      if (isBetween(press)) p_.known.push_back(press);
    const auto before = [](const Press& p, const Press& q) { return keyOf(p) < keyOf(q); };
    std::stable_sort(p_.known.begin(), p_.known.end(), before);
    for (BodyContact& b : p_.contacts) {
      const Press key = pressOf(b);
      const auto it = std::lower_bound(p_.known.begin(), p_.known.end(), key, before);
      if (it == p_.known.end() || keyOf(*it) != keyOf(key)) continue;
      const double normal = it->impulse.dot(b.contact.normal);
      if (normal <= 0) continue;
      b.impulse = normal * h_ * h_ * b.contact.normal;
      it->impulse.setZero();  // one contact of the pair takes it
      markChanged(b);
    }
  }

  void finish() {
    ws_.presses.clear();
    for (int i = 0; i < count_; ++i) {
      if (state_.asleep[i]) continue;
      const ShakePairs::Own& own = p_.own[i];
      ws_.presses.insert(ws_.presses.end(), own.presses.begin(), own.presses.end());
      report_.contacts += own.report.contacts;
      report_.substeps = std::max(report_.substeps, own.report.substeps);
      report_.guarded += own.report.guarded;
      report_.limited += own.report.limited;
      report_.implicit += own.report.implicit;
      report_.rigid += own.report.rigid;
      report_.joining += own.report.joining;
      report_.unresolved += own.report.unresolved;
    }
    std::vector<const Contact*> pressing;
    for (const BodyContact& b : p_.contacts) {
      if (b.impulse.isZero(0)) continue;
      ++report_.contacts;
      ws_.presses.push_back(pressOf(b));
      pressing.push_back(&b.contact);
      for (int side = 0; side < 2; ++side)  // sleepers lie on something
        if (!b.contact.moves[side]) ws_.pressed[bodyOf(b.contact, side)] = 1;
    }
    spreadPressed(pressing, ws_.pressed);
    if (inputs_.pins.empty() && inputs_.obstacles.empty())  // else they may gain energy
      report_.limited += limitPairEnergy(model_, p_.found, p_.x0, p_.v0,
                                         ws_.forced ? &ws_.force : nullptr, state_);
    if (!p_.contacts.empty() && overlap_ > kUnresolved) ++report_.unresolved;
  }

  const Model& model_;
  const Inputs& inputs_;
  const double h_;
  Workspace::Impl& ws_;
  ShakePairs& p_;
  State& state_;
  StepReport& report_;
  const int count_;
  double residual_ = 0, overlap_ = 0;  ///< [m] at the last correction
};

}  // namespace

void stepTogether(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                  State& state, StepReport& report) {
  Together(model, inputs, h, ws, state, report).run();
}

}  // namespace ragdoll
