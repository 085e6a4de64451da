// Bodies that touch each other, taken through one step of a direct method as one.
//
// Every stage of shake_step.h is taken by all bodies in turn; contacts between them are rows beside
// each body's own contacts and limits (joint_schur.h), so that everything that presses is solved
// for at once. They share the substeps. Sleepers that they touch stand still.
//
// A substep that fails is done again at half, then implicitly; what fails even so is left to each
// body by itself, as if the others were not there.
#pragma once

#include <vector>

#include "core/direct/island_scratch.h"
#include "core/direct/shake_step.h"

namespace ragdoll {

class ShakeIsland {
 public:
  /// bodies: awake, ascending; others: sleepers near them.
  ShakeIsland(const Model& model, Workspace::Impl& ws, IslandScratch& scratch, State& state,
              const std::vector<int>& bodies, const std::vector<int>& others, StepReport& report);

  void run(const Inputs& inputs, double h);

  /// Between bodies, in the last substep; valid until the next island.
  const std::vector<Press>& presses() const { return s_.known; }
  const std::vector<BodyPair>& pressing() const { return s_.pressing; }

 private:
  // Guard (shake_island.cpp).
  void guard(double h);
  double explicitStep(double h, int taken);
  double implicitStep(double h);
  void stepAlone(double h);
  bool failed() const;
  // As those of a body (shake_step.h), for all together.
  bool isSmooth() const;
  bool swings(double h);
  bool tensionJumped(double h);
  double energyRise(bool smooth);
  /// Whether a substep that gained so much is to be done again at half.
  bool isLarge(double rise, bool smooth);
  bool isHeld() const;  ///< by something that takes momentum

  // Positions (shake_island_contact.cpp).
  void findConstraints(double h);
  double firstDeepPair(double h) const;
  double firstArrival(double h);
  void freeMotion(double h);
  void press(double h);
  bool anyCloses() const;
  bool pressFound(double h);
  void pressImplicit(double h);
  void gather(double h, bool leapfrog);
  void fillGaps(double h);
  void solveRound(bool first);
  void recall(double h);
  void remember(double h);
  bool forceViolated();
  bool findMissed(double h);
  double worstViolation() const;

  // Velocities (shake_island_velocity.cpp).
  void finish(double h, bool leapfrog, bool impact);
  void bounce();
  void pushVelocities(bool at_end, bool impact, double h);

  int slotOf(int ragdoll) const;  ///< among the bodies; -1: does not move
  double gapAt(const Contact& c) const;
  void startPair(Contact& c, double h) const;
  double overlapLeft(const Contact& c, double h) const;
  /// Adds a contact's rows to both bodies' complements and to the joint rows; returns the first.
  int addRows(const Contact& c, int source);
  double along(int row, double* x) const;

  const Model& model_;
  Workspace::Impl& ws_;
  IslandScratch& s_;
  State& state_;
  StepReport& report_;
  const std::vector<int>& bodies_;
  std::vector<int> all_;  ///< bodies and others, ascending
  std::vector<ShakeStep> steps_;
  bool failed_ = false;
};

}  // namespace ragdoll
