#include "ragdoll_sim/core/schur.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ragdoll_sim/core/schur_sweeps.h"

namespace ragdoll {
namespace {

Vec3 anyTangent(const Vec3& n) {
  return n.cross(std::abs(n.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
}

}  // namespace

void Schur::start(int first) {
  first_ = first;
  rows_.clear();
}

void Schur::addContact(const Contact& c, int source, int begin, int end) {
  const Vec3 t1 = anyTangent(c.normal), t2 = c.normal.cross(t1);
  const std::array<Vec3, 3> directions{c.normal, t1, t2};
  const int used = c.friction > 0 ? 3 : 1;
  for (int d = 0; d < used; ++d) {
    Row& row = rows_.emplace_back();
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

void Schur::addLimit(const LimitRow& limit, int source, double compliance, double least) {
  Row& row = rows_.emplace_back();
  row.kind = Row::Kind::kLimit;
  row.source = source;
  row.count = limit.count;
  row.compliance = compliance;
  row.least = least;
  for (int k = 0; k < limit.count; ++k) {
    row.particle[k] = limit.particle[k] - first_;
    row.gradient[k] = limit.gradient[k];
  }
}

void Schur::assemble(const StickRows& c, StickSolver& sticks) {
  const int m = size();
  columns_ = paddedWidth(m);
  count_ = 3 * c.n;
  A_.setZero(m, columns_);
  free_.resize(m);
  answers_.resize(m, c.coordinates);
  for (int i = 0; i < m; ++i) {
    const Row& row = rows_[i];
    double* answer = answers_.data() + i * c.coordinates;
    if (row.kind == Row::Kind::kLimit) {
      sticks.answer(c, row.particle.data(), row.gradient[0].data(), row.count, answer);
    } else {  // a particle has three rows, at two stages of a pose
      kernels::gatherRows(sticks.mobility(c, row.particle.data(), row.count), c.coordinates,
                          row.particle.data(), row.gradient[0].data(), row.count, answer);
    }
    A_(i, i) = row.along(answer) + row.compliance;
    for (int j = i + 1; j < m; ++j) A_(i, j) = A_(j, i) = rows_[j].along(answer);
    free_[i] = 0;
    for (int k = 0; k < row.count; ++k)
      for (int l = 0; l < row.count; ++l)
        free_[i] += c.spread_W(3 * row.particle[k], 3 * row.particle[l]) *
                    row.gradient[k].dot(row.gradient[l]);
  }
}

namespace {

/// One body's rows as findBlocks and projectedGaussSeidel want them, by vectors of W doubles.
template <int W>
struct OneBody {
  const std::vector<Schur::Row>& rows;
  const double* A;
  int columns;
  const Eigen::VectorXd& unheld;
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
RAGDOLL_INLINE bool sweep(OneBody<1>& rows, const std::vector<SchurBlock>& blocks, double* p) {
  OneBody<W> lanes{rows.rows, rows.A, rows.columns, rows.unheld, rows.w};
  return projectedGaussSeidel(lanes, blocks, p);
}

}  // namespace body

RAGDOLL_KERNEL(bool, sweep, (OneBody<1> & rows, const std::vector<SchurBlock>& blocks, double* p),
               (rows, blocks, p))

}  // namespace

bool Schur::solve(const Eigen::VectorXd& b, Eigen::VectorXd& p) {
  w_.setZero(columns_);
  w_.head(size()) = b;
  OneBody<1> rows{rows_, A_.data(), columns_, free_, w_.data()};
  findBlocks(rows, blocks_);
  return sweep(rows, blocks_, p.data());
}

void Schur::move(const Eigen::VectorXd& p, double* out) {
  const int coordinates = static_cast<int>(answers_.cols());
  moved_.setZero(coordinates);
  kernels::addWeighted(moved_.data(), answers_.data(), p.data(), size(), coordinates,
                       moved_.data());
  for (int i = 0; i < count_; ++i) out[i] += moved_[i];
}

}  // namespace ragdoll
