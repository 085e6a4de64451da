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
    Row row;
    row.kind = d == 0 ? Row::Kind::kNormal : Row::Kind::kTangent;
    row.source = source;
    row.count = end - begin;
    row.direction = directions[d];
    row.friction = c.friction;
    for (int k = begin; k < end; ++k) {
      row.particle[k - begin] = c.particle[k] - first_;
      row.gradient[k - begin] = c.weight[k] * directions[d];
    }
    rows_.push_back(row);
  }
}

void Schur::addLimit(const LimitRow& limit, int source, double compliance, double least) {
  Row row;
  row.kind = Row::Kind::kLimit;
  row.source = source;
  row.count = limit.count;
  row.compliance = compliance;
  row.least = least;
  for (int k = 0; k < limit.count; ++k) {
    row.particle[k] = limit.particle[k] - first_;
    row.gradient[k] = limit.gradient[k];
  }
  rows_.push_back(row);
}

void Schur::assemble(const StickRows& c, const StickSolver& sticks, const Eigen::MatrixXd& W) {
  const int m = size();
  columns_ = paddedWidth(m);
  K_.setZero(c.s, columns_);
  const double* D = sticks.D();
  for (int r = 0; r < m; ++r)
    for (int s = 0; s < c.s; ++s) {
      const double* bw = c.BW.data() + s * c.columns;
      Vec3 q = bw[rows_[r].particle[0]] * rows_[r].gradient[0];
      for (int k = 1; k < rows_[r].count; ++k) q += bw[rows_[r].particle[k]] * rows_[r].gradient[k];
      K_(s, r) = D[s] * q.x() + D[c.width + s] * q.y() + D[2 * c.width + s] * q.z();
    }
  Z_.resize(c.s, columns_);
  kernels::multiplyRows(sticks.inverse(), K_.data(), c.s, c.width, columns_, Z_.data());
  A_.setZero(m, columns_);
  free_.resize(m);
  answer_.resize(3, c.n);
  for (int i = 0; i < m; ++i) {
    const Row& row = rows_[i];
    answer_.setZero();  // of the free body to row i
    for (int k = 0; k < row.count; ++k)
      for (int j = 0; j < c.n; ++j) answer_.col(j) += W(j, row.particle[k]) * row.gradient[k];
    for (int j = i; j < m; ++j) {
      double a = 0;
      for (int l = 0; l < rows_[j].count; ++l)
        a += answer_.col(rows_[j].particle[l]).dot(rows_[j].gradient[l]);
      A_(i, j) = a;
    }
    free_[i] = A_(i, i);
  }
  kernels::subtractProducts(K_.data(), Z_.data(), c.s, m, columns_, A_.data());
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < i; ++j) A_(i, j) = A_(j, i);
    A_(i, i) += rows_[i].compliance;
  }
}

namespace {

/// One body's rows as projectedGaussSeidel wants them.
struct OneBody {
  const std::vector<Schur::Row>& rows;
  const PaddedRows& A;
  const Eigen::VectorXd& unheld;
  Eigen::VectorXd& w;

  int size() const { return static_cast<int>(rows.size()); }
  const Schur::Row& row(int i) const { return rows[i]; }
  double matrix(int i, int j) const { return A(i, j); }
  double free(int i) const { return unheld[i]; }
  double rate(int i) const { return w[i]; }
  void push(int i, double step) {
    kernels::addScaled(A.data() + i * A.cols(), step, static_cast<int>(A.cols()), w.data());
  }
};

}  // namespace

bool Schur::solve(const Eigen::VectorXd& b, Eigen::VectorXd& p) {
  w_.setZero(columns_);
  w_.head(size()) = b;
  OneBody rows{rows_, A_, free_, w_};
  return projectedGaussSeidel(rows, p);
}

void Schur::move(const StickRows& c, StickSolver& sticks, const Eigen::MatrixXd& W,
                 const Eigen::VectorXd& p, double* out) {
  impulse_.setZero(3, c.n);
  for (int r = 0; r < size(); ++r)
    for (int k = 0; k < rows_[r].count; ++k)
      impulse_.col(rows_[r].particle[k]) += p[r] * rows_[r].gradient[k];
  Eigen::Map<Points> moved(out, 3, c.n);
  for (int i = 0; i < c.n; ++i)
    if (!impulse_.col(i).isZero(0))
      for (int j = 0; j < c.n; ++j) moved.col(j) += W(i, j) * impulse_.col(i);
  lambda_.setZero(c.width);
  for (int s = 0; s < c.s; ++s)
    for (int r = 0; r < size(); ++r) lambda_[s] -= Z_(s, r) * p[r];
  sticks.move(c, lambda_.data(), 1, out);
}

double Schur::along(int i, const double* x) const {
  const Row& row = rows_[i];
  double sum = 0;
  for (int k = 0; k < row.count; ++k)
    sum += row.gradient[k].dot(Eigen::Map<const Vec3>(x + 3 * row.particle[k]));
  return sum;
}

}  // namespace ragdoll
