#include "core/linear/tree_build.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "ragdoll_sim/core/names.h"

namespace ragdoll {
namespace {

constexpr double kThinPart = 1e-6;  ///< of its size: thinner, points are on a line or in a point
constexpr int kMostRoots = 200;     ///< particles that are tried as root; a long rope has more
constexpr double kNoMass = 1e-14;   ///< of the largest mass: rounding

using Members = std::vector<int>;

/// A rigid thing of the skeleton: a rod, a group, a triangle of rods.
struct TreePart {
  Members particles;
  int rank = 1;
};

int rankOf(const Points& rest, const Members& members) {
  if (members.size() < 2) return 0;
  Points x(3, members.size());
  for (std::size_t i = 0; i < members.size(); ++i) x.col(i) = rest.col(members[i]);
  x.colwise() -= x.rowwise().mean().eval();
  const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(x).singularValues();
  return static_cast<int>((s.array() > kThinPart * s[0] && s.array() > kMinLength).count());
}

bool holds(const TreePart& part, int i) {
  return std::binary_search(part.particles.begin(), part.particles.end(), i);
}

/// Groups; then triangles of what holds two particles at their distance; then the other rods.
std::vector<TreePart> partsOf(const Skeleton& s) {
  std::vector<TreePart> parts;
  for (const RigidGroup& g : s.groups) parts.push_back({g.particles, rankOf(s.rest, g.particles)});
  const std::size_t groups = parts.size();
  std::set<std::pair<int, int>> rods, edges;
  std::vector<std::set<int>> next(s.size());
  const auto join = [&](int a, int b) {
    edges.insert({std::min(a, b), std::max(a, b)});
    next[a].insert(b);
    next[b].insert(a);
  };
  for (const TreePart& g : parts)
    for (const int a : g.particles)
      for (const int b : g.particles)
        if (a < b) join(a, b);
  for (const Stick& k : s.sticks) {
    if (edges.count({std::min(k.a, k.b), std::max(k.a, k.b)})) continue;
    rods.insert({std::min(k.a, k.b), std::max(k.a, k.b)});
    join(k.a, k.b);
  }
  std::set<std::pair<int, int>> used;
  std::set<Members> triangles;
  for (const auto& [a, b] : rods)
    for (const int c : next[a]) {
      if (!next[b].count(c)) continue;
      Members m = {a, b, c};
      std::sort(m.begin(), m.end());
      used.insert({a, b});
      triangles.insert(m);
    }
  for (const Members& m : triangles) parts.push_back({m, rankOf(s.rest, m)});
  for (const auto& [a, b] : rods)
    if (!used.count({a, b})) parts.push_back({{a, b}, 1});
  // A triangle inside a group says nothing new.
  for (std::size_t i = parts.size(); i-- > groups;)
    for (std::size_t g = 0; g < groups; ++g)
      if (std::includes(parts[g].particles.begin(), parts[g].particles.end(),
                        parts[i].particles.begin(), parts[i].particles.end())) {
        parts.erase(parts.begin() + i);
        break;
      }
  return parts;
}

class TreeBuilder {
 public:
  TreeBuilder(const Skeleton& s, const std::vector<int>& pins)
      : s_(s), pins_(pins), parts_(partsOf(s)), of_(s.size()) {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      for (const int p : parts_[i].particles) of_[p].push_back(static_cast<int>(i));
  }

  Tree build() {
    if (pins_.size() > 1) return noTree("more than one particle is pinned");
    if (!pins_.empty()) {
      place(pins_[0], true);
    } else {
      place(bestRoot(), false);
    }
    for (int i = 0; i < s_.size() && tree_.why_not.empty(); ++i)
      if (tree_.root_of[i] < 0) place(i, false);
    if (!tree_.why_not.empty()) return noTree(tree_.why_not);
    number();
    addMasses();
    return tree_.why_not.empty() ? tree_ : noTree(tree_.why_not);
  }

 private:
  static Tree noTree(const std::string& why) {
    Tree none;
    none.why_not = why;
    return none;
  }

  void clear() {
    tree_ = Tree();
    tree_.particles = s_.size();
    tree_.owner.assign(s_.size(), -1);
    tree_.owner_point.assign(s_.size(), -1);
    tree_.root_of.assign(s_.size(), -1);
    part_link_.assign(parts_.size(), -1);
    link_part_.clear();
  }

  /// The particle from which rows are shortest: contacts cost their length.
  int bestRoot() {
    const int step = 1 + s_.size() / kMostRoots;
    int best = 0;
    double least = -1;
    for (int i = 0; i < s_.size(); i += step) {
      clear();
      place(i, false);
      if (!tree_.why_not.empty()) break;
      double sum = 0;
      std::vector<int> depth(tree_.links.size());
      for (std::size_t j = 0; j < tree_.links.size(); ++j) {
        const TreeLink& link = tree_.links[j];
        depth[j] = link.coordinates() + (link.parent < 0 ? 3 : depth[link.parent]);
        sum += depth[j] * (link.points_end - link.points_begin);
      }
      if (least < 0 || sum < least) least = sum, best = i;
    }
    clear();
    return best;
  }

