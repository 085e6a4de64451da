// Systems of rows that press, as matrices: what a few bodies answer.
#pragma once

#include <cmath>
#include <vector>

#include "core/direct/mode_equalities.h"
#include "support/gravity.h"

namespace ragdoll::test {

/// A contact whose rows begin at `row`.
inline ModeBlock contactRows(int row, double friction) {
  ModeBlock block;
  block.row = row;
  block.friction = friction;
  return block;
}

/// A uniform rod of mass 1 and length 1 that leans, its upper end towards x: answers of its lower
/// end along z and x, by the moment of inertia 1/12.
struct LeaningRod {
  double cosine, sine;
  ModeMatrix A;
  ModeVector b = Vec3(-kG, 0, 0);

  explicit LeaningRod(double angle) : cosine(std::cos(angle)), sine(std::sin(angle)) {
    A = ModeMatrix::Identity(3, 3);
    A(0, 0) += 3 * cosine * cosine;
    A(2, 2) += 3 * sine * sine;
    A(0, 2) = A(2, 0) = -3 * sine * cosine;
  }
};

/// A block on feet that cannot move against each other: rows of each, of the same block.
struct BlockOnFeet {
  const double mass = 2;
  ModeMatrix A;
  ModeVector b;
  std::vector<ModeBlock> blocks;

  /// Feet at places along the first tangent, each with its friction; an acceleration along it.
  BlockOnFeet(const std::vector<double>& places, const std::vector<double>& friction, double pull) {
    const int feet = static_cast<int>(places.size());
    A.resize(3 * feet, 3 * feet);
    b.resize(3 * feet);
    double inertia = 0;
    for (const double x : places) inertia += mass / feet * x * x;
    for (int i = 0; i < feet; ++i) {
      for (int j = 0; j < feet; ++j) {
        A.block<3, 3>(3 * i, 3 * j) = Eigen::Matrix3d::Identity() / mass;
        A(3 * i, 3 * j) += places[i] * places[j] / inertia;
        A(3 * i + 2, 3 * j + 2) += places[i] * places[j] / inertia;
      }
      b.segment<3>(3 * i) = Vec3(-kG, pull, 0);
      blocks.push_back(contactRows(3 * i, friction[i]));
    }
  }
  double normals(const ModeVector& p) const {
    double sum = 0;
    for (const ModeBlock& foot : blocks) sum += p[foot.row];
    return sum;
  }
};

/// A table of 3 kg whose four feet slide the same way: more rows than it has ways to move, and
/// friction tilts it.
struct SlidingTable {
  static constexpr int kFeet = 4;
  const double mass = 3;
  const Vec3 inertia{0.2, 0.3, 0.4};
  Eigen::Matrix<double, 3, kFeet> feet;  ///< [m] from its centre of mass
  ModeMatrix A;
  ModeVector b;
  std::vector<ModeBlock> blocks;

  explicit SlidingTable(double friction, const Eigen::Vector2d& slip = {0.6, 0.8}) {
    feet << -0.5, -0.4, 0.4, 0.6, -0.3, 0.4, -0.4, 0.3, -0.5, -0.5, -0.5, -0.5;
    Eigen::Matrix<double, 6, 3 * kFeet> motions;  // that move a foot along z, x and y
    for (int i = 0; i < kFeet; ++i)
      for (int d = 0; d < 3; ++d) {
        const Vec3 along = Vec3::Unit((d + 2) % 3);
        motions.col(3 * i + d) << along, feet.col(i).cross(along);
      }
    Eigen::Matrix<double, 6, 1> answers;
    answers << Vec3::Constant(1 / mass), inertia.cwiseInverse();
    A = motions.transpose() * answers.asDiagonal() * motions;
    b.setZero(3 * kFeet);
    for (int i = 0; i < kFeet; ++i) {
      b[3 * i] = -kG;
      blocks.push_back(contactRows(3 * i, friction));
      blocks[i].presses = blocks[i].slips = true;
      blocks[i].slip = slip;
    }
  }
  /// [N], [N m] What presses, and how it turns the table.
  Vec3 force(const ModeVector& p) const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < kFeet; ++i) sum += at(p, i);
    return sum;
  }
  Vec3 moment(const ModeVector& p) const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < kFeet; ++i) sum += feet.col(i).cross(at(p, i));
    return sum;
  }

 private:
  static Vec3 at(const ModeVector& p, int i) { return {p[3 * i + 1], p[3 * i + 2], p[3 * i]}; }
};

}  // namespace ragdoll::test
