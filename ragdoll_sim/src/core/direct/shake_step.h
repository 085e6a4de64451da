// One body during one step of a direct method (shake.h). Private to the core. Its stages, a file
// each: shake_motion.cpp (free motion), shake_contact.cpp (positions), shake_arrival.cpp (limits
// and contacts that are reached), shake_velocity.cpp (velocities, bounces), shake_guard.cpp (step
// guard), shake_implicit.cpp (its last resorts), shake_adapt.cpp (adaptive rk), shake_energy.cpp
// (energy limiter), shake_join.cpp (sticks far from their lengths).
#pragma once

#include <cstdint>
#include <vector>

#include "core/contact/contact.h"
#include "core/step/workspace.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

class ShakeStep {
 public:
  static constexpr double kMissedPair = 5e-4;    ///< [m] overlap of two capsules that may stay,
  static constexpr double kPairRecovery = 0.05;  ///< [s] and where more shrinks to 1 / e of itself

  ShakeStep(const Model& model, Workspace::Impl& ws, ShakeScratch& scratch, State& state,
            int ragdoll, StepReport& report);

  void run(const Inputs& inputs, double h);

  /// x <- where the body would go if it met nothing; velocities are left as they then are.
  void predict(const Inputs& inputs, double h);

  /// [m] of a pair's overlap at the start that a motion over h [s] leaves: it opens evenly, so that
  /// no speed comes of it. Ends that lie behind the contact's plane at the start, though they do
  /// not overlap there, come out over the whole `step`.
  static double overlapLeft(const Contact& pair, double h, double step);

 private:
  friend class ShakeIsland;

  static constexpr double kTolerance = 1e-10;        ///< relative error of a stick's squared length
  static constexpr double kContactTolerance = 1e-6;  ///< [m] at 120 Hz or less
  static constexpr double kTouching = 1e-5;          ///< [m] likewise
  static constexpr double kTouchingAngle = 1e-4;     ///< [rad] likewise
  static constexpr double kUnsettled = 5e-4;         ///< [m] a contact solution this bad is refused
  static constexpr double kSqueezed = 1e-3;          ///< [m] overlap that no sound step leaves
  static constexpr int kMaxBounces = 4;              ///< in one step; later ones do not bounce
  static constexpr int kMaxImpacts = 32;             ///< of deep contacts, likewise
  static constexpr double kDeepImpact = 0.2;  ///< [m] contact that would reach so deep is an impact
  static constexpr double kContactMargin = 0.02;  ///< [m]
  static constexpr double kActiveGap =
      1e-3;                                ///< [m] contacts nearer than this are solved for at once
  static constexpr double kMissed = 1e-4;  ///< [m] deeper than that is found and solved again
  static constexpr double kMissedStick = 5e-4;  ///< [m] the same of sticks that turned over an edge
  static constexpr double kRecoverySpeed = 2;   ///< [m/s] at which overlap found at the start opens
  static constexpr int kMaxRounds = 6;          ///< of contacts and sticks in turn
  static constexpr double kProgress = 0.8;  ///< of the last round's violation: more is no progress
  static constexpr int kMaxSearches = 3;    ///< for contacts that others push the body into
  static constexpr double kStable = 1.0;    ///< h sqrt(Omega2) of a substep; 2: edge of stability
  static constexpr double kJump = 0.5;      ///< of kStable, for tension that jumps
  static constexpr double kSwing = 0.2;     ///< of kStable: below, leapfrog's energy hardly swings
  static constexpr int kMaxSubsteps = 16;   ///< above, one implicit step is cheaper
  /// Of the kinetic energy (1 J at least): a substep that gains more is done again at half.
  static constexpr double kRedoRise = 1e-3;
  /// The same of a smooth motion, whose energy should neither rise nor fall, in kinetic energy and
  /// a fall of 1 m together: limbs that turn back have none of the first.
  static constexpr double kRedoSwing = 3e-4;

  /// Which overlaps have no way out and may stay as they are: those above kSqueezed, or all.
  /// kThrough: moving pins drag the body through the obstacles that it is in.
  enum class Squeezed { kNo, kDeep, kAll, kThrough };