  /// A root, and all that hangs on it, the nearest first.
  void place(int particle, bool pinned) {
    if (tree_.particles == 0) clear();
    TreeRoot root;
    root.particle = particle;
    root.pinned = pinned;
    tree_.root_of[particle] = static_cast<int>(tree_.roots.size());
    tree_.roots.push_back(root);
    std::vector<int> reached = {particle};
    for (std::size_t k = 0; k < reached.size() && tree_.why_not.empty(); ++k)
      for (const int part : of_[reached[k]]) {
        if (part_link_[part] >= 0) continue;
        addLink(part, reached[k]);
        if (!tree_.why_not.empty()) return;
        const TreeLink& link = tree_.links.back();
        for (int i = link.points_begin; i < link.points_end; ++i)
          reached.push_back(tree_.points[i].particle);
      }
  }

  std::string nameOf(const TreePart& part) const {
    std::vector<std::string> names;
    for (const int i : part.particles) names.push_back(s_.particles[i]);
    return joined(names);
  }

  /// The link, placed before, of which all of `shared` are particles; -1: none.
  int commonLink(const Members& shared) const {
    for (std::size_t j = 0; j < tree_.links.size(); ++j) {
      const TreePart& part = parts_[link_part_[j]];
      if (std::all_of(shared.begin(), shared.end(), [&](int i) { return holds(part, i); }))
        return static_cast<int>(j);
    }
    return -1;
  }

  void addLink(int index, int reached) {
    const TreePart& part = parts_[index];
    Members shared;
    for (const int i : part.particles)
      if (tree_.root_of[i] >= 0) shared.push_back(i);
    TreeLink link;
    link.root = tree_.root_of[reached];
    link.attach = reached;
    link.parent = tree_.owner[reached];
    if (shared.size() == 1) {
      link.kind = part.rank == 1 ? TreeLink::Kind::kPointer : TreeLink::Kind::kTurn;
    } else {
      link.parent = commonLink(shared);
      if (link.parent < 0 || part.rank == 1 || rankOf(s_.rest, shared) != 1 ||
          tree_.links[link.parent].kind == TreeLink::Kind::kPointer) {
        tree_.why_not = nameOf(part) + " close a loop";
        return;
      }
      link.kind = TreeLink::Kind::kFold;
      for (const int i : shared)  // a point of the parent itself, not of what that folds on
        if (tree_.owner[i] == link.parent || tree_.links[link.parent].attach == i) link.attach = i;
    }
    setFrame(part, shared, link);
    if (link.parent >= 0 && tree_.links[link.parent].attach != link.attach)
      link.at = tree_.owner_point[link.attach];
    addPoints(part, link);
    part_link_[index] = static_cast<int>(tree_.links.size());
    link_part_.push_back(index);
    tree_.links.push_back(link);
  }

  Vec3 rest(int i) const { return s_.rest.col(i); }

  /// Base points far apart, so that the frame is well defined.
  void setFrame(const TreePart& part, const Members& shared, TreeLink& link) {
    const Vec3 o = rest(link.attach);
    if (link.kind != TreeLink::Kind::kFold) {
      double far = -1;
      for (const int i : part.particles)
        if ((rest(i) - o).norm() > far) far = (rest(i) - o).norm(), link.base[0] = i;
    } else {
      double far = -1;
      for (const int i : shared)
        if ((rest(i) - o).norm() > far) far = (rest(i) - o).norm(), link.base[0] = i;
    }
    const Vec3 e = rest(link.base[0]) - o;
    link.base_reach = part.rank == 1 && part.particles.size() == 2 ? rodLength(part) : e.norm();
    axes_.col(0) = e.normalized();
    if (link.kind == TreeLink::Kind::kPointer) return;
    double widest = -1;
    for (const int i : part.particles) {
      const double width = e.cross(rest(i) - o).norm();
      if (width > widest) widest = width, link.base[1] = i;
    }
    const Vec3 f = rest(link.base[1]) - o;
    axes_.col(2) = e.cross(f).normalized();
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
    link.base_side = f.dot(axes_.col(1));
    link.base_along = f.dot(axes_.col(0));
  }

  double rodLength(const TreePart& part) const {
    for (const Stick& k : s_.sticks)
      if (std::minmax(k.a, k.b) == std::minmax(part.particles[0], part.particles[1]))
        return k.length;
    return (rest(part.particles[0]) - rest(part.particles[1])).norm();
  }

  void addPoints(const TreePart& part, TreeLink& link) {
    link.points_begin = static_cast<int>(tree_.points.size());
    for (const int i : part.particles) {
      if (tree_.root_of[i] >= 0) continue;
      TreePoint point;
      point.particle = i;
      const Vec3 d = rest(i) - rest(link.attach);
      if (link.kind == TreeLink::Kind::kPointer) {
        point.at[0] = i == link.base[0] ? link.base_reach : d.dot(axes_.col(0));
      } else {
        for (int c = 0; c < 3; ++c) point.at[c] = d.dot(axes_.col(c));
      }
      tree_.owner[i] = static_cast<int>(tree_.links.size());
      tree_.owner_point[i] = static_cast<int>(tree_.points.size());
      tree_.root_of[i] = link.root;
      tree_.points.push_back(point);
    }
    link.points_end = static_cast<int>(tree_.points.size());
  }

