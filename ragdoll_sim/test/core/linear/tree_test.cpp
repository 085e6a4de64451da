// Tangent coordinates of trees against the sticks' direct solution: the same answers, exact
// lengths.
#include "core/linear/tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/linear/stick_solver.h"
#include "core/linear/tree_build.h"
#include "core/linear/tree_solver.h"
#include "ragdoll_sim/core/trees.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/limbs.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kTreeStep = 1.0 / 120;  ///< [s]
constexpr double kSpeed = 1;             ///< [m/s] of the fastest particle

/// Bodies of rods, triangles and groups that hang on each other at random by one or two particles.
class RandomTree {
 public:
  explicit RandomTree(unsigned seed) : random_(seed) {
    spec_.name = "random";
    add(Vec3::Zero());
    const int links = 3 + static_cast<int>(random_() % 7);
    for (int k = 0; k < links; ++k) {
      const int kind = static_cast<int>(random_() % 4);
      if (kind == 3 && !groups_.empty())
        addFold();
      else if (kind >= 1)
        addRod(k);
      else
        addGroup();
    }
  }
  const SkeletonSpec& spec() const { return spec_; }

 private:
  double unit() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  int any() { return static_cast<int>(random_() % spec_.particles.size()); }
  int add(const Vec3& position) {
    const int i = static_cast<int>(spec_.particles.size());
    spec_.particles.push_back(particle("p" + std::to_string(i), position, 1 + 0.8 * unit()));
    return i;
  }
  Vec3 beside(int i) {
    Vec3 d(unit(), unit(), unit());
    return at(i) + (0.2 + 0.1 * unit()) * d.normalized();
  }
  Vec3 at(int i) const { return spec_.particles[i].position; }
  /// The same, and well off the line of two others: what is all but straight hardly resists a turn.
  Vec3 aside(int i, int j) {
    for (;;) {
      const Vec3 p = beside(i), a = p - at(i), b = p - at(j), c = at(i) - at(j);
      const double area = a.cross(b).norm();
      if (area > 0.5 * std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()})) return p;
    }
  }
  void join(const std::vector<int>& members) {
    std::vector<std::string> names;
    for (const int i : members) names.push_back(spec_.particles[i].name);
    connect(spec_, names);
  }
  void addRod(int k) {
    const int a = any(), b = add(beside(a));
    join({a, b});
    if (random_() % 2) return;
    SegmentSpec s =
        bone("bone" + std::to_string(k), spec_.particles[a].name, spec_.particles[b].name);
    s.mass = 2;
    s.com = 0.4;
    s.gyration = 0.3;
    spec_.segments.push_back(s);
  }
  void addGroup() {
    const int a = any();
    std::vector<int> members = {a, add(beside(a))};
    const int more = 1 + static_cast<int>(random_() % 2);  // a triangle or a tetrahedron
    for (int i = 0; i < more; ++i) members.push_back(add(aside(a, members.back())));
    join(members);
    groups_.push_back(members);
  }
  void addFold() {
    const std::vector<int> on = groups_[random_() % groups_.size()];
    std::vector<int> members = {on[on.size() - 2], on.back()};
    for (const auto& pair : folded_)  // two on one axis would be joined by a stick too many
      if (pair == std::pair(members[0], members[1])) return;
    folded_.push_back({members[0], members[1]});
    const int a = members[0];
    const int c = add(aside(a, members[1]));
    spec_.sticks.push_back(stick(spec_.particles[a].name, spec_.particles[c].name));
    spec_.sticks.push_back(stick(spec_.particles[members[1]].name, spec_.particles[c].name));
  }

  std::mt19937 random_;
  SkeletonSpec spec_;
  std::vector<std::vector<int>> groups_;
  std::vector<std::pair<int, int>> folded_;
};

Scene sceneWith(const std::string& model, const std::string& pin) {
  return parseScene(
      "ragdolls: [{model: " + model + "}]\n" + (pin.empty() ? "" : "pins: [" + pin + "]\n"),
      "test");
}