  auto x() { return state_.x.middleCols(ragdoll_.first, n_); }
  auto v() { return state_.v.middleCols(ragdoll_.first, n_); }
  double* xData() { return state_.x.data() + 3 * ragdoll_.first; }
  double* vData() { return state_.v.data() + 3 * ragdoll_.first; }
  double* multipliers() { return state_.multipliers.data() + ws_.first_stick[index_]; }

  // Start and end of the step (shake.cpp).

  void begin(const Inputs& inputs, double h);
  /// Tells the workspace what pressed.
  void end();
  /// Tolerances of contacts and limits: they shrink as the method's error does, with h^2.
  void setStep(double h);
  void makeAffine();
  bool obstaclesMove(const Inputs& inputs) const;
  /// Pinned particles move evenly to their targets and carry what is rigid with them.
  void movePins(const Inputs& inputs, double h);

  // Step guard (shake_guard.cpp).

  /// Explicit steps are stable while h sqrt(Omega2) < 2, Omega2 the largest eigenvalue of the
  /// tension's stiffness (docs/equations.md#guard): substeps keep it below kStable; a substep that
  /// fails, gains energy or whose tension outgrew it is done again at half; what would take more
  /// than kMaxSubsteps goes to implicit steps, halved where they fail; what fails even at the
  /// smallest moves as a rigid body until it touches something, which cannot fail.
  void guard(double h);
  double explicitStep(double h);
  /// Omega2 [1/s^2], a bound: largest row sum of |G| |2 m|, m the multipliers of the last motion.
  double stiffness();
  /// The same of other multipliers, per h^2.
  double stiffnessOf(const double* multipliers);
  /// Whether the tension in a substep of h has more than doubled its frequency, as at the start, in
  /// a blow or under a new force, and holds it above kJump: nothing had said so before, and
  /// leapfrog's energy rises by what its frequency's square does.
  bool tensionJumped(double h);
  /// Whether the tension in a substep of h is enough for leapfrog's energy to swing with it.
  bool swings(double h);
  /// Whether a coarser bound, at a fraction of the cost, shows that h is stable.
  bool isSoft(double h);
  void save();
  void restore();

  // Last resorts (shake_implicit.cpp).

  /// Backward Euler with contacts and limits: first order, dissipative, for any tension.
  double implicitStep(double h);
  /// dx and multipliers of a backward Euler step without contacts, by Newton's method with the
  /// tension's stiffness in its matrix.
  bool solveImplicit(double h);
  /// Pushes dx out of obstacles and limits, along the NEW directions of sticks.
  void pressImplicit(double h);
  /// Newton along the new directions until every stick has its length.
  bool relaxAlongNew();
  /// What the body would do with its joints frozen, as far as the first touch; then it stands.
  double rigidStep(double h);

  // Joining (shake_join.cpp).

  /// Draws sticks that are far from their lengths towards them, positions alone: speeds do not
  /// rise. In this step they then keep the lengths that they have.
  void join(double h);
  double stickError();
  double lengthNow2(int stick) const;
  /// Gives collapsed sticks a direction, that of the rest pose.
  void spreadCollapsed();
  void relaxInTurn();

  // Adaptive rk (shake_adapt.cpp).

  /// Substeps of Dormand-Prince 5 whose estimated error per simulated second stays within the
  /// scene's tolerance; where something touches, the rest of the step goes to guard.
  void adapt(double h);

  // Energy limiter (shake_energy.cpp).

