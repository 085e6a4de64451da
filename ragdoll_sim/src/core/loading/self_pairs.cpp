#include "ragdoll_sim/core/self_pairs.h"

#include <algorithm>

#include "core/contact/capsule_pairs.h"

namespace ragdoll {
namespace {

CapsuleAxis restAxis(const Skeleton& s, const Capsule& c) {
  return {s.rest.col(c.a), s.rest.col(c.b), s.radius[c.a], s.radius[c.b]};
}

bool inOneGroup(const Skeleton& s, const Capsule& p, const Capsule& q) {
  return std::any_of(s.groups.begin(), s.groups.end(), [&](const RigidGroup& g) {
    const auto has = [&](int i) { return std::count(g.particles.begin(), g.particles.end(), i); };
    return has(p.a) && has(p.b) && has(q.a) && has(q.b);
  });
}

bool overlapAtRest(const Skeleton& s, const Capsule& p, const Capsule& q) {
  const CapsuleAxis a = restAxis(s, p), b = restAxis(s, q);
  return gapAt(a, b, nearestPoints(a, b)) < 0;
}

void addPair(Skeleton& s, int i, int j) {
  const Capsule &p = s.capsules[i], &q = s.capsules[j];
  using Why = LeftOutPair::Why;
  if (p.a == q.a || p.a == q.b || p.b == q.a || p.b == q.b)
    s.left_out_pairs.push_back({i, j, Why::kSharedParticle});
  else if (inOneGroup(s, p, q))
    s.left_out_pairs.push_back({i, j, Why::kRigidGroup});
  else if (overlapAtRest(s, p, q))
    s.left_out_pairs.push_back({i, j, Why::kOverlapAtRest});
  else
    s.self_pairs.push_back({i, j});
}

std::size_t countOf(const Skeleton& s, LeftOutPair::Why why) {
  return static_cast<std::size_t>(
      std::count_if(s.left_out_pairs.begin(), s.left_out_pairs.end(),
                    [why](const LeftOutPair& p) { return p.why == why; }));
}

/// "\n  overlap in the rest pose: a-b with c-d, e-f"
std::string listed(const Skeleton& s, LeftOutPair::Why why, const char* what) {
  int first = -1;
  std::string names;
  for (const LeftOutPair& p : s.left_out_pairs) {  // in the order of their first
    if (p.why != why) continue;
    if (p.first != first)
      names += (first < 0 ? "" : "; ") + capsuleName(s, p.first) + " with ";
    else
      names += ", ";
    names += capsuleName(s, p.second);
    first = p.first;
  }
  return "\n  " + std::string(what) + ": " + (first < 0 ? "none" : names);
}

}  // namespace

void addCapsules(Skeleton& s, bool self) {
  std::vector<bool> joined(s.named, false);
  for (std::size_t j = 0; j < s.sticks.size(); ++j) {
    const Stick& k = s.sticks[j];
    if (k.a >= s.named || k.b >= s.named) continue;
    s.capsules.push_back({k.a, k.b});
    s.capsule_contact.push_back(s.stick_contact[j]);
    joined[k.a] = joined[k.b] = true;
  }
  for (int i = 0; i < s.named; ++i)
    if (!joined[i]) {
      s.capsules.push_back({i, i});
      s.capsule_contact.push_back(s.particle_contact[i]);
    }
  if (!self) return;
  const int count = static_cast<int>(s.capsules.size());
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j) addPair(s, i, j);
}

std::string capsuleName(const Skeleton& s, int capsule) {
  const Capsule& c = s.capsules[capsule];
  return c.a == c.b ? s.particles[c.a] : s.particles[c.a] + "-" + s.particles[c.b];
}

std::string describePairs(const Skeleton& s) {
  using Why = LeftOutPair::Why;
  std::string text = "self collision of '" + s.name + "': " + std::to_string(s.self_pairs.size()) +
                     " pairs of sticks; left out:";
  std::string lists;
  for (const auto& [why, what] : {std::pair(Why::kSharedParticle, "share a particle"),
                                  std::pair(Why::kRigidGroup, "are in one rigid group"),
                                  std::pair(Why::kOverlapAtRest, "overlap in the rest pose")}) {
    text += (lists.empty() ? " " : ", ") + std::to_string(countOf(s, why)) + " that " + what;
    lists += listed(s, why, what);
  }
  return text + lists;
}

std::string inShort(const std::string& note) { return note.substr(0, note.find('\n')); }

}  // namespace ragdoll
