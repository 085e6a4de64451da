// Bodies that touch bodies: who takes the step with whom.
//
// Bodies that meet in a step, or pressed on each other in the last one, make an island and take the
// step together (island.h); all others take it alone. Who meets is found on the way to where each
// would go by itself; what islands push together beyond that makes larger islands, which take the
// step anew.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"
#include "core/contact/pair_detect.h"
#include "core/direct/body.h"
#include "core/direct/outcome.h"
#include "core/direct/saved_motion.h"
#include "core/direct/stepper.h"

namespace ragdoll {

class IslandBuilder {
 public:
  /// As a step of every awake body in turn, and keeps them apart. stepper: takes the steps that it
  /// can; null: the direct method takes them all.
  void step(const StepContext& context, StepReport& report, Stepper* stepper = nullptr);

  /// Whether the direct method took a ragdoll's last step.
  bool tookDirectly(int ragdoll) const { return outcomes_[ragdoll].direct; }

 private:
  /// What a body's step came to; an island's is with its first body.
  struct IslandOutcome : Outcome {
    Roomy<int> island;         ///< bodies that it took the step with; empty: none yet
    Roomy<int> near_sleepers;  ///< that it came near
    Roomy<int> sleepers;       ///< island's first: that it took the step with
    int turn = 0;              ///< which of the step's it was
    bool direct = false;       ///< the direct method took it
  };

  void begin(const StepContext& context);
  /// Before its step.
  void reset(const StepContext& context, int ragdoll);
  void predict(const StepContext& context);
  /// Before a body, or the island that it is the first of, is stepped (anew).
  void takeTurn(int ragdoll) { outcomes_[ragdoll].turn = ++turns_; }
  void stepAlone(StepContext& context, int ragdoll);
  /// By the stepper, where it can, else by the direct method. front: the first of the bodies.
  void stepBy(StepContext& context, const std::vector<int>& bodies,
              const std::vector<int>& sleepers, IslandOutcome& front);
  /// Contacts between where the bodies were and where they are now; wakes sleepers.
  void findContacts(const StepContext& context);
  /// Those on the way from a pose to another, with the gaps [m] there.
  void search(const StepContext& context, const Points& from, const Points& to);
  /// Where the bodies would have gone had nothing turned them round, and where they would have come
  /// from: what they meet before an impact, and after it. Whether any is turned.
  bool findLegs(const StepContext& context);
  /// Whether there was any.
  bool stepWoken(const StepContext& context);
  /// Bodies whose gap is below `near` [m] share an island.
  void unite(double near);
  /// Steps what has not been stepped with just those bodies; whether there was any.
  bool stepIslands(const StepContext& context);
  void stepTogether(StepContext& context, const std::vector<int>& bodies,
                    const std::vector<int>& sleepers);
  /// Whether just those have not taken the step together yet.
  bool isNew(const std::vector<int>& bodies, const std::vector<int>& sleepers) const;
  /// Whether one island has every body, so that nothing is left to meet.
  bool holdsAll(const State& state) const;
  void mergeLogs(ContactLog& log);
  void end(const StepContext& context, StepReport& report);
  int root(int ragdoll);

  PairDetector detector_;
  std::vector<SavedMotion> start_;  ///< per ragdoll
  Points start_x_;                  ///< of all
  Points first_leg_, last_leg_;
  Roomy<Contact> contacts_, found_;    ///< found_: by one search
  Roomy<double> gaps_;                 ///< [m] of the contacts
  std::vector<int> parent_, root_of_;  ///< per ragdoll: disjoint sets; roots as contacts are found
  std::vector<IslandOutcome> outcomes_;
  std::vector<std::uint8_t> pressed_pair_, was_asleep_;
  std::vector<Roomy<int>> members_, sleepers_;  ///< per root
  std::vector<int> parts_;                      ///< ragdolls, or roots, that are stepped now
  std::vector<int> no_sleepers_, order_, woken_;
  int turns_ = 0;  ///< taken in this step
  Stepper* stepper_ = nullptr;
  std::vector<Outcome*> outcome_of_;
  std::vector<int> left_;
};

}  // namespace ragdoll
