// The pieces of the rigid coats: measures of a human of 1.75 m, scaled by the length of the thigh.
#include <algorithm>
#include <cmath>

#include "body/human_measures.h"
#include "body/rigid_coat.h"

namespace ragdoll {
namespace {

constexpr double kThinnest = 0.04;  ///< [m] least thickness of a box
constexpr int kSides = 10;          ///< of a limb: light enough to send 30 times a second

Mesh moved(const Mesh& mesh, const Vec3& position, const Quat& turn = Quat::Identity()) {
  Mesh result;
  append(mesh, {position, turn}, result);
  return result;
}

/// The human's rest pose by name, and its scale.
struct Human {
  const Skeleton& s;
  const FrameTree& tree;
  double k;

  Human(const Skeleton& skeleton, const FrameTree& frames) : s(skeleton), tree(frames) {
    k = (at("left_leg") - at("left_knee")).norm() / kThigh;
  }
  Vec3 at(const std::string& name) const { return s.rest.col(s.particle(name)); }
  Vec3 middle(const std::string& name) const {
    return (at("left_" + name) + at("right_" + name)) / 2;
  }
  int partAt(const std::string& frame) const { return tree.frames[tree.frame(frame)].part; }
};

/// Elliptic rings up a trunk: height as a fraction from `low` to `high`, half widths in y and x
/// [m], shift in x [m].
struct TrunkRing {
  double height, y, x, shift;
};

Mesh trunk(const Vec3& low, const Vec3& high, const std::vector<TrunkRing>& profile, double k,
           int sides) {
  std::vector<Ring> rings;
  for (const TrunkRing& p : profile)
    rings.push_back({low + p.height * (high - low) + Vec3(p.shift * k, 0, 0), Vec3(p.x * k, 0, 0),
                     Vec3(0, p.y * k, 0)});
  const auto cap = [&](double past, const Ring& ring) {
    return Vec3(ring.centre + past * (high - low).normalized() * k);
  };
  return tube(cap(-0.012, rings.front()), rings, cap(0.012, rings.back()), sides);
}

void addTrunk(const Human& h, std::vector<RigidPiece>& pieces) {
  const Vec3 hips = h.middle("hip"), legs = h.middle("leg"), shoulders = h.middle("shoulder");
  pieces.push_back({trunk(hips, shoulders,
                          {{0.06, 0.110, 0.070, 0.000},
                           {0.12, 0.140, 0.094, 0.000},
                           {0.35, 0.138, 0.096, 0.002},
                           {0.60, 0.158, 0.110, 0.004},
                           {0.80, 0.178, 0.117, 0.002},
                           {0.93, 0.192, 0.104, -0.006},
                           {1.02, 0.186, 0.084, -0.012},
                           {1.09, 0.140, 0.070, -0.016},
                           {1.15, 0.085, 0.058, -0.018}},
                          h.k, 16),
                    h.partAt("neck"), palette::kShirt});
  pieces.push_back({trunk(legs, hips,
                          {{-0.65, 0.060, 0.050, 0.000},
                           {-0.40, 0.120, 0.082, 0.000},
                           {0.20, 0.160, 0.106, -0.006},
                           {0.90, 0.160, 0.106, -0.006},
                           {1.45, 0.148, 0.098, -0.002},
                           {1.75, 0.118, 0.078, 0.000}},
                          h.k, 16),
                    h.partAt("pelvis"), palette::kTrousers});
}

void addHead(const Human& h, std::vector<RigidPiece>& pieces) {
  const int part = h.partAt("head");
  const Vec3 head = h.at("head"), base = (h.at("neck") + h.middle("shoulder")) / 2;
  const auto ball = [&](const Vec3& centre, const Vec3& half, const Rgba& color) {
    pieces.push_back({moved(ellipsoid(half * h.k, 14, 6), head + centre * h.k), part, color});
  };
  pieces.push_back(
      {roundCone(base, 0.060 * h.k, head + Vec3(-0.01, 0, -0.05) * h.k, 0.054 * h.k, 12, 2), part,
       palette::kSkin});
  ball(Vec3(0.004, 0, 0.005), Vec3(0.094, 0.076, 0.110), palette::kSkin);
  ball(Vec3(0.034, 0, -0.050), Vec3(0.058, 0.054, 0.066), palette::kSkin);  // jaw
  ball(Vec3(-0.014, 0, 0.026), Vec3(0.095, 0.084, 0.100), palette::kHair);
  pieces.push_back({roundCone(head + Vec3(0.092, 0, 0.0) * h.k, 0.009 * h.k,
                              head + Vec3(0.106, 0, -0.024) * h.k, 0.013 * h.k, 6, 2),
                    part, palette::kSkin});  // nose
}

/// A bone in one piece: radii [m] at its start, at its belly a quarter of the way down, at its end,
/// which is at `share` of the way to the particle `to`; rounded at both ends.
void addBone(const Human& h, const std::string& from, const std::string& to, const Vec3& radii,
             double share, const Rgba& color, std::vector<RigidPiece>& pieces) {
  const Vec3 a = h.at(from), b = a + share * (h.at(to) - a), axis = (b - a).normalized();
  const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
  std::vector<Ring> rings;
  const auto put = [&](const Vec3& centre, double radius, double latitude) {
    const double r = radius * h.k * std::cos(latitude);
    rings.push_back({centre + radius * h.k * std::sin(latitude) * axis, r * u, r * v});
  };
  put(a, radii[0], -0.8);
  put(a, radii[0], 0);
  put(a + 0.28 * (b - a), radii[1], 0);
  put(a + 0.64 * (b - a), (radii[1] + radii[2]) / 2, 0);
  put(b, radii[2], 0);
  put(b, radii[2], 0.8);
  pieces.push_back({tube(a - radii[0] * h.k * axis, rings, b + radii[2] * h.k * axis, kSides),
                    h.partAt(from), color});
}

void addHand(const Human& h, const std::string& side, std::vector<RigidPiece>& pieces) {
  const Vec3 hand = h.at(side + "hand"), down = (hand - h.at(side + "elbow")).normalized();
  const Quat turn = Quat::FromTwoVectors(-Vec3::UnitZ(), down);
  const int part = h.partAt(side + "hand");
  pieces.push_back(
      {moved(ellipsoid(Vec3(0.042, 0.020, 0.092) * h.k, 10, 5), hand + 0.012 * h.k * down, turn),
       part, palette::kSkin});
  const Vec3 thumb = hand + turn * (Vec3(0.030, 0, 0.030) * h.k);
  pieces.push_back({roundCone(thumb, 0.013 * h.k, thumb + turn * (Vec3(0.028, 0, -0.045) * h.k),
                              0.010 * h.k, 8, 2),
                    part, palette::kSkin});
}

void addFoot(const Human& h, const std::string& side, std::vector<RigidPiece>& pieces) {
  const Vec3 foot = h.at(side + "foot");
  const int part = h.partAt(side + "foot");
  const Vec3 heel = foot + Vec3(-0.040, 0, -0.002) * h.k,
             ball = foot + Vec3(0.125, 0, -0.012) * h.k;
  const Vec3 ankle = foot + Vec3(-0.008, 0, 0.035) * h.k;
  pieces.push_back({roundCone(heel, 0.038 * h.k, ball, 0.028 * h.k, 10, 2), part, palette::kShoes});
  pieces.push_back(
      {roundCone(ankle, 0.040 * h.k, ball, 0.028 * h.k, 10, 2), part, palette::kShoes});
  Mesh sole =
      moved(ellipsoid(Vec3(0.055, 0.046, 0.022) * h.k, 10, 3), ball + Vec3(-0.01, 0, -0.006) * h.k);
  pieces.push_back({sole, part, palette::kShoes});
}

Vec3 boxAround(const Skeleton& s, const std::vector<int>& particles, Vec3& centre) {
  Vec3 low = s.rest.col(particles[0]), high = low;
  for (const int i : particles) {
    low = low.cwiseMin(s.rest.col(i));
    high = high.cwiseMax(s.rest.col(i));
  }
  centre = (low + high) / 2;
  double radius = kThinnest / 2;
  for (const int i : particles) radius = std::max(radius, s.radius[i]);
  return (high - low).cwiseMax(2 * radius);
}

RigidPiece boneBox(const Skeleton& s, const Part& part, int index, const Rgba& color) {
  const Vec3 a = s.rest.col(part.particles[0]), b = s.rest.col(part.particles[1]);
  const double thick =
      std::max(kThinnest, 0.85 * (s.radius[part.particles[0]] + s.radius[part.particles[1]]));
  const double length = std::max((b - a).norm(), kThinnest);
  const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), part.rest_direction);
  return {moved(box(Vec3(thick, thick, length)), (a + b) / 2, turn), index, color};
}

