#include "world_names.h"

#include <vector>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"

namespace ragdoll {

std::string particleName(const Model& model, int particle) {
  for (const Ragdoll& r : model.ragdolls) {
    const Skeleton& s = model.skeletonOf(r);
    if (particle < r.first + s.size()) return r.name + "/" + s.particles[particle - r.first];
  }
  return "";
}

BodyRef findParticle(const Model& model, const std::string& body) {
  const BodyRef ref = findBody(model, body);
  if (ref.particles.size() == 1) return ref;
  std::vector<std::string> names;
  for (const int p : ref.particles) names.push_back(particleName(model, p));
  throw Error("", "'" + body + "' is a segment; a particle is held, of this one: " + joined(names));
}

}  // namespace ragdoll
