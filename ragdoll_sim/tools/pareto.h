// Which of several (cost, error) pairs nothing else beats.
#pragma once

#include <vector>

namespace ragdoll::lab {

struct CostAndError {
  double cost = 0, error = 0;
};

/// One flag per item: true where no other item is at most as dear and at most as wrong, and better
/// in one of the two. Items that are not finite are never on the front.
std::vector<bool> paretoFront(const std::vector<CostAndError>& items);

}  // namespace ragdoll::lab