void addHumanBoxes(const Human& h, std::vector<RigidPiece>& pieces) {
  const auto put = [&](const std::string& frame, const Vec3& shift, const Vec3& size,
                       const Rgba& color, const Quat& turn = Quat::Identity()) {
    pieces.push_back(
        {moved(box(size * h.k), h.at(frame) + turn * shift * h.k, turn), h.partAt(frame), color});
  };
  put("head", Vec3(0.01, 0, 0), Vec3(0.17, 0.15, 0.21), palette::kSkin);
  for (const std::string side : {"left_", "right_"}) {
    const Vec3 down = h.at(side + "hand") - h.at(side + "elbow");
    put(side + "hand", Vec3(0, 0, -0.03), Vec3(0.08, 0.035, 0.14), palette::kSkin,
        Quat::FromTwoVectors(-Vec3::UnitZ(), down));
    put(side + "foot", Vec3(0.045, 0, -0.012), Vec3(0.24, 0.085, 0.055), palette::kShoes);
  }
}

Rgba boxColor(const FrameTree& tree, const std::string& part) {
  if (!tree.human) return palette::kBone;
  const auto is = [&](const char* word) { return part.find(word) != std::string::npos; };
  if (is("thigh") || is("shank") || is("pelvis")) return palette::kTrousers;
  if (is("torso") || is("upper_arm")) return palette::kShirt;
  return palette::kSkin;
}