/// A body at random poses, with both solvers.
class Both {
 public:
  explicit Both(const Scene& scene, unsigned seed) : model_(buildModel(scene)), random_(seed) {
    const System& system = model_.systemOf(model_.ragdolls[0]);
    rows_ = system.direct.rows.get();
    tree_ = buildTree(model_.skeletons[0], system.pins);
    if (!tree_.isTree()) return;
    x_ = startState(model_).x;
    sticks_.resize(*rows_);
    solver_.resize(tree_);
    for (int turn = 0; turn < 20; ++turn) {
      solver_.setPose(x_.data());
      Points dx(3, x_.cols());
      const Points free = randomMotion(0.03);
      EXPECT_GT(solver_.freeMotion(free.data(), 0, dx.data()), 0);
      solver_.positions(x_.data());
    }
    solver_.setPose(x_.data());
    sticks_.setPose(*rows_, x_.data());
  }

  const Tree& tree() const { return tree_; }
  TreeSolver& solver() { return solver_; }

  /// Largest difference of the answers to forces, relative.
  double answerError() {
    const int n = rows_->n;
    double worst = 0;
    for (int i = 0; i < model_.skeletons[0].named; ++i) {
      const Vec3 force(1, -2, 3);
      Eigen::VectorXd ours(3 * n), theirs(rows_->coordinates);
      solver_.answer(&i, force.data(), 1, ours.data());
      sticks_.answer(*rows_, &i, force.data(), 1, theirs.data());
      const double size = std::max(1e-3, theirs.head(3 * n).norm());
      worst = std::max(worst, (ours - theirs.head(3 * n)).norm() / size);
    }
    return worst;
  }

  /// Largest difference of what an impulse on i moves j by, from rows and from answers, relative.
  double rowError() {
    const int n = model_.skeletons[0].named;
    double worst = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Vec3 f(0.3, 1, -2), g(1, 0.5, 2);
        Points moved(3, rows_->n);
        solver_.answer(&i, f.data(), 1, moved.data());
        TreeRow a, b;
        solver_.row(&i, f.data(), 1, a);
        solver_.row(&j, g.data(), 1, b);
        double product = 0;
        for (std::size_t k = 0; k < a.index.size(); ++k)
          for (std::size_t l = 0; l < b.index.size(); ++l)
            if (a.index[k] == b.index[l]) product += a.z[k] * b.z[l];
        const double expected = g.dot(moved.col(j));
        worst = std::max(worst, std::abs(product - expected) / std::max(1e-2, moved.norm()));
      }
    return worst;
  }

  /// [m] Largest difference from SHAKE's free motion. The sticks are solved to rounding.
  double motionError() {
    const Points free = randomMotion(kSpeed * kTreeStep);
    Points ours(3, x_.cols()), theirs = free;
    EXPECT_GT(solver_.freeMotion(free.data(), 0, ours.data()), 0);
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(rows_->width);
    const Points D0 = D(x_);
    for (int it = 0; it < 100; ++it) {
      const Points D1 = D(x_ + theirs);
      lambda.setZero();
      for (int s = 0; s < rows_->s; ++s)
        lambda[s] = 0.5 * (rows_->length2[s] - D1.col(s).squaredNorm());
      sticks_.solve(*rows_, lambda.data());
      sticks_.move(*rows_, lambda.data(), 1, theirs.data());
    }
    return (ours - theirs).cwiseAbs().maxCoeff();
  }

  /// Largest error of a stick's length after a step, relative.
  double stretch() {
    const Points free = randomMotion(kSpeed * kTreeStep);
    Points dx(3, x_.cols()), x1(3, x_.cols());
    EXPECT_GT(solver_.freeMotion(free.data(), 0, dx.data()), 0);
    solver_.positions(x1.data());
    double worst = 0;
    for (const Stick& k : model_.skeletons[0].sticks)
      worst = std::max(worst, std::abs((x1.col(k.a) - x1.col(k.b)).norm() / k.length - 1));
    return worst;
  }

 private:
  Points D(const Points& x) const {
    return x * model_.systemOf(model_.ragdolls[0]).direct.B.transpose();
  }
  /// Of particles as their groups allow it: all motions are W times something.
  Points randomMotion(double size) {
    std::uniform_real_distribution<double> unit(-1, 1);
    Points force(3, x_.cols());
    for (int i = 0; i < force.size(); ++i) force.data()[i] = unit(random_);
    Points dx = force * model_.systemOf(model_.ragdolls[0]).direct.W;
    return size / dx.cwiseAbs().maxCoeff() * dx;
  }

  Model model_;
  std::mt19937 random_;
  const StickRows* rows_ = nullptr;
  StickSolver sticks_;
  Tree tree_;
  TreeSolver solver_;
  Points x_;
};

