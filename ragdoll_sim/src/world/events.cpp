#include "ragdoll_sim/world/events.h"

#include <algorithm>

namespace ragdoll {

bool contains(const std::vector<Poke>& pokes, const Poke& poke) {
  return std::any_of(pokes.begin(), pokes.end(), [&](const Poke& p) {
    return p.body_name == poke.body_name && p.start == poke.start && p.force == poke.force &&
           p.point == poke.point;
  });
}

}  // namespace ragdoll