/// Which of the parts the human's own pieces clothe.
bool clothed(const FrameTree& tree, int part) {
  return tree.human && part < 11;  // buildFrameTree puts the human's eleven first
}

}  // namespace

std::vector<RigidPiece> capsulePieces(const Skeleton& skeleton, const FrameTree& tree) {
  std::vector<RigidPiece> pieces;
  if (tree.human) {
    const Human h(skeleton, tree);
    addTrunk(h, pieces);
    addHead(h, pieces);
    for (const std::string side : {"left_", "right_"}) {
      addBone(h, side + "shoulder", side + "elbow", {0.056, 0.053, 0.043}, 1, palette::kShirt,
              pieces);
      addBone(h, side + "elbow", side + "hand", {0.040, 0.043, 0.029}, 0.80, palette::kSkin,
              pieces);
      addBone(h, side + "leg", side + "knee", {0.086, 0.083, 0.056}, 1, palette::kTrousers, pieces);
      addBone(h, side + "knee", side + "foot", {0.056, 0.058, 0.039}, 0.93, palette::kTrousers,
              pieces);
      addHand(h, side, pieces);
      addFoot(h, side, pieces);
    }
  }
  for (const Stick& stick : skeleton.sticks) {
    for (std::size_t p = 0; p < tree.parts.size(); ++p) {
      const auto& in = tree.parts[p].particles;
      const bool has =
          std::count(in.begin(), in.end(), stick.a) && std::count(in.begin(), in.end(), stick.b);
      if (!has || clothed(tree, static_cast<int>(p))) continue;
      pieces.push_back(
          {roundCone(skeleton.rest.col(stick.a), std::max(0.005, skeleton.radius[stick.a]),
                     skeleton.rest.col(stick.b), std::max(0.005, skeleton.radius[stick.b])),
           static_cast<int>(p), tree.parts[p].group ? palette::kGroup : palette::kBone});
      break;
    }
  }
  return pieces;
}

std::vector<RigidPiece> boxPieces(const Skeleton& skeleton, const FrameTree& tree) {
  std::vector<RigidPiece> pieces;
  for (std::size_t p = 0; p < tree.parts.size(); ++p) {
    const Part& part = tree.parts[p];
    const int index = static_cast<int>(p);
    const Rgba color = boxColor(tree, part.name);
    if (part.group) {
      Vec3 centre;
      const Vec3 size = boxAround(skeleton, part.particles, centre);
      pieces.push_back({moved(box(size), centre), index, tree.human ? color : palette::kGroup});
    } else {
      pieces.push_back(boneBox(skeleton, part, index, color));
    }
  }
  if (tree.human) addHumanBoxes(Human(skeleton, tree), pieces);
  return pieces;
}

}  // namespace ragdoll