  /// Coordinates, root first, and the ancestors of each.
  void number() {
    for (TreeRoot& root : tree_.roots) {
      if (root.pinned) continue;
      root.first = tree_.size;
      tree_.size += 3;
    }
    for (TreeLink& link : tree_.links) {
      link.first = tree_.size;
      tree_.size += link.coordinates();
    }
    std::vector<Members> above(tree_.size);
    const auto chainOf = [&](int first, int count, const Members& base) {
      Members all = base;
      for (int k = first; k < first + count; ++k) {
        above[k] = all;
        all.push_back(k);
      }
    };
    for (const TreeRoot& root : tree_.roots)
      if (!root.pinned) chainOf(root.first, 3, {});
    for (const TreeLink& link : tree_.links) {
      Members base;
      const TreeRoot& root = tree_.roots[link.root];
      if (link.parent >= 0) {
        const int last =
            tree_.links[link.parent].first + tree_.links[link.parent].coordinates() - 1;
        base = above[last];
        base.push_back(last);
      } else if (!root.pinned) {
        base = {root.first, root.first + 1, root.first + 2};
      }
      chainOf(link.first, link.coordinates(), base);
    }
    tree_.chain_begin.push_back(0);
    for (const Members& a : above) {
      tree_.chain.insert(tree_.chain.end(), a.begin(), a.end());
      tree_.chain_begin.push_back(static_cast<int>(tree_.chain.size()));
    }
  }

  /// In the frame of a link whose attach is at zero.
  Vec3 inLink(int link, int particle) const {
    const TreeLink& l = tree_.links[link];
    if (tree_.owner[particle] == link) {
      const TreePoint& p = tree_.points[tree_.owner_point[particle]];
      return {p.at[0], p.at[1], p.at[2]};
    }
    if (particle == l.attach) return Vec3::Zero();
    return {(rest(particle) - rest(l.attach)).norm() * sideOf(l, particle), 0, 0};  // on the fold
  }
  double sideOf(const TreeLink& l, int particle) const {
    const Vec3 e = rest(l.base[0]) - rest(l.attach);
    return e.dot(rest(particle) - rest(l.attach)) < 0 ? -1 : 1;
  }

  static void addMoments(double m, const Vec3& a, const Vec3& b, TreeLink& link) {
    link.mass += m;
    for (int c = 0; c < 3; ++c) link.moment[c] += m * 0.5 * (a[c] + b[c]);
    const int r[6] = {0, 1, 2, 0, 0, 1}, c[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; ++k) link.second[k] += m * 0.5 * (a[r[k]] * b[c[k]] + b[r[k]] * a[c[k]]);
  }

  /// Each entry of the mass matrix belongs to one link; what hangs on a link is a mass at its
  /// point.
  void addMasses() {
    const Eigen::MatrixXd& M = s_.M;
    const double none = kNoMass * M.diagonal().maxCoeff();
    tree_.mass.assign(s_.size(), 0.0);
    for (int i = 0; i < s_.size(); ++i) {
      tree_.mass_begin.push_back(static_cast<int>(tree_.masses.size()));
      for (int j = 0; j < s_.size(); ++j) {
        if (std::abs(M(i, j)) <= none) continue;
        tree_.masses.push_back({i, j, M(i, j)});
        tree_.mass[i] += M(i, j);
        const int link =
            i == j ? tree_.owner[i] : commonLink(i < j ? Members{i, j} : Members{j, i});
        if (link < 0 && i != j) {
          tree_.why_not = "the masses of " + s_.particles[i] + " and " + s_.particles[j] +
                          " are coupled and nothing holds them together";
          return;
        }
        if (link < 0)
          tree_.roots[tree_.root_of[i]].mass += M(i, j);
        else
          addMoments(M(i, j), inLink(link, i), inLink(link, j), tree_.links[link]);
      }
    }
    tree_.mass_begin.push_back(static_cast<int>(tree_.masses.size()));
    for (std::size_t j = tree_.links.size(); j-- > 0;) {
      const TreeLink& link = tree_.links[j];
      if (link.parent < 0) {
        tree_.roots[link.root].mass += link.mass;
      } else if (link.kind == TreeLink::Kind::kFold) {
        tree_.links[link.parent].mass += link.mass;  // its moments turn against the parent's
      } else {
        const Vec3 at = inLink(link.parent, link.attach);
        addMoments(link.mass, at, at, tree_.links[link.parent]);
      }
    }
  }

  const Skeleton& s_;
  const std::vector<int>& pins_;
  std::vector<TreePart> parts_;
  std::vector<std::vector<int>> of_;  ///< per particle: its parts
  std::vector<int> part_link_, link_part_;
  Eigen::Matrix3d axes_;  ///< of the link that is being added
  Tree tree_;
};

}  // namespace

Tree buildTree(const Skeleton& skeleton, const std::vector<int>& pins) {
  return TreeBuilder(skeleton, pins).build();
}

}  // namespace ragdoll
