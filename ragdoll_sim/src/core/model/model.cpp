#include "ragdoll_sim/core/model.h"

#include <algorithm>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"

namespace ragdoll {

int Skeleton::particle(const std::string& wanted) const { return indexOf(particles, wanted); }

int Skeleton::segment(const std::string& wanted) const {
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (segments[i].name == wanted) return static_cast<int>(i);
  return -1;
}

int Skeleton::joint(const std::string& wanted) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == wanted) return static_cast<int>(i);
  return -1;
}

BodyRef findBody(const Model& model, const std::string& name) {
  const std::size_t slash = name.find('/');
  const std::string prefix = slash == std::string::npos ? "" : name.substr(0, slash);
  const std::string body = slash == std::string::npos ? name : name.substr(slash + 1);
  std::vector<std::string> ragdolls, bodies;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    const Ragdoll& r = model.ragdolls[i];
    if (i < 20) ragdolls.push_back(r.name);
    if (!prefix.empty() && prefix != r.name) continue;
    const Skeleton& s = model.skeletonOf(r);
    BodyRef ref{static_cast<int>(i), {}, {}};
    if (const int p = s.particle(body); p >= 0 && p < s.named) {
      ref.particles = {p};
    } else if (const int g = s.segment(body); g >= 0) {
      ref.particles = s.segments[g].particles;
    } else if (bodies.empty()) {
      bodies.assign(s.particles.begin(), s.particles.begin() + s.named);
      for (const Segment& segment : s.segments)
        if (s.particle(segment.name) < 0) bodies.push_back(segment.name);
    }
    if (ref.particles.empty()) continue;
    ref.weight.assign(ref.particles.size(), 1.0 / static_cast<double>(ref.particles.size()));
    for (int& p : ref.particles) p += r.first;
    return ref;
  }
  if (bodies.empty())
    throw Error("", "unknown ragdoll '" + prefix + "'; there are " + joined(ragdolls) +
                        (model.ragdolls.size() > 20 ? ", ..." : ""));
  throw Error("", "unknown body '" + name + "'; there are " + joined(bodies));
}

int Skeleton::region(int a, int b) const {
  const auto has = [](const Segment& segment, int p) {
    return std::count(segment.particles.begin(), segment.particles.end(), p) > 0;
  };
  for (std::size_t i = 0; i < segments.size() && b < 0; ++i)
    if (segments[i].particles.size() == 2 && segments[i].particles[1] == a)
      return static_cast<int>(i);
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (has(segments[i], a) && (b < 0 || has(segments[i], b))) return static_cast<int>(i);
  return -1;
}

}  // namespace ragdoll
