// The human's skin in the rest pose: rings of points around the bones and what joins them.
//
// Trunk and head are one tube of rings upward, kRound points each, k = 0 ahead, a quarter further
// left. Each leg begins at one half of the lowest ring and the point of the crotch, each arm at the
// border of a hole in the trunk's side (four columns, two rows): twelve points each, kLimb per
// ring. So the mesh is closed by construction.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "body/human_measures.h"
#include "body/rigid_coat.h"
#include "body/smoothstep.h"
#include "ragdoll_sim/body/skin.h"

namespace ragdoll {
namespace {

constexpr int kRound = 20, kLimb = 12;

/// A ring of the trunk: height above the hips, half widths ahead and aside, shift ahead [m]; how
/// square it is (0 an ellipse); its colour.
struct SkinRing {
  double z, ahead, aside, shift, square;
  Rgba color;
};

/// A ring of a limb: place along its bone [m], from the bone's end if `from_end`; radii ahead and
/// aside, shift ahead [m]; by how much its outer side is raised [rad]; shift outward [m].
struct LimbRing {
  int bone;  ///< 0 upper, 1 lower
  bool from_end;
  double place, ahead, aside, shift;
  Rgba color;
  double raised = 0;
  double outward = 0;
};

using namespace palette;

// Fractions of a metre of a human of 1.75 m. Two rings 4 mm apart make a sharp border of colours.
constexpr SkinRing kTrunk[] = {
    {-0.060, 0.112, 0.168, -0.010, 0.10, kTrousers},
    {-0.015, 0.116, 0.170, -0.012, 0.12, kTrousers},
    {0.035, 0.108, 0.160, -0.006, 0.10, kTrousers},
    {0.070, 0.101, 0.150, -0.002, 0.08, kTrousers},
    {0.074, 0.103, 0.152, -0.002, 0.08, kShirt},
    {0.130, 0.099, 0.142, 0.000, 0.08, kShirt},
    {0.200, 0.101, 0.141, 0.002, 0.08, kShirt},
    {0.270, 0.110, 0.150, 0.003, 0.10, kShirt},
    {0.335, 0.119, 0.154, 0.002, 0.12, kShirt},   // armpits: lower border of the arms' holes
    {0.405, 0.112, 0.146, -0.004, 0.12, kShirt},  // through the holes
    {0.481, 0.084, 0.142, -0.014, 0.10, kShirt},  // upper border
    {0.503, 0.072, 0.112, -0.022, 0.00, kShirt},
    {0.518, 0.064, 0.078, -0.026, 0.00, kShirt},
    {0.522, 0.062, 0.075, -0.026, 0.00, kSkin},
    {0.548, 0.056, 0.058, -0.024, 0.00, kSkin},
    {0.578, 0.056, 0.055, -0.018, 0.00, kSkin},
    // the head: chin, mouth, nose, eyes, brow, crown
    {0.588, 0.078, 0.056, 0.000, 0.00, kSkin},
    {0.603, 0.088, 0.064, 0.003, 0.06, kSkin},
    {0.630, 0.092, 0.070, 0.000, 0.06, kSkin},
    {0.655, 0.096, 0.075, -0.002, 0.04, kSkin},
    {0.685, 0.098, 0.077, -0.006, 0.02, kSkin},
    {0.715, 0.094, 0.075, -0.010, 0.00, kHair},
    {0.742, 0.080, 0.065, -0.014, 0.00, kHair},
    {0.760, 0.055, 0.045, -0.016, 0.00, kHair}};
constexpr double kCrown = 0.768;             ///< [m] above the hips
constexpr int kHoleLow = 8, kHoleHigh = 10;  ///< rings between which the arms begin
constexpr int kHeadRing = 16;                ///< first ring of the head

constexpr LimbRing kArm[] = {{0, false, 0.025, 0.060, 0.067, 0.000, kShirt, 0.98, -0.012},
                             {0, false, 0.047, 0.059, 0.063, 0.000, kShirt, 0.79, -0.003},
                             {0, false, 0.083, 0.056, 0.055, 0.000, kShirt, 0.40},
                             {0, false, 0.115, 0.053, 0.051, 0.000, kShirt, 0.12},
                             {0, false, 0.150, 0.051, 0.048, 0.000, kShirt},
                             {0, false, 0.205, 0.047, 0.045, 0.000, kShirt},
                             {0, false, 0.209, 0.045, 0.043, 0.000, kSkin},
                             {0, true, -0.035, 0.042, 0.041, 0.000, kSkin},
                             {0, true, -0.016, 0.041, 0.041, 0.000, kSkin},
                             {0, true, 0.000, 0.041, 0.041, 0.000, kSkin},
                             {1, false, 0.016, 0.042, 0.042, 0.000, kSkin},
                             {1, false, 0.035, 0.043, 0.043, 0.000, kSkin},
                             {1, false, 0.080, 0.044, 0.042, 0.000, kSkin},
                             {1, false, 0.150, 0.038, 0.035, 0.000, kSkin},
                             {1, true, -0.100, 0.031, 0.027, 0.000, kSkin},
                             {1, true, -0.068, 0.030, 0.022, 0.000, kSkin},
                             {1, true, -0.030, 0.040, 0.019, 0.003, kSkin},
                             {1, true, 0.010, 0.045, 0.018, 0.005, kSkin},
                             {1, true, 0.045, 0.039, 0.016, 0.000, kSkin},
                             {1, true, 0.080, 0.032, 0.013, -0.002, kSkin},
                             {1, true, 0.102, 0.022, 0.010, -0.003, kSkin}};

constexpr LimbRing kLeg[] = {{0, false, 0.080, 0.094, 0.084, 0.000, kTrousers},
                             {0, false, 0.130, 0.089, 0.082, 0.002, kTrousers},
                             {0, false, 0.200, 0.082, 0.076, 0.003, kTrousers},
                             {0, false, 0.280, 0.073, 0.068, 0.003, kTrousers},
                             {0, false, 0.350, 0.064, 0.059, 0.003, kTrousers},
                             {0, true, -0.045, 0.060, 0.055, 0.002, kTrousers},
                             {0, true, -0.020, 0.059, 0.054, 0.001, kTrousers},
                             {0, true, 0.000, 0.058, 0.053, 0.000, kTrousers},
                             {1, false, 0.020, 0.057, 0.053, -0.001, kTrousers},
                             {1, false, 0.045, 0.057, 0.053, -0.004, kTrousers},
                             {1, false, 0.090, 0.060, 0.055, -0.008, kTrousers},
                             {1, false, 0.150, 0.061, 0.055, -0.010, kTrousers},
                             {1, false, 0.240, 0.052, 0.048, -0.008, kTrousers},
                             {1, false, 0.330, 0.044, 0.041, -0.006, kTrousers},
                             {1, true, -0.070, 0.044, 0.041, -0.010, kTrousers},
                             {1, true, -0.066, 0.041, 0.038, -0.010, kShoes}};

/// A ring of the foot, from its particle: place ahead and up [m]; how far the tube has turned from
/// down to ahead [rad]; radii along the sole's normal (at first: ahead) and aside [m].
struct FootRing {
  double ahead, up, turn, radius, aside;
};
constexpr FootRing kFoot[] = {
    {-0.012, 0.032, 0.10, 0.045, 0.038}, {-0.010, 0.008, 0.45, 0.054, 0.040},
    {0.012, -0.004, 0.95, 0.050, 0.041}, {0.060, -0.010, 1.35, 0.034, 0.044},
    {0.105, -0.016, 1.52, 0.027, 0.048}, {0.148, -0.022, 1.57, 0.019, 0.042}};
constexpr FootRing kToe{0.172, -0.028, 0, 0, 0};
constexpr double kSole = -0.040;  ///< [m] the ground under the foot's particle

class SkinBuilder {
 public:
  SkinBuilder(const Skeleton& skeleton, const FrameTree& tree) : s_(skeleton), tree_(tree) {
    k_ = (at("left_leg") - at("left_knee")).norm() / kThigh;
    // The table's hips, shoulders and neck; what the model has otherwise stretches the trunk.
    hips_ = (at("left_hip") + at("right_hip")) / 2;
    tall_ = (at("left_shoulder") + at("right_shoulder")).z() / 2 - hips_.z();
    broad_ = (at("left_shoulder") - at("right_shoulder")).norm();
  }

