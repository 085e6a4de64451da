#include "core/linear/joint_schur.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/linear/schur_sweeps.h"

namespace ragdoll {
/// As findBlocks and projectedGaussSeidel want them.
struct JointSchur::View {
  JointSchur& joint;
  const RowValues& b;

  int size() const { return joint.size(); }
  const Schur::Row& row(int i) const { return joint.row(i); }
  double matrix(int i, int j) const {
    return sum(i, [&](const Schur& s, int side) {
      return s.entry(joint.rows_[i].row[side], joint.rows_[j].row[side]);
    });
  }
  double free(int i) const {
    return sum(i, [&](const Schur& s, int side) { return s.free(joint.rows_[i].row[side]); });
  }
  double rate(int i) const {
    return b[i] +
           sum(i, [&](const Schur& s, int side) { return s.rate(joint.rows_[i].row[side]); });
  }
  void push(int i, int count, const double* step) {
    for (int side = 0; side < 2; ++side) {
      const int body = joint.rows_[i].body[side];
      if (body >= 0) joint.bodies_[body]->addRates(joint.rows_[i].row[side], count, step);
    }
  }

 private:
  template <class Part>
  double sum(int i, const Part& part) const {
    double total = 0;
    for (int side = 0; side < 2; ++side)
      if (joint.rows_[i].body[side] >= 0)
        total += part(*joint.bodies_[joint.rows_[i].body[side]], side);
    return total;
  }
};

void JointSchur::clear(bool shares_load) {
  shares_load_ = shares_load;
  bodies_.clear();
  first_.clear();
  rows_.clear();
}

int JointSchur::addBody(Schur& schur) {
  const int body = static_cast<int>(bodies_.size());
  bodies_.push_back(&schur);
  first_.push_back(size());
  const int first = size();
  rows_.resize(first + schur.size());
  for (int i = 0; i < schur.size(); ++i) rows_[first + i] = {{body, -1}, {i, -1}};
  return body;
}

void JointSchur::addShared(const Contact& contact, int body, int row, int other, int other_row) {
  for (int k = 0; k < rowsOf(contact); ++k)
    rows_.push_back({{body, other}, {row + k, other_row + k}});
}

const Schur::Row& JointSchur::row(int i) const {
  const int side = sideOf(i);
  return bodies_[rows_[i].body[side]]->row(rows_[i].row[side]);
}

double JointSchur::answer(int i) const {
  double sum = 0;
  for (int side = 0; side < 2; ++side)
    if (rows_[i].body[side] >= 0)
      sum += bodies_[rows_[i].body[side]]->entry(rows_[i].row[side], rows_[i].row[side]);
  return sum;
}

double JointSchur::entry(int i, int j) const {
  double sum = 0;
  for (int side = 0; side < 2; ++side)
    for (int other = 0; other < 2; ++other)
      if (rows_[i].body[side] >= 0 && rows_[i].body[side] == rows_[j].body[other])
        sum += bodies_[rows_[i].body[side]]->entry(rows_[i].row[side], rows_[j].row[other]);
  return sum;
}

double JointSchur::along(int i, const double* x, const std::vector<int>& at) const {
  double sum = 0;
  for (int side = 0; side < 2; ++side) {
    const int body = rows_[i].body[side];
    if (body >= 0) sum += bodies_[body]->along(rows_[i].row[side], x + at[body]);
  }
  return sum;
}

void JointSchur::soften(int i, double compliance) {
  const int side = sideOf(i);
  bodies_[rows_[i].body[side]]->soften(rows_[i].row[side], compliance);
}

void JointSchur::give(int i) {
  const int side = sideOf(i);
  bodies_[rows_[i].body[side]]->give(rows_[i].row[side]);
}

void JointSchur::lock(int i, bool locked) {
  const int side = sideOf(i);
  bodies_[rows_[i].body[side]]->lock(rows_[i].row[side], locked);
}

bool JointSchur::solve(const RowValues& b, RowValues& p, Sweeping sweeps) {
  bool settled = sweep(b, p, sweeps);
  if (!shares_load_ || !EqualSprings::anySlides(blocks(), p.data())) return settled;
  shared_ = b;
  const bool few = size() <= kMostIdle;
  if (!settled && !(few && takeLeft(sweeps.contradiction, b, p))) return false;
  settled = true;
  idle_.clear();
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; settled && k < kShareRounds; ++k) {
    if (few) findIdle(sweeps.contradiction, p);
    const double change = share(p, k > 0);
    if (change <= kShared) {
      holdInCones(p);
      break;
    }
    settled = sweep(shared_, p, sweeps);
    if (change > kShrinks * last) break;
    last = change;
  }
  return settled;
}

