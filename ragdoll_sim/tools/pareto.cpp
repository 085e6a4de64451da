#include "pareto.h"

#include <cmath>

namespace ragdoll::lab {
namespace {

bool usable(const CostAndError& item) {
  return std::isfinite(item.cost) && std::isfinite(item.error);
}

bool beats(const CostAndError& a, const CostAndError& b) {
  return a.cost <= b.cost && a.error <= b.error && (a.cost < b.cost || a.error < b.error);
}

}  // namespace

std::vector<bool> paretoFront(const std::vector<CostAndError>& items) {
  std::vector<bool> front;
  for (const CostAndError& item : items) {
    bool best = usable(item);
    for (const CostAndError& other : items) best = best && !beats(other, item);
    front.push_back(best);
  }
  return front;
}

}  // namespace ragdoll::lab
