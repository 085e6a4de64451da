#include "core/loading/rigid_groups.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <numeric>
#include <set>

namespace ragdoll {
namespace {

constexpr double kFlatGroup =
    0.02;  ///< thinner than this share of its size, a group counts as flat
constexpr double kExactlyFlat = 1e-14;      ///< of its size: rounding
constexpr double kReach = 1.0;              ///< of invented points, in units of the group's radius
constexpr std::size_t kMaxCliques = 10000;  ///< a stick graph with more is no ragdoll

using Members = std::vector<int>;
using Graph = std::vector<std::set<int>>;

Points columns(const Points& x, const Members& members) {
  Points out(3, members.size());
  for (std::size_t i = 0; i < members.size(); ++i) out.col(i) = x.col(members[i]);
  return out;
}

Points centred(const Points& x) { return x.colwise() - x.rowwise().mean(); }

/// Maximal complete subgraphs [Bron1973, with pivoting].
void cliques(const Graph& graph, Members r, std::set<int> p, std::set<int> x,
             std::vector<Members>& out) {
  if (out.size() > kMaxCliques) return;
  if (p.empty() && x.empty()) {
    std::sort(r.begin(), r.end());
    out.push_back(r);
    return;
  }
  std::set<int> candidates = p;
  if (!p.empty()) {
    const int pivot = *p.begin();
    for (const int i : graph[pivot]) candidates.erase(i);
  }
  for (const int v : candidates) {
    Members rv = r;
    rv.push_back(v);
    std::set<int> pv, xv;
    for (const int i : graph[v]) {
      if (p.count(i)) pv.insert(i);
      if (x.count(i)) xv.insert(i);
    }
    cliques(graph, rv, pv, xv, out);
    p.erase(v);
    x.insert(v);
  }
}

Members shared(const Members& a, const Members& b) {
  Members out;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

/// Two rigid bodies that share three points not on a line, or as many as either has freedoms, are
/// one.
void mergeJoined(const Points& rest, std::vector<Members>& groups) {
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < groups.size() && !merged; ++i)
      for (std::size_t j = i + 1; j < groups.size() && !merged; ++j) {
        const Members common = shared(groups[i], groups[j]);
        const bool contained = common.size() == std::min(groups[i].size(), groups[j].size());
        if (!contained && affineRank(columns(rest, common)) < 2) continue;
        Members both;
        std::set_union(groups[i].begin(), groups[i].end(), groups[j].begin(), groups[j].end(),
                       std::back_inserter(both));
        groups[i] = both;
        groups.erase(groups.begin() + j);
        merged = true;
      }
  }
}

/// Affine combination of `points` (3 x k) that gives p: smallest weights that sum to one.
Eigen::RowVectorXd affineWeights(const Points& points, const Vec3& p) {
  Eigen::MatrixXd a(4, points.cols());
  a << Eigen::RowVectorXd::Ones(points.cols()), points.colwise() - p;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-9);
  solver.compute(a);
  return solver.solve(Eigen::Vector4d::Unit(0)).transpose();
}

/// Builds T and L group by group.
class MapBuilder {
 public:
  explicit MapBuilder(const Skeleton& s)
      : skeleton_(s),
        n_(s.size()),
        width_(s.size() + 4 * static_cast<int>(s.groups.size())),
        T_(Eigen::MatrixXd::Zero(n_, width_)),
        L_(Eigen::MatrixXd::Zero(width_, n_)),
        owner_(n_, -1) {}

