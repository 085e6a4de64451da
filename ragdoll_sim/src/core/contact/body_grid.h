// Broad phase: which boxes overlap, by a uniform grid. Cost grows linearly with the number of boxes
// as long as their density does not grow, and their order never depends on anything but the boxes.
//
// A box is entered in every cell that it covers; two boxes are compared in a cell that both cover,
// and reported in one of them only, the cell of their intersection's low corner [Ericson2005, sec.
// 7.1]. Cells live in a table of buckets filled by a counting sort. Boxes that would cover many
// cells are compared with all others: they are few, or the cells would have been larger.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/growing.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// A box along the axes.
struct Bounds {
  Vec3 lo, hi;  ///< [m]
};

/// False where a bound is not a number.
inline bool overlap(const Bounds& a, const Bounds& b, double margin = 0) {
  return ((a.lo.array() - margin) <= b.hi.array()).all() &&
         ((b.lo.array() - margin) <= a.hi.array()).all();
}

class BodyGrid {
 public:
  /// Pairs (i < j), ascending, of boxes that overlap.
  const std::vector<std::pair<int, int>>& findPairs(const std::vector<Bounds>& boxes);
  long compared() const { return compared_; }  ///< pairs of boxes, in the last findPairs

 private:
  using Cell = std::array<std::int32_t, 3>;
  struct Entry {
    Cell cell;
    int box;
  };
  void chooseCell(const std::vector<Bounds>& boxes);
  Cell cellOf(const Vec3& p) const;
  bool isLarge(const Bounds& box) const;
  std::size_t bucketOf(const Cell& cell) const;
  void enter(const std::vector<Bounds>& boxes);
  void compare(const std::vector<Bounds>& boxes, std::size_t begin, std::size_t end);
  void compareLarge(const std::vector<Bounds>& boxes);

  double cell_ = 1;  ///< [m] edge
  long compared_ = 0;
  Roomy<Entry> entries_, sorted_;
  Roomy<int> first_;  ///< of each bucket, in sorted_
  Roomy<int> large_;
  Roomy<std::uint8_t> is_large_;
  Roomy<std::pair<int, int>> pairs_;
};

}  // namespace ragdoll
