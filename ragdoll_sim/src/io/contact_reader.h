// How a surface gives way: `stiffness` [N/m] and `damping` [N s/m], of obstacles and of segments.
#pragma once

#include "ragdoll_sim/core/scene.h"
#include "reader.h"

namespace ragdoll::io {

/// The two keys where they stand beside others; complianceOf() knows what they may be.
inline ContactSpec readContactKeys(MapReader& map) {
  ContactSpec contact;
  const auto stiffness = map.find("stiffness");
  if (stiffness) contact.stiffness = stiffness->number();
  if (const auto damping = map.find("damping")) {
    if (!stiffness)
      damping->fail("has a meaning only together with 'stiffness' [N/m]: without, contact is rigid");
    contact.damping = damping->number();
  }
  return contact;
}

/// {stiffness: ..., damping: ...}
inline ContactSpec readContact(const Reader& reader) {
  MapReader map(reader);
  map.need("stiffness");
  const ContactSpec contact = readContactKeys(map);
  map.finish();
  return contact;
}

}  // namespace ragdoll::io
