#include "ragdoll_sim/body/limit_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "ragdoll_sim/body/angles.h"
#include "ragdoll_sim/body/part_motion.h"
#include "ragdoll_sim/core/plane_limits.h"

namespace ragdoll {
namespace {

constexpr double kReach = 0.9;        ///< of the child bone's length
constexpr double kLineWidth = 0.006;  ///< [m]
constexpr int kSteps = 32;            ///< of a fan, or around a cone
constexpr int kLaps = 6;              ///< of a cone's cap, from its axis to its rim
constexpr Rgba kBegin{0.90f, 0.10f, 0.10f, 1};
constexpr Rgba kEnd{0.10f, 0.25f, 0.95f, 1};
constexpr Rgba kFan{0.96f, 0.80f, 0.15f, 0.55f};
constexpr std::array<Rgba, 3> kPlaneFans{
    {kFan, {0.55f, 0.35f, 0.80f, 0.45f}, {0.20f, 0.70f, 0.60f, 0.45f}}};  ///< xy, yz, xz
constexpr Rgba kCone{0.30f, 0.85f, 0.45f, 0.30f};

/// Where a joint is and how its parent lies.
struct Place {
  Vec3 origin;
  Quat parent;
  double reach;
};

CoatShape line(const std::string& name, const Points& points, const Rgba& color) {
  CoatShape shape;
  shape.type = CoatShape::Type::kLines;
  shape.name = name;
  shape.size = Vec3::Constant(kLineWidth);
  shape.color = color;
  shape.points = points;
  return shape;
}

CoatShape ray(const std::string& name, const Place& place, const Vec3& direction,
              const Rgba& color) {
  Points points(3, 2);
  points << place.origin, place.origin + place.parent * direction * place.reach;
  return line(name, points, color);
}

/// A fan over a range of angles; at(angle) is a unit vector of the parent's rest axes.
template <class Function>
void addFan(const std::string& name, const Place& place, const AngleRange& range,
            const Function& at, const Rgba& color, std::vector<CoatShape>& shapes) {
  CoatShape fan;
  fan.type = CoatShape::Type::kMesh;
  fan.name = name + "/region";
  fan.color = color;
  fan.mesh.vertices.resize(3, kSteps + 2);
  fan.mesh.vertices.col(0) = place.origin;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = range.begin + (range.end - range.begin) * i / kSteps;
    fan.mesh.vertices.col(i + 1) = place.origin + place.parent * at(angle) * place.reach;
    if (i > 0) fan.mesh.triangles.push_back({0, i, i + 1});
  }
  fan.mesh.colors.assign(kSteps + 2, color);  // unlit: the same from both sides
  shapes.push_back(fan);
  shapes.push_back(ray(name + "/begin", place, at(range.begin), kBegin));
  shapes.push_back(ray(name + "/end", place, at(range.end), kEnd));
}

/// What the child bone sweeps: a cone where the axis is not square to it.
void addHinge(const std::string& name, const Place& place, const HingeGeometry& hinge,
              const AngleRange& range, std::vector<CoatShape>& shapes) {
  const auto at = [&](double angle) {
    return Vec3(Eigen::AngleAxisd(angle, hinge.axis) * hinge.straight);
  };
  addFan(name, place, range, at, kFan, shapes);
}

void addPlanes(const std::string& name, const Place& place, const Joint& joint, bool left,
               bool bone_parent, std::vector<CoatShape>& shapes) {
  static const char* const kNames[] = {"/xy", "/yz", "/xz"};
  for (int i = 0; i < 3; ++i) {
    if (!joint.planes[i]) continue;
    const LimitPlane plane = limitPlane(i, left, bone_parent);
    const auto at = [&](double angle) {
      return Vec3(std::cos(angle) * plane.zero + std::sin(angle) * plane.quarter);
    };
    addFan(name + kNames[i], place, *joint.planes[i], at, kPlaneFans[i], shapes);
  }
}

/// The part of a sphere within half_angle of the axis, and the cone to its rim.
void addCone(const std::string& name, const Place& place, const Vec3& axis, double half_angle,
             std::vector<CoatShape>& shapes) {
  const Vec3 z = axis.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  const auto point = [&](double away, int step) {
    const double turn = 2 * M_PI * step / kSteps;
    const Vec3 d = std::cos(away) * z + std::sin(away) * (std::cos(turn) * x + std::sin(turn) * y);
    return Vec3(place.origin + place.parent * d * place.reach);
  };
  CoatShape cone;
  cone.type = CoatShape::Type::kMesh;
  cone.name = name + "/region";
  cone.color = kCone;
  cone.mesh.vertices.resize(3, kLaps * kSteps + 2);
  const int apex = kLaps * kSteps, pole = apex + 1;
  cone.mesh.vertices.col(apex) = place.origin;
  cone.mesh.vertices.col(pole) = point(0, 0);
  for (int lap = 0; lap < kLaps; ++lap)
    for (int step = 0; step < kSteps; ++step)
      cone.mesh.vertices.col(lap * kSteps + step) = point(half_angle * (lap + 1) / kLaps, step);
  Points rim(3, 2 * kSteps);
  for (int step = 0; step < kSteps; ++step) {
    const int next = (step + 1) % kSteps, edge = (kLaps - 1) * kSteps;
    cone.mesh.triangles.push_back({pole, step, next});
    for (int lap = 0; lap + 1 < kLaps; ++lap) {
      const int a = lap * kSteps + step, b = lap * kSteps + next;
      cone.mesh.triangles.push_back({a, a + kSteps, b + kSteps});
      cone.mesh.triangles.push_back({a, b + kSteps, b});
    }
    cone.mesh.triangles.push_back({apex, edge + next, edge + step});
    rim.col(2 * step) = cone.mesh.vertices.col(edge + step);
    rim.col(2 * step + 1) = cone.mesh.vertices.col(edge + next);
  }
  shapes.push_back(cone);
  shapes.push_back(line(name + "/rim", rim, kEnd));
}

/// A joint to a bone is at the bone's start, one between groups amid the particles they share.
Place placeOf(const Skeleton& skeleton, const Joint& joint, const Eigen::Ref<const Points>& x,
              const Quat& parent) {
  const Segment& child = skeleton.segments[joint.child];
  Place place{Vec3::Zero(), parent, 0};
  if (!child.group) {
    place.origin = x.col(child.particles[0]);
    place.reach =
        kReach *
        (skeleton.rest.col(child.particles[1]) - skeleton.rest.col(child.particles[0])).norm();
    return place;
  }
  Part shared;
  shared.group = true;
  const auto& in = skeleton.segments[joint.parent].particles;
  for (const int i : child.particles)
    if (std::count(in.begin(), in.end(), i)) shared.particles.push_back(i);
  if (shared.particles.empty()) shared.particles = child.particles;
  place.origin = partAnchor(shared, x);
  for (const int i : child.particles)
    place.reach = std::max(place.reach,
                           2 * (skeleton.rest.col(i) - partAnchor(shared, skeleton.rest)).norm());
  return place;
}

}  // namespace