  BoundMesh build() {
    addTrunk();
    addLimb(1, "shoulder", kArm, armBorder(1));
    addLimb(-1, "shoulder", kArm, armBorder(-1));
    addLimb(1, "leg", kLeg, legBorder(1));
    addLimb(-1, "leg", kLeg, legBorder(-1));
    dropUnused();
    computeNormals(out_.mesh);
    for (int i = 0; i < out_.mesh.vertices.cols(); ++i) out_.weights.push_back(weigh(i));
    return std::move(out_);
  }

 private:
  enum class Region { kTrunk, kArm, kLeg };

  Vec3 at(const std::string& name) const { return s_.rest.col(s_.particle(name)); }
  Vec3 at(int side, const std::string& name) const {
    return at((side > 0 ? "left_" : "right_") + name);
  }
  int partAt(const std::string& frame) const { return tree_.frames[tree_.frame(frame)].part; }
  int partAt(int side, const std::string& frame) const {
    return partAt((side > 0 ? "left_" : "right_") + frame);
  }

  int addVertex(const Vec3& p, const Rgba& color, Region region, int side) {
    points_.push_back(p);
    out_.mesh.colors.push_back(color);
    region_.push_back(region);
    side_.push_back(side);
    return static_cast<int>(points_.size()) - 1;
  }

