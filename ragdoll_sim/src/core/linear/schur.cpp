#include "core/linear/schur.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/linear/constants.h"
#include "core/linear/schur_sweeps.h"

namespace ragdoll {
void Schur::start(int first) {
  if (assembled_) std::swap(now_, before_);
  assembled_ = false;
  first_ = first;
  now_.rows.clear();
}

void Schur::addContact(const Contact& c, int source, int begin, int end) {
  const std::array<Vec3, 3> directions = c.directions();
  for (int d = 0; d < rowsOf(c); ++d) {
    Row& row = now_.rows.emplace_back();
    row.kind = d == 0 ? Row::Kind::kNormal : Row::Kind::kTangent;
    row.source = source;
    row.count = end - begin;
    row.direction = directions[d];
    row.friction = c.friction;
    for (int k = begin; k < end; ++k) {
      row.particle[k - begin] = c.particle[k] - first_;
      row.gradient[k - begin] = c.weight[k] * directions[d];
    }
  }
}

void Schur::addLimit(const LimitRow& limit, int source) {
  Row& row = now_.rows.emplace_back();
  row.kind = Row::Kind::kLimit;
  row.source = source;
  row.count = limit.count;
  for (int k = 0; k < limit.count; ++k) {
    row.particle[k] = limit.particle[k] - first_;
    row.gradient[k] = limit.gradient[k];
  }
}

bool Schur::findKnown() {
  const auto same = [](const Row& a, const Row& b) {
    return a.count == b.count && (a.kind == Row::Kind::kLimit) == (b.kind == Row::Kind::kLimit) &&
           std::equal(a.particle.begin(), a.particle.begin() + a.count, b.particle.begin()) &&
           std::memcmp(a.gradient.data(), b.gradient.data(), a.count * sizeof(Vec3)) == 0;
  };
  known_.assign(size(), -1);
  if (before_.pose.size() != now_.pose.size() || before_.pose != now_.pose) return false;
  auto next = before_.rows.begin();
  int found = 0;
  for (int i = 0; i < size(); ++i) {
    const auto row = std::find_if(next, before_.rows.end(),
                                  [&](const Row& other) { return same(other, now_.rows[i]); });
    if (row == before_.rows.end()) continue;
    known_[i] = static_cast<int>(row - before_.rows.begin());
    next = row + 1;
    ++found;
  }
  return found == size() && before_.rows.size() == now_.rows.size();
}

void Schur::assemble(const StickRows& c, StickSolver& sticks) {
  const int m = size();
  columns_ = paddedWidth(m);
  count_ = 3 * c.n;
  now_.pose = Eigen::Map<const Eigen::VectorXd>(sticks.pose(), count_);
  assembled_ = true;
  const auto ownAnswer = [&](int i) {
    return now_.rows[i].along(now_.answers.data() + i * c.coordinates) + now_.rows[i].compliance;
  };
  if (findKnown()) {
    std::swap(now_.A, before_.A);
    std::swap(now_.answers, before_.answers);
    std::swap(now_.free, before_.free);
    for (int i = 0; i < m; ++i) now_.A(i, i) = ownAnswer(i);
    return;
  }
  now_.free.resize(m);
  now_.answers.resize(m, c.coordinates);
  for (int i = 0; i < m; ++i) {
    const int known = known_[i];
    if (known >= 0) {
      now_.answers.row(i) = before_.answers.row(known);
      now_.free[i] = before_.free[known];
    } else {
      findAnswer(c, sticks, i);
    }
  }
  findMatrix(c);
}

// Row j is along_j of all answers, by lanes; of two rows the later one's stands on both sides.
void Schur::findMatrix(const StickRows& c) {
  const int m = size();
  place_.assign(c.n, -1);
  int places = 0;
  for (const Row& row : now_.rows)
    for (int k = 0; k < row.count; ++k)
      if (place_[row.particle[k]] < 0) place_[row.particle[k]] = places++;
  turned_.resize(3 * places, columns_);
  for (int p = 0; p < c.n; ++p) {
    if (place_[p] < 0) continue;
    for (int d = 0; d < 3; ++d) {
      double* out = turned_.data() + (3 * place_[p] + d) * columns_;
      const double* answer = now_.answers.data() + 3 * p + d;
      for (int i = 0; i < m; ++i) out[i] = answer[i * c.coordinates];
      std::fill(out + m, out + columns_, 0.0);
    }
  }
  now_.A.resize(m, columns_);
  for (int j = 0; j < m; ++j) {
    const Row& row = now_.rows[j];
    std::array<int, kMaxParticles> at;
    for (int k = 0; k < row.count; ++k) at[k] = place_[row.particle[k]];
    double* own = now_.A.data() + j * columns_;
    kernels::dotThrees(turned_.data(), columns_, paddedWidth(j + 1), at.data(),
                       row.gradient[0].data(), row.count, own);
    std::fill(own + m, own + columns_, 0.0);
    for (int i = 0; i < j; ++i) now_.A(i, j) = own[i];
    own[j] += row.compliance;
  }
}

void Schur::findAnswer(const StickRows& c, StickSolver& sticks, int i) {
  const Row& row = now_.rows[i];
  double* answer = now_.answers.data() + i * c.coordinates;
  if (row.kind == Row::Kind::kLimit) {
    now_.free[i] = sticks.answer(c, row.particle.data(), row.gradient[0].data(), row.count, answer);
    return;
  }
  // A particle has three rows, at two stages of a pose.
  kernels::gatherRows(sticks.mobility(c, row.particle.data(), row.count), c.coordinates,
                      row.particle.data(), row.gradient[0].data(), row.count, answer);
  now_.free[i] = 0;
  for (int k = 0; k < row.count; ++k)
    for (int l = 0; l < row.count; ++l)
      now_.free[i] +=
          c.spread_W(row.particle[k], 3 * row.particle[l]) * row.gradient[k].dot(row.gradient[l]);
}

namespace {

/// One body's rows as findBlocks and projectedGaussSeidel want them, by vectors of W doubles.
template <int W>
struct OneBody {
  const std::vector<Schur::Row>& rows;
  const double* A;
  int columns;
  const double* unheld;
  double* w;

