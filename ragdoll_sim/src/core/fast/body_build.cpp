#include "core/fast/body_build.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/fast/constants.h"
#include "core/linear/tree_build.h"
#include "core/linear/tree_kernels.h"
#include "ragdoll_sim/core/direction.h"

namespace ragdoll::fast {
namespace {

bool areSame(const LinkVector& a, const LinkVector& b) {
  return a.link == b.link && std::equal(a.c, a.c + 3, b.c);
}

bool swingAlike(const CarriedDirection& a, const CarriedDirection& b) {
  bool alike = a.base.link == b.base.link && a.swings == b.swings;
  for (int k = 0; alike && k < a.swings; ++k)
    alike = areSame(a.swing[k].bone, b.swing[k].bone) &&
            std::equal(a.swing[k].axis, a.swing[k].axis + 3, b.swing[k].axis);
  return alike;
}

/// Whether their references' bases see their children alike (SeenChild).
bool seeAlike(const FastLimit& a, const FastLimit& b) {
  return swingAlike(a.reference, b.reference) && swingAlike(a.child, b.child) &&
         areSame(a.child.base, b.child.base);
}

class BodyBuilder {
 public:
  BodyBuilder(const Skeleton& s, const std::vector<int>& pins) : s_(s) {
    body_.tree = buildTree(s, pins);
    body_.why_not = body_.tree.why_not;
  }

  FastBody build() {
    if (!body_.why_not.empty()) return body_;
    const Tree& t = body_.tree;
    if (t.roots.size() > 1) return notFor("its particles do not hang together");
    for (int k = 0; k < t.size; ++k) body_.depth.push_back(t.chain_begin[k + 1] - t.chain_begin[k]);
    std::vector<double> memory(tree::Work<double>::count(t));
    work_.take(t, memory.data());
    tree::setFrames(t, s_.rest.data(), work_);
    for (const Limit& limit : s_.limits) addLimit(limit);
    for (int i = 0; i < s_.named; ++i) addParticle(i);
    body_.particles = static_cast<int>(body_.features.size());
    for (const Stick& k : s_.sticks)
      if (k.a < s_.named && k.b < s_.named) addStick(k);
    if (!s_.limits.empty() && !ok_) return notFor("a joint's directions are not its links'");
    return body_;
  }

 private:
  FastBody notFor(const std::string& why) const {
    FastBody none;
    none.why_not = why;
    return none;
  }

  int pointOf(int link, int particle) const {
    const TreeLink& l = body_.tree.links[link];
    for (int i = l.points_begin; i < l.points_end; ++i)
      if (body_.tree.points[i].particle == particle) return i;
    return -1;
  }
  /// As Feature::at.
  int placeOf(int link, int particle) const {
    const TreeLink& l = body_.tree.links[link];
    const int point = pointOf(link, particle);
    return point < 0 && l.attach != particle ? Feature::kOnAxis : point;
  }
  /// Placed by the link, or on its axis.
  bool isOf(int link, int particle) const {
    const TreeLink& l = body_.tree.links[link];
    return l.attach == particle || pointOf(link, particle) >= 0 ||
           (l.kind == TreeLink::Kind::kFold && l.base[0] == particle);
  }
  int linkWith(std::initializer_list<int> particles) const {
    for (std::size_t j = 0; j < body_.tree.links.size(); ++j)
      if (std::all_of(particles.begin(), particles.end(),
                      [&](int i) { return isOf(static_cast<int>(j), i); }))
        return static_cast<int>(j);
    return -1;
  }

  /// A direction of the rest pose, fixed in a link.
  LinkVector fixed(int link, const Vec3& rest) {
    LinkVector v;
    v.link = link;
    ok_ = ok_ && link >= 0;
    if (link < 0) return v;
    const double* axes = work_.axes + 9 * link;
    for (int k = 0; k < 3; ++k) v.c[k] = rest.dot(Eigen::Map<const Vec3>(axes + 3 * k));
    if (body_.tree.links[link].kind == TreeLink::Kind::kPointer) {
      v.c[0] = v.c[0] < 0 ? -1 : 1;
      v.c[1] = v.c[2] = 0;
    }
    return v;
  }

  LinkVector bone(int from, int to) {
    const Vec3 d = s_.rest.col(to) - s_.rest.col(from);
    return fixed(linkWith({from, to}), d.normalized());
  }