  void addQuad(int a, int b, int c, int d) {
    auto& t = out_.mesh.triangles;
    // Split along the shorter diagonal.
    if ((points_[a] - points_[c]).norm() < (points_[b] - points_[d]).norm()) {
      t.push_back({a, b, c});
      t.push_back({a, c, d});
    } else {
      t.push_back({a, b, d});
      t.push_back({b, c, d});
    }
  }

  // --- trunk and head
  Vec3 trunkPoint(const SkinRing& ring, int k) const {
    const double angle = 2 * M_PI * k / kRound, c = std::cos(angle), s = std::sin(angle);
    const double bulge = 1 + ring.square * 4 * c * c * s * s;
    const double aside = ring.z > 0.25 && ring.z < 0.49 ? broad_ / (0.37 * k_) : 1;
    const double z = ring.z * (ring.z < 0.45 && ring.z > 0 ? tall_ / (0.4462 * k_) : 1);
    return hips_ +
           k_ * Vec3(bulge * ring.ahead * c + ring.shift, bulge * aside * ring.aside * s, z);
  }

  int trunk(int ring, int k) const { return ring * kRound + (k + kRound) % kRound; }

  void addTrunk() {
    constexpr int n = static_cast<int>(std::size(kTrunk));
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < kRound; ++k)
        addVertex(headShape(i, k), trunkColor(i, k), Region::kTrunk, 0);
    for (int i = 0; i + 1 < n; ++i)
      for (int k = 0; k < kRound; ++k)
        if (!isHole(i, k))
          addQuad(trunk(i, k), trunk(i, k + 1), trunk(i + 1, k + 1), trunk(i + 1, k));
    const int crown = addVertex(hips_ + k_ * Vec3(-0.016, 0, kCrown), kHair, Region::kTrunk, 0);
    for (int k = 0; k < kRound; ++k)
      out_.mesh.triangles.push_back({trunk(n - 1, k), trunk(n - 1, k + 1), crown});
  }

  bool isHole(int ring, int k) const {
    return ring >= kHoleLow && ring < kHoleHigh && ((k >= 3 && k < 7) || (k >= 13 && k < 17));
  }

  /// Rings with a nose and a chin; the groin is lower ahead and behind than aside.
  Vec3 headShape(int ring, int k) const {
    Vec3 p = trunkPoint(kTrunk[ring], k);
    if (ring == kHeadRing + 2 && k == 0) p.x() += 0.016 * k_;
    if (ring == kHeadRing + 3 && k == 0) p.x() += 0.005 * k_;
    if (ring == 0) p.z() -= 0.030 * k_ * std::pow(std::cos(2 * M_PI * k / kRound), 2);
    return p;
  }

  /// The hair reaches lower at the back.
  Rgba trunkColor(int ring, int k) const {
    const bool behind = k >= 5 && k <= 15;
    if (ring >= kHeadRing + 3 && behind) return kHair;
    if (ring == kHeadRing + 2 && k >= 7 && k <= 13) return kHair;
    return kTrunk[ring].color;
  }