  double kineticEnergy();
  /// [m/s] of what moves the body from outside: pins, obstacles that touch it.
  double driveSpeed() const;
  /// [J] by how much the present substep gained more than gravity, pokes, soft limits and what
  /// drives it at
  /// `drive` [m/s] can have given it.
  double gainedEnergy(double drive);
  /// [J] the same for explicit steps; 0 while pins move.
  double energyRise(bool smooth);
  /// Whether the present substep met nothing but limits that pressed all the while: its energy
  /// stays but for leapfrog's swing, which is not for the limiter to take.
  bool isSmooth() const;
  /// Whether a smooth substep whose energy changed so much is to be done again at half.
  bool isLargeSwing(double change);
  /// [J] An implicit step that gains more than the body's kinetic energy, and than would bring it
  /// from rest to a speed that no overlap opens at, has gone astray.
  double wildRise();
  double swingScale();  ///< [J] kinetic energy and a fall of 1 m
  /// [J] that soft limits gave to the motion: less than at its start is stored in them.
  double releasedEnergy();
  /// Takes the rise out of the motion within the body, which leaves its momentum; out of the whole
  /// motion only where that is not enough and a contact pressed. Whether all of it is out, or
  /// nearly.
  bool limitEnergy(double rise);

  // Motion (shake_motion.cpp).

  /// Moves the body by `h` or to what it reaches first, whichever comes first; returns the time it
  /// took.
  double advance(double h);
  /// As advance, by Dormand-Prince 5 while nothing touches.
  double advanceSmooth(double h);
  /// dx and velocities (scratch_.v1) over h by Dormand-Prince 5; whether nothing touches.
  bool smoothMotion(double h);
  /// Makes that motion.
  void moveSmoothly();
  /// As smoothMotion, no matter what it meets.
  void smoothIncrement(double h);
  /// After a smoothMotion over h that met something: moves to where that is reached and gives the
  /// blow. Returns the time that took; more than h: something touched before, which is not for it.
  double arriveSmoothly(double h);
  /// dx and the sticks' multipliers over h, without contacts.
  void freeMotion(double h);
  /// Newton along the old directions until every stick has its length.
  bool satisfySticks();

  // Contacts and limits, positions (shake_contact.cpp).

  void findConstraints(double h);
  /// What contacts and limits have to know of the substep's start.
  void startContact(Contact& c, double h) const;
  void startRow(LimitRow& limit, double h);
  /// An overlap found at the start opens at a bounded speed, so that nothing is shot out; in a
  /// motion over h of a substep `whole`. Those of a squeezed body need not.
  void openSlowly(Contact& c, double h, double whole) const;
  void openSlowly(LimitRow& limit, double h) const;
  /// The same for all, when the substep is cut short.
  void shorten(double h, double whole);
  /// x1 <- where the present dx leads, and the limits there.
  LimitAngles::Pose& anglesAfter();
  /// Those at the present x.
  LimitAngles::Pose& anglesBefore() const { return body_.angles.at(model_, state_.x, index_); }
  double gapAt(const Contact& c, const double* dx) const;
  Vec3 motionOf(const Contact& c, const double* dx) const;
  /// Rows of the contacts and limits that are solved for: violated or nearly so at the present dx,
  /// pressing in the last step, or forced.
  void gather(double h, bool leapfrog);
  /// Forces those that the solution for the others violates; whether there are any.
  bool forceViolated();
  /// Forces all that are not arriving.
  void forceNear();
  /// Contacts that the body was pushed into by those it was free to meet; whether there are any.
  bool findMissed(double h);
  /// Adds the limits that come nearer than the margin [rad] at the end of dx; whether there are new
  /// ones.
  bool addLimits(double margin, double h, ShakeScratch::Role role);
  /// Rows of the Schur complement that are the body's own.
  int ownRows() const { return scratch_.own_rows; }
  /// Whether what overlaps at the step's start, by more than sound steps leave, leaves no direction
  /// to open in: it presses from opposite sides, or is a body.
  bool isSqueezed() const;
  /// Whether the sticks have their lengths; before that angles mean nothing.
  bool isJoined() const;
  /// Takes out the contacts with the obstacles that the body is in.
  void letThrough();
  bool passes(const Contact& c) const;  ///< whether it is one of those
  /// Whether a step that fails means that the overlap at its start cannot open.
  bool hasNoWayOut() const { return squeezed_ == Squeezed::kNo && isSqueezed(); }
  /// Solves for the constraints found.
  void pressFound(double h, bool leapfrog);
  /// Position stage: dx so that no contact and no limit is violated and every stick has its length.
  void press(double h, bool leapfrog = true);
  /// The impulse that a contact or limit pressed with last; null: none.
  const Press* lastPress(const Press& key) const;
  Press keyOf(const LimitRow& limit) const;
  Press keyOf(const Contact& contact) const;
  Press keyOf(const Schur::Row& row) const;
  /// Starts p at what pressed in the last step.
  void recall(double h);
  void remember(double h);
  void fillGaps(double h);
  /// Whether any row's gap is closed at the present dx: else nothing presses.
  bool anyCloses() const;
  double worstViolation();