const std::vector<SchurBlock>& JointSchur::blocks() const {
  return isOneBody() ? bodies_[0]->blocks() : blocks_;
}

double JointSchur::rateOf(int i, const RowValues& b, const RowValues& p) const {
  double w = b[i];
  for (int j = 0; j < size(); ++j)
    if (p[j] != 0) w += (isOneBody() ? bodies_[0]->entry(i, j) : entry(i, j)) * p[j];
  return w;
}

bool JointSchur::takeLeft(double most, const RowValues& b, const RowValues& p) {
  for (const SchurBlock& block : blocks()) {
    if (!(block.answer > 0)) continue;
    const int i = block.row;
    const double limit = kSlides * block.friction * p[i];
    const bool sticks = block.tangent_answer > 0 && std::hypot(p[i + 1], p[i + 2]) < limit;
    const int rows = !(p[i] > 0) ? 0 : sticks ? 3 : 1;
    if (rows == 0 && rateOf(i, b, p) < -most) return false;
    for (int k = i; k < i + rows; ++k) {
      const double left = rateOf(k, b, p);
      if (!(std::abs(left) <= most)) return false;
      shared_[k] -= left;
    }
  }
  return true;
}

void JointSchur::findIdle(double most, const RowValues& p) {
  idle_.clear();
  for (const SchurBlock& block : blocks()) {
    const int i = block.row;
    if (!(block.answer > 0) || p[i] > 0) continue;
    const double left = rateOf(i, shared_, p);
    if (!(left < most)) continue;
    shared_[i] -= std::max(left, 0.0);
    idle_.push_back(i);
  }
}

void JointSchur::holdInCones(RowValues& p) const {
  for (const SchurBlock& b : blocks()) {
    if (!b.has_tangents) continue;
    const double limit = b.friction * std::max(0.0, p[b.row]);
    const double force = std::hypot(p[b.row + 1], p[b.row + 2]);
    if (force > limit) p.segment<2>(b.row + 1) *= limit / force;
  }
}

double JointSchur::share(RowValues& p, bool again) {
  if (!isOneBody())
    return springs_.share(
        blocks_, idle_, [this](int i, int j) { return entry(i, j); }, again, p.data());
  const Schur& s = *bodies_[0];
  return springs_.share(
      s.blocks(), idle_, [&s](int i, int j) { return s.entry(i, j); }, again, p.data());
}

bool JointSchur::sweep(const RowValues& b, RowValues& p, Sweeping sweeps) {
  if (isOneBody()) return bodies_[0]->solve(b, p, sweeps);
  for (Schur* s : bodies_) s->clearRates();
  View rows{*this, b};
  findBlocks(rows, blocks_);
  return projectedGaussSeidel(rows, blocks_, p.data(), sweeps);
}

bool JointSchur::solveOn(const RowValues& b, RowValues& p) {
  diagonal_.resize(size());
  for (int i = 0; i < size(); ++i) diagonal_[i] = answer(i);
  return batches_.solve(
      blocks(), diagonal_, [&](RowValues& impulses) { return sweep(b, impulses, Sweeps::kBatch); },
      p);
}

void JointSchur::split(const RowValues& p, std::vector<RowValues>& parts) const {
  if (parts.size() < bodies_.size()) parts.resize(bodies_.size());
  if (isOneBody()) {
    parts[0] = p;
    return;
  }
  for (std::size_t k = 0; k < bodies_.size(); ++k) parts[k].setZero(bodies_[k]->size());
  for (int i = 0; i < size(); ++i)
    for (int side = 0; side < 2; ++side)
      if (rows_[i].body[side] >= 0) parts[rows_[i].body[side]][rows_[i].row[side]] = p[i];
}

void JointSchur::addAnswer(double share, const std::vector<RowValues>& parts, RowValues& sum) {
  if (answers_.size() < bodies_.size()) answers_.resize(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (bodies_[k]->empty()) continue;
    answers_[k].resize(bodies_[k]->size());
    answers_[k].noalias() = bodies_[k]->matrix() * parts[k];
  }
  for (int i = 0; i < size(); ++i)
    for (int side = 0; side < 2; ++side)
      if (rows_[i].body[side] >= 0)
        sum[i] += share * answers_[rows_[i].body[side]][rows_[i].row[side]];
}

}  // namespace ragdoll