  // --- limbs
  /// Twelve vertices of the trunk, in the order of a limb's ring (see limbPoint).
  std::vector<int> legBorder(int side) {
    std::vector<int> border;
    for (int j = 0; j <= 10; ++j) border.push_back(trunk(0, side > 0 ? j : 10 + j));
    if (crotch_ < 0)
      crotch_ = addVertex(Vec3(hips_.x() - 0.010 * k_, hips_.y(), at("left_leg").z() - 0.062 * k_),
                          kTrousers, Region::kTrunk, 0);
    border.push_back(crotch_);
    std::rotate(border.begin(), border.begin() + 11, border.end());  // begins at the inner side
    return border;
  }

  std::vector<int> armBorder(int side) {
    const int k[] = {0, -1, -2, -2, -2, -1, 0, 1, 2, 2, 2, 1};
    const int row[] = {0, 0, 0, 1, 2, 2, 2, 2, 2, 1, 0, 0};
    std::vector<int> border;
    for (int j = 0; j < kLimb; ++j)  // begins at the armpit
      border.push_back(trunk(kHoleLow + row[j], (side > 0 ? 5 : 15) + k[j]));
    return border;
  }

  /// j = 0 at the inner side, then turning to the left about the vertical: for the left limb ahead
  /// first, for the right one behind first.
  double limbAngle(int side, int j) const { return -side * M_PI / 2 + 2 * M_PI * j / kLimb; }

  std::vector<int> addRing(int side, Region region, const Rgba& color, const Vec3& centre,
                           const Vec3& u, const Vec3& v) {
    std::vector<int> ring;
    for (int j = 0; j < kLimb; ++j) {
      const double angle = limbAngle(side, j);
      ring.push_back(
          addVertex(centre + std::cos(angle) * u + std::sin(angle) * v, color, region, side));
    }
    return ring;
  }

  void join(const std::vector<int>& upper, const std::vector<int>& lower) {
    for (int j = 0; j < kLimb; ++j) {
      const int next = (j + 1) % kLimb;
      addQuad(lower[j], lower[next], upper[next], upper[j]);
    }
  }

  template <std::size_t N>
  void addLimb(int side, const std::string& root, const LimbRing (&table)[N],
               std::vector<int> last) {
    const bool arm = root == "shoulder";
    const Region region = arm ? Region::kArm : Region::kLeg;
    const Vec3 joint[3] = {at(side, root), at(side, arm ? "elbow" : "knee"),
                           at(side, arm ? "hand" : "foot")};
    for (const LimbRing& ring : table) {
      const Vec3 down = (joint[ring.bone + 1] - joint[ring.bone]).normalized();
      const Vec3 start = joint[ring.bone + (ring.from_end ? 1 : 0)];
      const Vec3 left = Vec3::UnitX().cross(down).normalized();
      const Vec3 ahead = left.cross(-down);
      const Vec3 raised = std::cos(ring.raised) * left - side * std::sin(ring.raised) * down;
      const Vec3 centre =
          start + k_ * (ring.place * down + ring.shift * ahead + side * ring.outward * left);
      const auto next = addRing(side, region, ring.color, centre, k_ * ring.ahead * ahead,
                                k_ * ring.aside * raised);
      join(last, next);
      last = next;
    }
    if (arm)
      close(last, joint[2] + k_ * 0.112 * (joint[2] - joint[1]).normalized(), kSkin, region, side);
    else
      addFoot(side, last);
  }

  void addFoot(int side, std::vector<int> last) {
    const Vec3 foot = at(side, "foot");
    for (const FootRing& ring : kFoot) {
      const Vec3 normal(std::cos(ring.turn), 0, std::sin(ring.turn));
      const auto next =
          addRing(side, Region::kLeg, kShoes, foot + k_ * Vec3(ring.ahead, 0, ring.up),
                  k_ * ring.radius * normal, k_ * ring.aside * Vec3::UnitY());
      for (const int i : next) points_[i].z() = std::max(points_[i].z(), foot.z() + kSole * k_);
      join(last, next);
      last = next;
    }
    close(last, foot + k_ * Vec3(kToe.ahead, 0, kToe.up), kShoes, Region::kLeg, side);
  }

  void close(const std::vector<int>& ring, const Vec3& tip, const Rgba& color, Region region,
             int side) {
    const int end = addVertex(tip, color, region, side);
    for (int j = 0; j < kLimb; ++j)
      out_.mesh.triangles.push_back({ring[(j + 1) % kLimb], ring[j], end});
  }

