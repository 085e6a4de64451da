// Which capsules of the bodies may touch each other during a step: inside one body (the skeleton's
// self_pairs) and between bodies (body_grid.h, then all capsules of the two).
//
// What is found, and what that guarantees: capsule_pairs.h. Sleeping bodies do not move; pairs of
// them are left out.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/contact/body_grid.h"
#include "core/contact/contact.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// What is looked for between two poses (capsule_pairs.h).
struct PairSearch {
  bool at_end = false;  ///< findOverlaps of more than -margin; else findTouches
  double margin = 0;    ///< [m]

  static PairSearch touches(double margin) { return {false, margin}; }
  static PairSearch overlaps(double depth) { return {true, -depth}; }
};

class PairDetector {
 public:
  /// Appends the contacts of one ragdoll with itself between x0 and x1 (3 x N).
  void appendSelf(const Model& model, const Points& x0, const Points& x1, int ragdoll,
                  PairSearch search, std::vector<Contact>& contacts);

  /// Appends those between the ragdolls given, ascending; Contact::ragdoll < Contact::other.
  void appendBetween(const Model& model, const State& state, const std::vector<int>& ragdolls,
                     const Points& x0, const Points& x1, PairSearch search,
                     std::vector<Contact>& contacts, const std::vector<int>* group_of = nullptr);
  /// Between all of them; but for those of one group, where each one's is given.
  void appendBetween(const Model& model, const State& state, const Points& x0, const Points& x1,
                     PairSearch search, std::vector<Contact>& contacts,
                     const std::vector<int>* group_of = nullptr);

  const BodyGrid& grid() const { return grid_; }

 private:
  struct Body {
    int index;
    const Ragdoll* ragdoll;
    const Skeleton* skeleton;
  };
  void bound(const Model& model, const Body& body, const Points& x0, const Points& x1,
             PairSearch search, std::vector<Bounds>& out) const;
  void appendPair(const Model& model, const Body& p, int i, const Body& q, int j, const Points& x0,
                  const Points& x1, PairSearch search, std::vector<Contact>& contacts) const;

  BodyGrid grid_;
  Roomy<Bounds> bodies_, capsules_;  ///< swept; capsules: of all bodies, in order
  Roomy<Bounds> own_;                ///< of one body
  Roomy<int> first_;                 ///< a body's first capsule
  Roomy<int> all_;                   ///< ragdolls
  Roomy<int> near_;                  ///< capsules of the first body near the second
};

}  // namespace ragdoll
