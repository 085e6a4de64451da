#include "core/contact/stick_ends.h"

#include <algorithm>

#include "core/contact/stick_springs.h"

namespace ragdoll {
namespace {

void eraseDropped(std::size_t begin, std::vector<Contact>& contacts) {
  contacts.erase(std::remove_if(contacts.begin() + static_cast<std::ptrdiff_t>(begin),
                                contacts.end(), [](const Contact& c) { return c.dropped; }),
                 contacts.end());
}

}  // namespace

void shareSprings(const Model& model, const Obstacle& o, const Ragdoll& r, std::size_t begin,
                  std::vector<Contact>& contacts) {
  const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(begin);
  for (auto c = first; c != contacts.end(); ++c) {
    if (c->count != 1 || !c->isSoft()) continue;
    const int particle = c->particle[0], all = sticksAt(model, o, r, particle - r.first);
    int left = all;
    for (auto k = first; k != contacts.end(); ++k) {
      const bool second = k != first && (k - 1)->count == 2 && (k - 1)->particle == k->particle;
      if (k->count == 2 && k->isSoft() && !second &&
          (k->particle[0] == particle || k->particle[1] == particle))
        --left;
    }
    if (left <= 0) {
      c->dropped = true;
    } else if (left < all) {
      c->give.compliance *= static_cast<double>(all) / left;
      c->give.damping *= static_cast<double>(left) / all;
    }
  }
  eraseDropped(begin, contacts);
}

void dropDeeperEnds(std::size_t begin, std::vector<Contact>& contacts) {
  const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto endOf = [&](int particle) {
    return std::find_if(first, contacts.end(), [&](const Contact& c) {
      return c.count == 1 && c.particle[0] == particle;
    });
  };
  for (auto c = first; c != contacts.end(); ++c) {
    if (c->count != 2 || !c->isSoft()) continue;
    const auto a = endOf(c->particle[0]), b = endOf(c->particle[1]);
    const bool is_a = b == contacts.end() || (a != contacts.end() && a->gap_start <= b->gap_start);
    const auto deeper = is_a ? a : b;
    if (deeper != contacts.end()) deeper->dropped = true;
  }
  eraseDropped(begin, contacts);
}

void dropEndsOfSticks(std::size_t begin, std::vector<Contact>& contacts) {
  const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(begin);
  for (auto c = first; c != contacts.end(); ++c)
    for (int k = 0; k < 2; ++k)
      if (c->has_end[k])
        for (auto end = first; end != contacts.end(); ++end)
          if (end->count == 1 && end->particle[0] == c->particle[k]) end->dropped = true;
  eraseDropped(begin, contacts);
}

}  // namespace ragdoll
