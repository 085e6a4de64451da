#include "core/loading/contact_regions.h"

#include <cmath>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {
namespace {

// What a run can follow; far beyond any surface.
constexpr double kLeastStiffness = 1;    ///< [N/m]
constexpr double kMostStiffness = 1e12;  ///< [N/m]

}  // namespace

Compliance complianceOf(const ContactSpec& contact, const std::string& where) {
  const double k = contact.stiffness;
  if (std::isinf(k) && k > 0) return {};
  if (!(k >= kLeastStiffness && k <= kMostStiffness))
    throw Error(where + ".stiffness", "stiffness is " + numberText(k) + "; it must be from " +
                                          numberText(kLeastStiffness) + " to " +
                                          numberText(kMostStiffness) +
                                          " [N/m]; leave it out for rigid contact");
  if (!(contact.damping >= 0 && contact.damping <= kMostStiffness))
    throw Error(where + ".damping", "damping is " + numberText(contact.damping) +
                                        "; it must be from 0 to " + numberText(kMostStiffness) +
                                        " [N s/m]");
  return {1 / k, contact.damping};
}

void addContactRegions(Skeleton& s) {
  const auto of = [&s](int a, int b) {
    const int region = s.region(a, b);
    return region < 0 ? Compliance{} : s.segments[region].contact;
  };
  for (int i = 0; i < s.size(); ++i) s.particle_contact.push_back(of(i, -1));
  for (const Stick& k : s.sticks) s.stick_contact.push_back(of(k.a, k.b));
}

}  // namespace ragdoll
