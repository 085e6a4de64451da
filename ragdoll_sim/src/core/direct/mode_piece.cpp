#include "core/direct/mode_piece.h"

#include <algorithm>
#include <cmath>

#include "core/direct/dormand_prince.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_spin.h"
#include "core/direct/moving_obstacles.h"

namespace ragdoll {
namespace {

using namespace dormand_prince;

void resize(const Mode& mode, ModePoint& point) {
  for (RowValues* values : {&point.x, &point.v, &point.a})
    if (values->size() != mode.size) values->setZero(mode.size);
}

}  // namespace

bool moveInMode(Island& island, double h, ModePoint& end, ModePiece& piece) {
  Mode& mode = island.s.mode;
  ModePoint& stage = mode.stage;
  resize(mode, stage);
  resize(mode, end);
  const Eigen::Index size = mode.start.x.size();
  piece.slopes.resize(kStages, 2 * size);
  piece.work = 0;
  const auto sum = [&](const double* weights, int count, ModePoint& out) {
    out.x = mode.start.x;
    out.v = mode.start.v;
    for (int j = 0; j < count; ++j) {
      out.x += (h * weights[j]) * piece.slopes.row(j).head(size).transpose();
      out.v += (h * weights[j]) * piece.slopes.row(j).tail(size).transpose();
    }
  };
  for (int i = 0; i < kStages; ++i) {
    ModePoint& point = i == 0 ? mode.start : stage;
    if (i > 0) {
      sum(kA[i], i, stage);
      if (!accelerateInMode(island, stage)) return false;
    }
    piece.slopes.row(i).head(size) = point.v.transpose();
    piece.slopes.row(i).tail(size) = point.a.transpose();
    piece.forces[i] = point.forces;
    piece.work += h * kB[i] * point.power;
  }
  sum(kB, kStages, end);
  if (!end.x.allFinite() || !projectPositions(island, end) ||
      !projectVelocities(island, end, false))
    return false;
  keepSpins(island, mode.start, h, end);
  return true;
}

double errorOfPiece(Island& island, double h, const ModePiece& piece) {
  Mode& mode = island.s.mode;
  const Eigen::Index size = mode.start.x.size();
  RowValues& error = mode.sample.a;
  error = kE[kStages] * mode.end.a;
  for (int j = 0; j < kStages; ++j) error += kE[j] * piece.slopes.row(j).tail(size).transpose();
  double worst = 0;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const Eigen::Map<const Points> of(error.data() + mode.offset[k], 3, island.bodies[k]->n);
    worst = std::max(worst, of.colwise().squaredNorm().maxCoeff());
  }
  return h * std::sqrt(worst);
}

double fastest(const Island& island, const ModePoint& point) {
  double most = 0;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const Body& body = *island.bodies[k];
    const Eigen::Map<const Points> v(point.v.data() + island.s.mode.offset[k], 3, body.n);
    const double own = std::sqrt(v.colwise().squaredNorm().maxCoeff());
    most = std::max(most, own + fastestObstacle(body));
  }
  return most;
}

void interpolate(const ModePoint& start, const ModePoint& end, double h, double share,
                 ModePoint& out) {
  const double s = share, s2 = s * s, s3 = s2 * s;
  // Hermite of degree 5: values, first and second derivatives at both ends.
  const double x1 = s3 * (10 - 15 * s + 6 * s2), v0 = s - s3 * (6 - 8 * s + 3 * s2),
               v1 = s3 * (-4 + 7 * s - 3 * s2), a0 = 0.5 * (s2 - s3 * (3 - 3 * s + s2)),
               a1 = 0.5 * s3 * (1 - 2 * s + s2);
  out.x = start.x + x1 * (end.x - start.x) + h * (v0 * start.v + v1 * end.v) +
          h * h * (a0 * start.a + a1 * end.a);
  // Of degree 3, by velocities and accelerations: a difference of positions over a piece of 1e-8 s
  // has 1e-8 m/s of rounding.
  out.v = start.v + s2 * (3 - 2 * s) * (end.v - start.v) +
          (h * s * (1 - s)) * ((1 - s) * start.a - s * end.a);
}

}  // namespace ragdoll