  int size() const { return static_cast<int>(rows.size()); }
  const Schur::Row& row(int i) const { return rows[i]; }
  double matrix(int i, int j) const { return A[i * columns + j]; }
  double free(int i) const { return unheld[i]; }
  double rate(int i) const { return w[i]; }
  RAGDOLL_INLINE void push(int i, int count, const double* step) {
    const double* a = A + i * columns;
    for (int c = 0; c < columns; c += W) {
      typename kernels::Vector<W>::Lanes sum = kernels::lanes<W>(w + c).v;
      for (int k = 0; k < count; ++k) sum += step[k] * kernels::lanes<W>(a + k * columns + c).v;
      kernels::lanes<W>(w + c).v = sum;
    }
  }
};

namespace body {

template <int W>
RAGDOLL_INLINE bool sweep(OneBody<1>& rows, std::vector<SchurBlock>& blocks, double* p,
                          Sweeping kind) {
  OneBody<W> lanes{rows.rows, rows.A, rows.columns, rows.unheld, rows.w};
  return projectedGaussSeidel(lanes, blocks, p, kind);
}

}  // namespace body

RAGDOLL_KERNEL(bool, sweep,
               (OneBody<1> & rows, std::vector<SchurBlock>& blocks, double* p, Sweeping kind),
               (rows, blocks, p, kind))

}  // namespace

bool Schur::solve(const Eigen::Ref<const Eigen::VectorXd>& b, Eigen::Ref<Eigen::VectorXd> p,
                  Sweeping sweeps) {
  w_.setZero(columns_);
  w_.head(size()) = b;
  OneBody<1> rows{now_.rows, now_.A.data(), columns_, now_.free.data(), w_.data()};
  findBlocks(rows, blocks_);
  return sweep(rows, blocks_, p.data(), sweeps);
}

void Schur::addRates(int i, int count, const double* impulses) {
  kernels::addWeighted(w_.data(), now_.A.data() + i * columns_, impulses, count, columns_,
                       w_.data());
}

void Schur::move(const Eigen::Ref<const Eigen::VectorXd>& p, double* out) {
  const int coordinates = static_cast<int>(now_.answers.cols());
  moved_.setZero(coordinates);
  kernels::addWeighted(moved_.data(), now_.answers.data(), p.data(), size(), coordinates,
                       moved_.data());
  for (int i = 0; i < count_; ++i) out[i] += moved_[i];
}

}  // namespace ragdoll