  /// The points inside the arms' holes belong to no triangle.
  void dropUnused() {
    std::vector<int> place(points_.size(), -1);
    for (const Triangle& t : out_.mesh.triangles)
      for (const int i : t) place[i] = 0;
    int count = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      if (place[i] < 0) continue;
      place[i] = count;
      points_[count] = points_[i];
      out_.mesh.colors[count] = out_.mesh.colors[i];
      region_[count] = region_[i];
      side_[count] = side_[i];
      ++count;
    }
    out_.mesh.colors.resize(count);
    out_.mesh.vertices.resize(3, count);
    for (int i = 0; i < count; ++i) out_.mesh.vertices.col(i) = points_[i];
    for (Triangle& t : out_.mesh.triangles)
      for (int& i : t) i = place[i];
  }

  // --- weights
  /// How far beyond the joint, along `direction`, in units of the body's scale.
  double beyond(const Vec3& p, const Vec3& joint, const Vec3& direction) const {
    return (p - joint).dot(direction.normalized()) / k_;
  }

  /// How much of a point the upper arm takes from the trunk.
  double armShare(const Vec3& p, int side) const {
    return smoothstep(-0.060, 0.105, beyond(p, at(side, "shoulder"), Vec3(0, 0.9 * side, -0.45)));
  }

  double legShare(const Vec3& p, int side) const {
    const double share =
        smoothstep(-0.065, 0.075, beyond(p, at(side, "leg"), Vec3(0.1, 0.15 * side, -1)));
    return share * smoothstep(-0.035, 0.035, side * (p.y() - hips_.y()) / k_);
  }

  Weights weigh(int i) const {
    const Vec3 p = out_.mesh.vertices.col(i);
    std::vector<std::pair<double, int>> list;
    const auto put = [&](double weight, int part) {
      if (weight > 0.004) list.push_back({weight, part});
    };
    if (region_[i] == Region::kArm)
      weighLimb(p, side_[i], "shoulder", "elbow", 0.050, put);
    else if (region_[i] == Region::kLeg)
      weighLimb(p, side_[i], "leg", "knee", 0.065, put);
    else
      weighTrunk(p, 1, put);
    std::sort(list.rbegin(), list.rend());
    Weights w;
    w.count = std::min<int>(4, static_cast<int>(list.size()));
    double sum = 0;
    for (int n = 0; n < w.count; ++n) sum += list[n].first;
    for (int n = 0; n < w.count; ++n) {
      w.part[n] = list[n].second;
      w.weight[n] = static_cast<float>(list[n].first / sum);
    }
    return w;
  }

  template <class Put>
  void weighLimb(const Vec3& p, int side, const std::string& root, const std::string& hinge,
                 double width, const Put& put) const {
    const double share = root == "leg" ? legShare(p, side) : armShare(p, side);
    const Vec3 along = at(side, hinge) - at(side, root);
    const double lower = smoothstep(-width, width, beyond(p, at(side, hinge), along));
    put(share * lower, partAt(side, hinge));
    put(share * (1 - lower), partAt(side, root));
    put(1 - share, partAt(root == "leg" ? "pelvis" : "neck"));
  }

  template <class Put>
  void weighTrunk(const Vec3& p, double rest, const Put& put) const {
    const double z = (p.z() - hips_.z()) / k_;
    const double head = smoothstep(-0.005, 0.065, (p.z() - at("neck").z()) / k_);
    put(rest * head, partAt("head"));
    rest -= rest * head;
    for (const int side : {1, -1}) {
      const double arm = z > 0.3 && head == 0 ? armShare(p, side) : 0, leg = legShare(p, side);
      put(arm, partAt(side, "shoulder"));
      put(leg, partAt(side, "leg"));
      rest -= arm + leg;
    }
    const double torso = smoothstep(-0.01, 0.17, z);
    put(rest * torso, partAt("neck"));
    put(rest * (1 - torso), partAt("pelvis"));
  }

  const Skeleton& s_;
  const FrameTree& tree_;
  double k_ = 1, tall_ = 0, broad_ = 0;
  Vec3 hips_;
  int crotch_ = -1;
  std::vector<Vec3> points_;
  std::vector<Region> region_;
  std::vector<int> side_;
  BoundMesh out_;
};

}  // namespace

BoundMesh humanSkin(const Skeleton& skeleton, const FrameTree& tree) {
  assert(tree.human);
  return SkinBuilder(skeleton, tree).build();
}

}  // namespace ragdoll