  BaseMap build() {
    for (std::size_t g = 0; g < skeleton_.groups.size(); ++g) addGroup(static_cast<int>(g));
    for (int i = 0; i < n_; ++i)
      if (owner_[i] < 0) {
        T_(i, size_) = 1;
        L_(size_++, i) = 1;
      }
    for (const Stick& k : skeleton_.sticks)
      if (!insideGroup(k)) addStick(T_.row(k.a), T_.row(k.b), k.length, {k.a, k.b});
    BaseMap map;
    map.T = T_.leftCols(size_);
    map.L = L_.topRows(size_);
    map.sticks.resize(sticks_.size(), size_);
    map.length.resize(sticks_.size());
    map.ends = ends_;
    for (std::size_t i = 0; i < sticks_.size(); ++i) {
      map.sticks.row(i) = sticks_[i].head(size_);
      map.length[i] = lengths_[i];
    }
    return map;
  }

 private:
  struct FramePoint {
    Vec3 position;
    Eigen::RowVectorXd T;
    int owner;  ///< the earlier group that already holds it, or -1
  };

  bool insideGroup(const Stick& k) const {
    return std::any_of(skeleton_.groups.begin(), skeleton_.groups.end(), [&](const RigidGroup& g) {
      return std::count(g.particles.begin(), g.particles.end(), k.a) &&
             std::count(g.particles.begin(), g.particles.end(), k.b);
    });
  }

  void addStick(const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b, double length,
                std::pair<int, int> ends) {
    sticks_.push_back(a - b);
    lengths_.push_back(length);
    ends_.push_back(ends);
  }

  /// Shared points that are affinely independent, as many as there are.
  std::vector<FramePoint> sharedPoints(const RigidGroup& group) const {
    std::vector<FramePoint> frame;
    Members chosen;
    for (const int i : group.particles) {
      if (owner_[i] < 0) continue;
      Members more = chosen;
      more.push_back(i);
      if (affineRank(columns(skeleton_.rest, more)) < static_cast<int>(more.size()) - 1) continue;
      chosen = more;
      frame.push_back({skeleton_.rest.col(i), T_.row(i), owner_[i]});
      if (static_cast<int>(frame.size()) == group.rank + 1) break;
    }
    return frame;
  }

  void invent(const Vec3& position, const RigidGroup& group, std::vector<FramePoint>& frame) {
    const Eigen::RowVectorXd weights =
        affineWeights(columns(skeleton_.rest, group.particles), position);
    for (std::size_t k = 0; k < group.particles.size(); ++k)
      L_(size_, group.particles[k]) = weights[k];
    frame.push_back({position, Eigen::RowVectorXd::Unit(width_, size_), -1});
    ++size_;
  }

  /// Completes the frame to rank + 1 points.
  void completeFrame(const RigidGroup& group, std::vector<FramePoint>& frame) {
    const Points x = columns(skeleton_.rest, group.particles);
    Eigen::MatrixXd mass(x.cols(), x.cols());  // the group's share of the mass matrix, total one
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (Eigen::Index j = 0; j < x.cols(); ++j)
        mass(i, j) = skeleton_.M(group.particles[i], group.particles[j]);
    mass /= mass.sum();
    const Vec3 com = x * mass.rowwise().sum();
    Vec3 centre = frame.empty() ? com : frame[0].position;
    Eigen::Matrix3d beside =
        Eigen::Matrix3d::Identity();  // projects out what the shared points span
    for (std::size_t k = 1; k < frame.size(); ++k) {
      const Vec3 d = (beside * (frame[k].position - frame[0].position)).normalized();
      beside -= d * d.transpose();
    }
    if (frame.size() > 1) centre += (com - centre) - beside * (com - centre);
    const Points spread = beside * (x.colwise() - centre);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread * mass * spread.transpose());
    // As far out as the group reaches: a frame as thin as a thin group would be badly conditioned.
    const double size = kReach * (x.colwise() - centre).colwise().norm().maxCoeff();
    if (frame.empty()) invent(centre, group, frame);
    for (int k = 2; static_cast<int>(frame.size()) < group.rank + 1; --k)
      invent(centre + size * eigen.eigenvectors().col(k), group, frame);
  }

  void addGroup(int index) {
    const RigidGroup& group = skeleton_.groups[index];
    std::vector<FramePoint> frame = sharedPoints(group);
    completeFrame(group, frame);
    Points positions(3, frame.size());
    for (std::size_t k = 0; k < frame.size(); ++k) positions.col(k) = frame[k].position;
    for (const int i : group.particles) {
      if (owner_[i] >= 0) continue;
      owner_[i] = index;
      const Eigen::RowVectorXd weights = affineWeights(positions, skeleton_.rest.col(i));
      for (std::size_t k = 0; k < frame.size(); ++k) T_.row(i) += weights[k] * frame[k].T;
    }
    for (std::size_t a = 0; a < frame.size(); ++a)
      for (std::size_t b = a + 1; b < frame.size(); ++b)
        if (frame[a].owner < 0 || frame[a].owner != frame[b].owner)
          addStick(frame[a].T, frame[b].T, (frame[a].position - frame[b].position).norm(),
                   {-1, index});
  }

  const Skeleton& skeleton_;
  int n_, width_, size_ = 0;
  Eigen::MatrixXd T_, L_;
  std::vector<int> owner_;  ///< the group that placed a particle, or -1
  std::vector<Eigen::RowVectorXd> sticks_;
  std::vector<double> lengths_;
  std::vector<std::pair<int, int>> ends_;
};

}  // namespace