  CarriedDirection carriedBy(const Direction& d) {
    CarriedDirection out;
    if (d.bone) {
      out.base = bone(d.base[0], d.base[1]);
    } else {
      const int link = linkWith({d.base[0], d.base[1], d.base[2]});
      out.base = fixed(link, baseDirection(d, d.c, s_.rest.data()));
      for (int k = 0; k < d.swings; ++k) {
        const LinkVector axis = fixed(link, baseDirection(d, d.swing[k].axis, s_.rest.data()));
        std::copy_n(axis.c, 3, out.swing[k].axis);
      }
    }
    out.swings = d.swings;
    for (int k = 0; k < d.swings; ++k) out.swing[k].bone = bone(d.swing[k].from, d.swing[k].to);
    return out;
  }

  void addCoordinates(int link, std::set<int>& all) const {
    const Tree& t = body_.tree;
    if (link < 0) {
      const TreeRoot& root = t.roots[0];
      for (int c = 0; c < (root.pinned ? 0 : 3); ++c) all.insert(root.first + c);
      return;
    }
    const int last = t.links[link].first + t.links[link].coordinates() - 1;
    all.insert(last);
    all.insert(t.chain.begin() + t.chain_begin[last], t.chain.begin() + t.chain_begin[last + 1]);
  }
  void addCoordinates(const CarriedDirection& d, std::set<int>& all) const {
    addCoordinates(d.base.link, all);
    for (int k = 0; k < d.swings; ++k) addCoordinates(d.swing[k].bone.link, all);
  }
  RowShape shapeOf(const std::set<int>& all) {
    const Tree& t = body_.tree;
    RowShape row;
    row.index.assign(all.begin(), all.end());
    for (const int above : row.index) {
      row.terms_begin.push_back(static_cast<int>(row.terms.size()));
      for (int i = row.size() - 1; i >= 0; --i) {
        const int below = row.index[i], begin = t.chain_begin[below];
        const auto end = t.chain.begin() + t.chain_begin[below + 1];
        const auto found = std::find(t.chain.begin() + begin, end, above);
        if (found != end) row.terms.push_back({static_cast<int>(found - t.chain.begin()), i});
      }
    }
    row.terms_begin.push_back(static_cast<int>(row.terms.size()));
    if (!all.empty() &&
        t.chain_begin[*all.rbegin() + 1] - t.chain_begin[*all.rbegin()] + 1 == row.size())
      for (const int k : row.index) row.chain.push_back(t.chain_begin[k]);
    body_.longest_row = std::max(body_.longest_row, row.size());
    return row;
  }

  void addLimit(const Limit& limit) {
    FastLimit f;
    f.turn = limit.kind != Limit::Kind::kWithin;
    f.reference = carriedBy(limit.reference);
    f.child = carriedBy(limit.child);
    f.sin_angle = limit.sin_angle;
    f.cos_angle = limit.cos_angle;
    f.scale = f.turn ? 1 : 1 / std::max(limit.sin_angle, kLeastSine);
    f.compliance = limit.compliance;
    f.damping = limit.damping;
    f.joint = limit.joint;
    std::set<int> all;
    if (f.turn) f.normal = carriedBy(limit.normal);
    if (!ok_) return;
    addCoordinates(f.reference, all);
    addCoordinates(f.child, all);
    if (f.turn) addCoordinates(f.normal, all);
    f.row = shapeOf(all);
    if (!body_.limits.empty())
      f.group = body_.limits.back().group + (seeAlike(f, body_.limits.back()) ? 0 : 1);
    body_.limits.push_back(f);
  }

  void addParticle(int i) {
    const Tree& t = body_.tree;
    Feature f;
    f.a = i;
    f.link = t.owner[i];
    f.at[0] = t.owner_point[i];
    f.radius[0] = s_.radius[i];
    std::set<int> all;
    addCoordinates(f.link, all);
    f.row = shapeOf(all);
    body_.features.push_back(f);
  }

  void addStick(const Stick& k) {
    Feature f;
    f.a = k.a;
    f.b = k.b;
    f.stick = static_cast<int>(&k - s_.sticks.data());
    f.link = linkWith({k.a, k.b});
    if (f.link < 0) return;  // no stick of a tree
    f.at[0] = placeOf(f.link, k.a);
    f.at[1] = placeOf(f.link, k.b);
    f.radius[0] = s_.radius[k.a];
    f.radius[1] = s_.radius[k.b];
    std::set<int> all;
    addCoordinates(f.link, all);
    f.row = shapeOf(all);
    body_.features.push_back(f);
  }

  const Skeleton& s_;
  FastBody body_;
  tree::Work<double> work_;
  bool ok_ = true;
};

}  // namespace

FastBody buildBody(const Model& model, const System& system) {
  return BodyBuilder(model.skeletons[system.skeleton], system.pins).build();
}

}  // namespace ragdoll::fast
