#include "core/contact/compliance.h"

#include "core/contact/first_touch.h"

namespace ragdoll {

Compliance inSeries(const Compliance& a, const Compliance& b) {
  if (a.compliance == 0) return b;
  if (b.compliance == 0) return a;
  const double sum = a.damping + b.damping;
  return {a.compliance + b.compliance, sum > 0 ? a.damping * b.damping / sum : 0};
}

Compliance giveOf(const Ragdoll& r, const std::vector<Compliance>& regions, std::size_t index) {
  return r.compliant ? regions[index] : Compliance{};
}

Compliance giveOf(const Model& model, const Obstacle& obstacle, const Ragdoll& r,
                  const std::vector<Compliance>& regions, std::size_t index) {
  return model.compliant ? inSeries(obstacle.contact, giveOf(r, regions, index)) : Compliance{};
}

bool touchesAtStart(const Compliance& give, double start) {
  return isResting(start) || (give.compliance > 0 && start <= kResting);
}

}  // namespace ragdoll