int affineRank(const Points& points) {
  if (points.cols() < 2) return 0;
  const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(centred(points)).singularValues();
  return static_cast<int>((s.array() > kFlatGroup * s[0] && s.array() > kMinLength).count());
}

std::vector<RigidGroup> findRigidGroups(const SkeletonSpec& spec, const Skeleton& skeleton) {
  std::vector<Members> found;
  for (std::size_t i = 0; i < spec.segments.size(); ++i)
    if (spec.segments[i].group && spec.segments[i].mass > 0) {
      Members m = skeleton.segments[i].allParticles();
      std::sort(m.begin(), m.end());
      found.push_back(m);
    }
  Graph graph(skeleton.size());
  for (const Stick& k : skeleton.sticks) {
    graph[k.a].insert(k.b);
    graph[k.b].insert(k.a);
  }
  std::set<int> all;
  for (int i = 0; i < skeleton.size(); ++i) all.insert(i);
  std::vector<Members> complete;
  cliques(graph, {}, all, {}, complete);
  for (const Members& m : complete)
    if (m.size() > 3 || (m.size() == 3 && affineRank(columns(skeleton.rest, m)) < 2))
      found.push_back(m);
  mergeJoined(skeleton.rest, found);
  std::sort(found.begin(), found.end(), [](const Members& a, const Members& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  });
  std::vector<RigidGroup> groups;
  for (const Members& m : found) groups.push_back({m, affineRank(columns(skeleton.rest, m))});
  return groups;
}

void flattenGroups(Skeleton& skeleton) {
  constexpr int kRounds = 200;  ///< groups that share points are projected in turn
  for (int round = 0; round < kRounds; ++round) {
    double moved = 0;
    for (const RigidGroup& g : skeleton.groups) {
      if (g.rank > 2) continue;
      const Points x = columns(skeleton.rest, g.particles);
      const Vec3 mean = x.rowwise().mean();
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(x.colwise() - mean, Eigen::ComputeThinU);
      const auto axes = svd.matrixU().leftCols(g.rank);
      const Points flat = (axes * (axes.transpose() * (x.colwise() - mean))).colwise() + mean;
      const double off = (flat - x).colwise().norm().maxCoeff();
      if (off < kExactlyFlat * svd.singularValues()[0]) continue;  // to the bit as the file has it
      for (std::size_t k = 0; k < g.particles.size(); ++k)
        skeleton.rest.col(g.particles[k]) = flat.col(k);
      moved = std::max(moved, off);
    }
    if (moved == 0) break;
  }
}

BaseMap baseMap(const Skeleton& skeleton) { return MapBuilder(skeleton).build(); }

}  // namespace ragdoll
