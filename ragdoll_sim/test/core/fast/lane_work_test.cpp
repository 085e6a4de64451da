#include "core/fast/lane_work.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>

#include "core/fast/lane_bodies.h"
#include "core/linear/tree_solver.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

/// z of a force of one along `axis` on a particle, as setAnswer has it.
std::vector<double> rowOf(const fast::FastBody& b, OneLane& w, int particle, int axis) {
  const fast::Feature& f = b.features[particle];
  double unit[3] = {0, 0, 0};
  unit[axis] = 1;
  std::fill_n(w.tree.force, 3 * b.tree.particles, 0.0);
  std::copy_n(unit, 3, w.tree.force + 3 * f.a);
  tree::gather(b.tree, w.tree, w.row);
  std::vector<double> z;
  for (const int k : f.row.index) z.push_back(w.row[k]);
  fast::eliminate<1>(w, f.row, z.data());
  return z;
}

/// A row's product with itself is what the point moves by: solved for all coordinates at once.
TEST(LaneWork, EliminatedRowsAnswerAsTheWholeTreeDoes) {
  LaneBodies one(sceneOf(limbs()));
  ASSERT_EQ(one.body.why_not, "");
  OneLane& w = one.predicted();
  TreeSolver solver;
  solver.resize(one.body.tree);
  solver.setPose(one.bodies[0].x.data());
  Points moved(3, one.body.tree.particles);
  for (int i = 0; i < one.body.particles; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      double answer = 0;
      for (const double z : rowOf(one.body, w, i, axis)) answer += z * z;
      const Vec3 force = Vec3::Unit(axis);
      solver.answer(&i, force.data(), 1, moved.data());
      EXPECT_NEAR(answer, moved(axis, i), 1e-12) << i;
    }
}

/// What links carry, by their moments and by a sum over particles: where a turn folds, hangs and is
/// hung on.
TEST(LaneWork, ProjectsWhatLinksMoveByAsParticlesDo) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    LaneBodies one(sceneOf(seed % 2 ? jointedLimbs() : limbs()));
    OneLane& w = one.predicted();
    const int size = one.body.tree.size;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-0.4, 0.4);
    for (int k = 0; k < size; ++k) w.q[k] = unit(random);
    fast::setPose(one.body, w);
    std::vector<double> sum(size);
    tree::momentum(one.body.tree, w.dx, w.tree);
    tree::gather(one.body.tree, w.tree, sum.data());
    tree::project(one.body.tree, w.tree, w.dx, w.done);
    for (int k = 0; k < size; ++k) EXPECT_NEAR(w.done[k], sum[k], 1e-12) << k;
  }
}

/// Where parts of memory begin.
template <class... Parts>
std::vector<std::uintptr_t> beginsOf(const Parts*... part) {
  return {reinterpret_cast<std::uintptr_t>(part)...};
}

/// Parts begin where a vector may and lie one behind the other within the room that was asked for.
template <class L>
void expectRoom(const fast::FastBody& b, int planes) {
  const std::size_t room = L::room(b, planes);
  std::vector<char> memory(room + 64);
  const L* w = L::in(memory.data() + 8, b, planes);  // memory as it comes
  const auto begins =
      beginsOf(w, w->tree.axes, w->x, w->v, w->dx, w->force, w->spare, w->q, w->y, w->total,
               w->goal, w->done, w->row, w->last_press, w->offset, w->contacts, w->limits,
               w->row_of, w->obstacle_of, w->pressing, w->z);
  EXPECT_TRUE(std::is_sorted(begins.begin(), begins.end()));
  for (const std::uintptr_t begin : begins) EXPECT_EQ(begin % 64, 0u);
  const std::size_t rows = b.features.size() * (fast::kSlots + planes);
  const auto ends = beginsOf(w->z + (3 * rows + b.limits.size()) * b.longest_row);
  EXPECT_LE(ends[0], beginsOf(memory.data() + memory.size())[0]);
}

TEST(LaneWork, FitsIntoItsRoom) {
  const LaneBodies small(sceneOf(oneParticle())), large(sceneOf(jointedLimbs()));
  for (const LaneBodies* one : {&small, &large})
    for (const int planes : {0, 1, 3}) {
      expectRoom<OneLane>(one->body, planes);
      expectRoom<fast::LaneWork<float, 4>>(one->body, planes);
      expectRoom<fast::LaneWork<double, 8>>(one->body, planes);
    }
}

}  // namespace
}  // namespace ragdoll