void expectSame(Both& both) {
  ASSERT_TRUE(both.tree().isTree()) << both.tree().why_not;
  EXPECT_LT(both.answerError(), 1e-12);
  EXPECT_LT(both.rowError(), 1e-12);
  EXPECT_LT(both.motionError(), 1e-12);
  EXPECT_LT(both.stretch(), 5e-15);
}

TEST(Tree, OfAHumanAnswersAsItsSticksDo) {
  for (const char* model : {"human", "human_lumped", "human_thesis"})
    for (const char* pin : {"", "left_hand", "neck", "left_hip"}) {
      SCOPED_TRACE(std::string(model) + " " + pin);
      Both both(sceneWith(model, pin), 7);
      expectSame(both);
      EXPECT_LT(both.solver().condition(), 1e6);
    }
}

TEST(Tree, OfAHumanHasTwentyFiveCoordinatesAndShortRows) {
  const Model model = buildModel(sceneWith("human", ""));
  const Tree tree = buildTree(model.skeletons[0], {});
  EXPECT_EQ(tree.size, 25);
  EXPECT_EQ(tree.links.size(), 11u);
  for (int k = 0; k < tree.size; ++k) EXPECT_LE(tree.chain_begin[k + 1] - tree.chain_begin[k], 10);
}

TEST(Tree, OfLimbsAtRandomAnswersAsTheirSticksDo) {
  int folds = 0, turns = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    Both both(sceneOf(RandomTree(seed).spec()), seed);
    expectSame(both);
    for (const TreeLink& link : both.tree().links) {
      folds += link.kind == TreeLink::Kind::kFold;
      turns += link.kind == TreeLink::Kind::kTurn;
    }
  }
  EXPECT_GT(folds, 10);
  EXPECT_GT(turns, 10);
}

TEST(Tree, SaysWhatIsNone) {
  const Model model = buildModel(sceneWith("human", ""));
  EXPECT_NE(buildTree(model.skeletons[0], {0, 4}).why_not.find("pinned"), std::string::npos);
  SkeletonSpec square = oneParticle();
  square.particles = {particle("a", {0, 0, 0}), particle("b", {1, 0, 0}), particle("c", {1, 1, 0}),
                      particle("d", {0, 1, 0})};
  square.sticks = {stick("a", "b"), stick("b", "c"), stick("c", "d"), stick("d", "a")};
  const Model loop = buildModel(sceneOf(square));
  EXPECT_NE(buildTree(loop.skeletons[0], {}).why_not.find("loop"), std::string::npos);
}

TEST(Tree, IsToldOfEachModelAndItsPins) {
  const Model model = buildModel(sceneWith("human", "head"));
  const std::vector<TreeFinding> findings = findTrees(model);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].coordinates, 22);
  EXPECT_EQ(describe(findings[0]), "human with 1 pin: a tree of 22 coordinates");
  EXPECT_EQ(describe(findTrees(buildModel(sceneWith("human", "")))[0]),
            "human: a tree of 25 coordinates");
}

TEST(Tree, OfLooseParticlesHasARootEach) {
  SkeletonSpec two = oneStick();
  two.particles.push_back(particle("c", {3, 0, 0}));
  const Model model = buildModel(sceneOf(two));
  const Tree tree = buildTree(model.skeletons[0], {});
  EXPECT_TRUE(tree.isTree());
  EXPECT_EQ(tree.roots.size(), 2u);
  EXPECT_EQ(tree.size, 8);
}

}  // namespace
}  // namespace ragdoll