std::vector<CoatShape> limitShapes(const Model& model, const FrameTracker& tracker,
                                   const Posture& posture, int ragdoll) {
  const Skeleton& skeleton = model.skeletonOf(model.ragdolls[ragdoll]);
  const FrameTree& tree = tracker.tree(ragdoll);
  const auto x = posture.x.middleCols(tracker.firstParticle(ragdoll), skeleton.size());
  std::vector<CoatShape> shapes;
  for (const Joint& joint : skeleton.joints) {
    const Segment& child = skeleton.segments[joint.child];
    const int parent = tree.partOf(skeleton.segments[joint.parent]);
    if (parent < 0) continue;
    const Place place =
        placeOf(skeleton, joint, x, posture.parts[tracker.firstPart(ragdoll) + parent]);
    if (joint.type == JointSpec::Type::kHinge)
      addHinge(joint.name, place, hingeGeometry(skeleton, joint), joint.range, shapes);
    else if (joint.type == JointSpec::Type::kCone)
      addCone(joint.name, place, joint.axis, joint.half_angle, shapes);
    else
      addPlanes(joint.name, place, joint, skeleton.rest(1, child.particles[0]) > 0,
                !skeleton.segments[joint.parent].group, shapes);
  }
  return shapes;
}

}  // namespace ragdoll
