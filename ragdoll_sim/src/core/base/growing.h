// Matrices of scratch that change their size from step to step: as large as there are contacts and
// limits now. Eigen's own free their memory at each change of size; these keep it, so that a step
// allocates only where it needs more than any step before.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace ragdoll {

/// A map of the first values of a buffer that never shrinks; in expressions it is a Map. M: a
/// vector or a matrix of doubles with dynamic sizes.
template <class M>
class Growing : public Eigen::Map<M> {
  using Map = Eigen::Map<M>;
  using Index = Eigen::Index;

 public:
  Growing() : Map(nullptr, 0, kColumns) {}
  Growing(const Growing& other) : Growing() { *this = other; }
  Growing(Growing&& other) noexcept : Growing() { swap(other); }
  ~Growing() = default;

  Growing& operator=(const Growing& other) { return assign(other); }
  Growing& operator=(Growing&& other) noexcept {
    swap(other);
    return *this;
  }
  template <class Other>
  Growing& operator=(const Eigen::DenseBase<Other>& other) {
    return assign(other);
  }

  /// What is in it afterwards is not defined.
  void resize(Index rows, Index columns = kColumns) {
    if (rows * columns > buffer_.size())
      buffer_.resize(std::max<Index>(rows * columns, 2 * buffer_.size()));
    look(rows, columns);
  }
  void setZero(Index rows, Index columns = kColumns) {
    resize(rows, columns);
    Map::setZero();
  }

 private:
  static constexpr Index kColumns = M::IsVectorAtCompileTime ? 1 : 0;

  template <class Other>
  Growing& assign(const Other& other) {
    resize(other.rows(), other.cols());
    Map::operator=(other.derived());
    return *this;
  }
  void look(Index rows, Index columns) {
    new (static_cast<Map*>(this)) Map(buffer_.data(), rows, columns);
  }
  void swap(Growing& other) {
    const Index rows = this->rows(), columns = this->cols();
    buffer_.swap(other.buffer_);
    look(other.rows(), other.cols());
    other.look(rows, columns);
  }

  Eigen::VectorXd buffer_;
};

/// As many values as there are rows of constraints now.
using RowValues = Growing<Eigen::VectorXd>;

}  // namespace ragdoll
