#include "core/contact/body_grid.h"

#include <algorithm>
#include <cmath>

namespace ragdoll {
namespace {

constexpr double kSmallestCell = 1e-3;  ///< [m]
constexpr double kMaxCells = 64;        ///< a box that covers more is compared with all
constexpr double kFarthestCell = 1e9;   ///< [cells] from the origin; beyond: compared with all

double widest(const Bounds& b) { return (b.hi - b.lo).maxCoeff(); }

}  // namespace

void BodyGrid::chooseCell(const std::vector<Bounds>& boxes) {
  double sum = 0;
  int count = 0;
  for (const Bounds& b : boxes) {
    const double e = widest(b);
    if (!std::isfinite(e)) continue;
    sum += e;
    ++count;
  }
  const double mean = count > 0 ? sum / count : 1;
  // Again without the outliers, so that one fast body does not make every cell large.
  sum = 0;
  count = 0;
  for (const Bounds& b : boxes) {
    const double e = widest(b);
    if (!(e <= 2 * mean)) continue;
    sum += e;
    ++count;
  }
  cell_ = std::max(kSmallestCell, count > 0 ? sum / count : 1);
}

BodyGrid::Cell BodyGrid::cellOf(const Vec3& p) const {
  return {static_cast<std::int32_t>(std::floor(p.x() / cell_)),
          static_cast<std::int32_t>(std::floor(p.y() / cell_)),
          static_cast<std::int32_t>(std::floor(p.z() / cell_))};
}

bool BodyGrid::isLarge(const Bounds& b) const {
  const Eigen::Array3d span = (b.hi - b.lo).array() / cell_ + 1;
  const double far = std::max(b.lo.cwiseAbs().maxCoeff(), b.hi.cwiseAbs().maxCoeff()) / cell_;
  return !(span.prod() <= kMaxCells && far < kFarthestCell);
}

std::size_t BodyGrid::bucketOf(const Cell& c) const {
  // Spatial hash [Teschner2003, sec. 4.1].
  const std::uint32_t h = static_cast<std::uint32_t>(c[0]) * 73856093u ^
                          static_cast<std::uint32_t>(c[1]) * 19349663u ^
                          static_cast<std::uint32_t>(c[2]) * 83492791u;
  return h % (first_.size() - 1);
}

void BodyGrid::enter(const std::vector<Bounds>& boxes) {
  entries_.clear();
  large_.clear();
  is_large_.assign(boxes.size(), 0);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const int box = static_cast<int>(i);
    if (isLarge(boxes[i])) {
      large_.push_back(box);
      is_large_[i] = 1;
      continue;
    }
    const Cell lo = cellOf(boxes[i].lo), hi = cellOf(boxes[i].hi);
    for (std::int32_t x = lo[0]; x <= hi[0]; ++x)
      for (std::int32_t y = lo[1]; y <= hi[1]; ++y)
        for (std::int32_t z = lo[2]; z <= hi[2]; ++z) entries_.push_back({{x, y, z}, box});
  }
  first_.assign(2 * entries_.size() + 2, 0);
  for (const Entry& e : entries_) ++first_[bucketOf(e.cell) + 1];
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  sorted_.resize(entries_.size());
  for (std::size_t k = entries_.size(); k-- > 0;) {
    // From behind: first_ ends as it began, and a bucket's boxes are in ascending order.
    const Entry& e = entries_[k];
    sorted_[--first_[bucketOf(e.cell) + 1]] = e;
  }
  // Now first_[b + 1] is the begin of bucket b.
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k - 1] = first_[k];
  first_.back() = static_cast<int>(entries_.size());
}

void BodyGrid::compare(const std::vector<Bounds>& boxes, std::size_t begin, std::size_t end) {
  for (std::size_t k = begin; k < end; ++k)
    for (std::size_t l = k + 1; l < end; ++l) {
      const Entry &p = sorted_[k], &q = sorted_[l];
      if (p.cell != q.cell) continue;
      ++compared_;
      const Bounds &a = boxes[p.box], &b = boxes[q.box];
      if (overlap(a, b) && cellOf(a.lo.cwiseMax(b.lo)) == p.cell)
        pairs_.push_back(std::minmax(p.box, q.box));
    }
}

void BodyGrid::compareLarge(const std::vector<Bounds>& boxes) {
  for (const int i : large_)
    for (int j = 0; j < static_cast<int>(boxes.size()); ++j) {
      if (j == i || (is_large_[j] && j < i)) continue;
      ++compared_;
      if (overlap(boxes[i], boxes[j])) pairs_.push_back(std::minmax(i, j));
    }
}

const std::vector<std::pair<int, int>>& BodyGrid::findPairs(const std::vector<Bounds>& boxes) {
  pairs_.clear();
  compared_ = 0;
  chooseCell(boxes);
  enter(boxes);
  for (std::size_t b = 0; b + 1 < first_.size(); ++b) compare(boxes, first_[b], first_[b + 1]);
  compareLarge(boxes);
  std::sort(pairs_.begin(), pairs_.end());
  return pairs_;
}

}  // namespace ragdoll