  // What is reached in time (shake_arrival.cpp).

  /// Marks limits and contacts that the body comes to from afar, faster than gravity would bring
  /// it there: they do not press until they are reached.
  void findArrivals(double h);
  /// Time at which the first of them is reached by the motion dx over h; more than h: none is.
  double firstArrival(double h);
  /// Marks that one as arrived, if it is what the substep ends with, and the others as usual.
  void takeArrival(bool mine);
  /// Time at which start + rate t + q t^2 = 0, with q from the value `end` at h.
  static double timeOfZero(double start, double rate, double end, double h);
  /// Time of it again, by a motion dx over `h` that should have ended there.
  double arrivalAgain(double h);
  /// Whether the motion dx goes through what is arriving: it will be cut short.
  bool arrivesBefore();
  bool isArriving(const Contact& c, double h) const;
  bool isArriving(const LimitRow& limit, double h) const;
  /// [m/s], [rad/s] at which the gap opens at the substep's start.
  double rateOf(const Contact& c) const;
  double rateOf(const LimitRow& limit) const;

  // Velocities and bounces (shake_velocity.cpp).

  /// Velocity stage at the end of the motion dx over h.
  void finish(double h, bool leapfrog = true, bool impact = false);
  /// Its first part: makes the motion; velocities that the sticks allow.
  void move(double h, bool leapfrog);
  /// Keeps the contacts and limits that touch at the end of dx: the others do not act on
  /// velocities.
  void restrictToTouching(double h);
  /// Springs of soft limits act on velocities; those with a damper join the touching limits.
  void releaseSprings(double h);
  /// No touching contact approaches, none slips more than friction allows; on impact the fast ones
  /// bounce, after what pressed over h has done its part.
  void pushVelocities(StickSolver& sticks, bool impact, double h = 0);
  /// Rows of what touches, and the rates b at which they open.
  void gatherTouching(double h);
  void fillRates();
  /// Holds the rows of what is just reached, at no impulse.
  void holdArriving();
  /// Newton's impact law: b, and all rows free but those of springs and dampers.
  void fillBlow();
  /// Whether what the row stands for did not touch at the substep's start.
  bool arrivesNow(const Schur::Row& row) const;
  /// [m/s] approach above which a contact bounces: slower is rest.
  double bounceSpeed(const Contact& c) const;
  /// Newton's impact law at the present pose for the contacts that touch.
  void bounce();

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
  double step_ = 0;                               ///< [s] the whole step
  double contact_tolerance_ = kContactTolerance;  ///< [m] violation that is left
  double touching_ = kTouching;                   ///< [m] a gap smaller than that is closed
  double touching_angle_ = kTouchingAngle;        ///< [rad] likewise
  int located_ = 0;                               ///< arrivals in this step
  int located_before_ = 0;                        ///< at the present substep's start
  std::uint8_t* arrival_ = nullptr;               ///< role of what firstArrival found
  double overlap_ = 0;             ///< [m] with obstacles, at the start of the present substep
  double pin_speed_ = 0;           ///< [m/s] of pins that move
  double tolerance_ = kTolerance;  ///< the same where positions are so far out that it is rounding
  const double* inverse_length2_;  ///< [1/m^2] likewise
  const double* length2_;          ///< [m^2] of the sticks in this step; rows_.width
  bool failed_ = false;            ///< the present substep
  Squeezed squeezed_ = Squeezed::kNo;
  bool driven_ = false;   ///< something moves that gives energy: obstacles, pins
  bool limited_ = false;  ///< energy was taken out
};

}  // namespace ragdoll
