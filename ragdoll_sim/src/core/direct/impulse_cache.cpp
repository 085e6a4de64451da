#include "core/direct/impulse_cache.h"

namespace ragdoll {

bool isOfSame(const CachedImpulse& a, const CachedImpulse& b) {
  return a.a == b.a && a.b == b.b && a.obstacle == b.obstacle && a.other == b.other;
}

CachedImpulse keyOf(const LimitRow& limit) {
  CachedImpulse key;
  key.ragdoll = limit.ragdoll;
  key.a = -1 - limit.limit;
  key.b = limit.joint;
  return key;
}

CachedImpulse keyOf(const Contact& c) {
  CachedImpulse key;
  key.ragdoll = c.ragdoll;
  key.a = c.particle[0];
  key.b = c.count > 1 ? c.particle[1] : -1;
  key.obstacle = c.obstacle;
  if (c.count == 4) key.other = {c.particle[2], c.particle[3]};
  return key;
}

const CachedImpulse* ImpulseCache::find(const CachedImpulse& key) const {
  for (const CachedImpulse& impulse : impulses_)
    if (isOfSame(impulse, key)) return &impulse;
  return nullptr;
}

const CachedImpulse* ImpulseCache::handOut(const Contact& contact) {
  const CachedImpulse key = keyOf(contact);
  for (std::size_t k = 0; k < impulses_.size(); ++k) {
    if (handed_out_[k] || !isOfSame(impulses_[k], key)) continue;
    handed_out_[k] = 1;
    return &impulses_[k];
  }
  return nullptr;
}

}  // namespace ragdoll
