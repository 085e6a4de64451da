// Scratch that changes its size from step to step: as large as there are contacts and limits now.
// It has room from the start for more of them than a human body has at once, so that no step but
// the first asks for memory; where a step needs more than any before, it grows. Room that is never
// written to takes addresses, but no memory.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace ragdoll {

/// Rows of constraints that there is room for: a human body between obstacles has up to 90, two on
/// each other some 140.
constexpr int kRoomForRows = 192;
constexpr int kRoomForBodies = 8;  ///< of an island

/// A list of scratch. Room: for how many.
template <class T, int Room = kRoomForRows>
class Roomy : public std::vector<T> {
  using List = std::vector<T>;

 public:
  Roomy() { this->reserve(Room); }
  Roomy(const Roomy& other) : Roomy() { *this = other; }
  Roomy(const List& other) : Roomy() { *this = other; }
  Roomy(Roomy&& other) noexcept = default;
  ~Roomy() = default;
  Roomy& operator=(const Roomy& other) = default;
  Roomy& operator=(Roomy&& other) noexcept = default;
  Roomy& operator=(const List& other) {
    List::operator=(other);
    return *this;
  }
};

template <class T>
void append(const std::vector<T>& part, std::vector<T>& all) {
  all.insert(all.end(), part.begin(), part.end());
}

/// A map of the first values of a buffer that never shrinks; in expressions it is a Map. M: a
/// vector or a matrix of doubles with dynamic sizes. Eigen's own free their memory at each change
/// of size.
template <class M>
class Growing : public Eigen::Map<M> {
  using Map = Eigen::Map<M>;
  using Index = Eigen::Index;

 public:
  Growing() : Map(nullptr, 0, kColumns), buffer_(kRoomForRows * (kColumns ? 1 : kRoomForRows)) {}
  Growing(const Growing& other) : Growing() { *this = other; }
  Growing(Growing&& other) noexcept : Map(nullptr, 0, kColumns) { swap(other); }
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
      buffer_ = Eigen::VectorXd(std::max<Index>(rows * columns, 2 * buffer_.size()));
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
