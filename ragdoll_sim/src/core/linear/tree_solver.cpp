#include "core/linear/tree_solver.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ragdoll {
namespace {

constexpr int kMostNewton = 60;         ///< of freeMotion: each divides the error by some ten
constexpr double kConverged = 1e-15;    ///< [-] largest change of a sine
constexpr double kSettledTurn = 1e-12;  ///< [-] below, a change that grows again is rounding

}  // namespace

void TreeSolver::resize(const Tree& t) {
  if (tree_ == &t) return;
  tree_ = &t;
  memory_.assign(tree::Work<double>::count(t), 0.0);
  work_.take(t, memory_.data());
  x_.assign(3 * t.particles, 0.0);
  dx_.assign(3 * t.particles, 0.0);
  moved_.assign(3 * t.particles, 0.0);
  q_.assign(t.size, 0.0);
  y_.assign(t.size, 0.0);
  depth_.resize(t.size);
  identity_.resize(t.size);
  for (int k = 0; k < t.size; ++k) {
    depth_[k] = t.chain_begin[k + 1] - t.chain_begin[k];
    identity_[k] = k;
  }
}

void TreeSolver::setPose(const double* x) {
  std::copy_n(x, x_.size(), x_.begin());
  tree::setFrames(*tree_, x, work_);
  tree::setMatrix(*tree_, depth_.data(), work_);
  diagonal_.assign(work_.inverse, work_.inverse + tree_->size);
  rows_.assign(work_.H, work_.H + tree_->chain.size());
  tree::factorise(*tree_, 0.0, work_);
}

void TreeSolver::answer(const int* particle, const double* force, int count, double* out) {
  std::fill_n(work_.force, 3 * tree_->particles, 0.0);
  for (int k = 0; k < count; ++k)
    for (int c = 0; c < 3; ++c) work_.force[3 * particle[k] + c] += force[3 * k + c];
  tree::gather(*tree_, work_, y_.data());
  tree::solveUp(*tree_, work_, y_.data());
  tree::solveDown(*tree_, work_, y_.data());
  tree::move(*tree_, work_, y_.data(), out);
}

void TreeSolver::row(const int* particle, const double* gradient, int count, TreeRow& row) {
  const Tree& t = *tree_;
  std::vector<char> used(t.size, 0);
  std::fill_n(work_.force, 3 * t.particles, 0.0);
  for (int k = 0; k < count; ++k) {
    const int i = particle[k];
    for (int c = 0; c < 3; ++c) work_.force[3 * i + c] += gradient[3 * k + c];
    const TreeRoot& root = t.roots[t.root_of[i]];
    for (int c = 0; c < (root.pinned ? 0 : 3); ++c) used[root.first + c] = 1;
    for (int link = t.owner[i]; link >= 0; link = t.links[link].parent)
      for (int c = 0; c < t.links[link].coordinates(); ++c) used[t.links[link].first + c] = 1;
  }
  tree::gather(t, work_, y_.data());
  tree::solveUp(t, work_, y_.data());
  row.index.clear();
  row.z.clear();
  for (int k = 0; k < t.size; ++k)
    if (used[k]) {
      row.index.push_back(k);
      row.z.push_back(y_[k]);
    }
}

int TreeSolver::freeMotion(const double* free_dx, double guess, double* dx) {
  const Tree& t = *tree_;
  for (double& q : q_) q *= guess;
  tree::V3<double> shift{};
  for (const TreeRoot& root : t.roots)
    if (root.pinned) shift = tree::load3(free_dx + 3 * root.particle);
  double last = 1;
  for (int it = 1; it <= kMostNewton; ++it) {
    double off = 0, change = 0;
    tree::retract(t, q_.data(), shift, work_, dx, off);
    if (!(off < 1)) break;
    for (int i = 0; i < 3 * t.particles; ++i) dx_[i] = free_dx[i] - dx[i];
    tree::momentum(t, dx_.data(), work_);
    tree::gather(t, work_, y_.data());
    tree::solveUp(t, work_, y_.data());
    tree::solveDown(t, work_, y_.data());
    for (int k = 0; k < t.size; ++k) {
      q_[k] += y_[k];
      change = std::max(change, std::abs(y_[k]));
    }
    if (change < kConverged || (change < kSettledTurn && change >= last)) {
      tree::retract(t, q_.data(), shift, work_, dx, off);
      std::copy_n(dx, moved_.size(), moved_.begin());
      return off < 1 ? it : -1;
    }
    last = change;
  }
  std::fill(q_.begin(), q_.end(), 0.0);
  return -1;
}

void TreeSolver::positions(double* x1) const {
  tree::place(*tree_, work_, x_.data(), moved_.data(), x1);
}

void TreeSolver::restoreLengths(double* x) {
  tree::setFrames(*tree_, x, work_);
  std::fill_n(work_.turn, 9 * tree_->links.size(), 0.0);
  std::fill(moved_.begin(), moved_.end(), 0.0);
  std::copy_n(x, x_.size(), x_.begin());
  tree::place(*tree_, work_, x_.data(), moved_.data(), x);
}

double TreeSolver::condition() const {
  const Tree& t = *tree_;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(t.size, t.size);
  for (int k = 0; k < t.size; ++k) {
    H(k, k) = diagonal_[k];
    for (int i = t.chain_begin[k]; i < t.chain_begin[k + 1]; ++i)
      H(k, t.chain[i]) = H(t.chain[i], k) = rows_[i];
  }
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd e =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * H * scale.asDiagonal())
          .eigenvalues();
  return e.maxCoeff() / e.minCoeff();
}

}  // namespace ragdoll
