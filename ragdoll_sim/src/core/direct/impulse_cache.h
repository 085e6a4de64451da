// What contacts and limits pressed with in the last motion: where the next one's solver starts
// (warm starting), and which of them are solved for again even if their gap is open.
#pragma once

#include <vector>

#include "core/base/growing.h"
#include "core/contact/contact.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// Whether two impulses of one body are of the same contact or limit.
bool isOfSame(const CachedImpulse& a, const CachedImpulse& b);

/// Which contact or limit an impulse is of, without the impulse.
CachedImpulse keyOf(const Contact& contact);
CachedImpulse keyOf(const LimitRow& limit);

/// One body's, or those between the bodies of an island.
class ImpulseCache {
 public:
  void clear() {
    impulses_.clear();
    gripped_ = false;
  }
  bool empty() const { return impulses_.empty(); }
  const std::vector<CachedImpulse>& impulses() const { return impulses_; }
  void add(const CachedImpulse& impulse) { impulses_.push_back(impulse); }
  /// Whether the friction of an obstacle held one of the contacts.
  bool gripped() const { return gripped_; }
  void setGripped() { gripped_ = true; }
  /// The last one added.
  CachedImpulse& last() { return impulses_.back(); }

  /// Of the same contact or limit; null: it did not press.
  const CachedImpulse* find(const CachedImpulse& key) const;
  const CachedImpulse* find(const Contact& contact) const { return find(keyOf(contact)); }
  const CachedImpulse* find(const LimitRow& limit) const { return find(keyOf(limit)); }

  /// For contacts of which the same parts have several: each answer is given out once.
  void startHandingOut() { handed_out_.assign(impulses_.size(), 0); }
  const CachedImpulse* handOut(const Contact& contact);
  bool isHandedOut(std::size_t k) const { return handed_out_[k] != 0; }

 private:
  Roomy<CachedImpulse> impulses_;
  Roomy<std::uint8_t> handed_out_;
  bool gripped_ = false;
};

}  // namespace ragdoll
