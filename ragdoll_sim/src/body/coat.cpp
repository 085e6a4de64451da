#include "ragdoll_sim/body/coat.h"

#include "body/rigid_coat.h"
#include "ragdoll_sim/body/skin.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

constexpr Rgba kObstacleColor{0.62f, 0.64f, 0.67f, 1};
constexpr Rgba kFloorColor{0.80f, 0.81f, 0.80f, 1};
constexpr double kSlab = 0.02;  ///< [m] thickness of a plane that is drawn

CoatShape lines(const Points& x) {
  CoatShape shape;
  shape.type = CoatShape::Type::kLines;
  shape.name = "sticks";
  shape.size = Vec3::Constant(sticks_look::kWidth);
  shape.color = sticks_look::kColor;
  shape.points = x;
  return shape;
}

CoatShape spheres(const Points& x) {
  CoatShape shape;
  shape.type = CoatShape::Type::kSpheres;
  shape.name = "particles";
  shape.size = Vec3::Constant(sticks_look::kParticleSize);
  shape.color = sticks_look::kParticleColor;
  shape.points = x;
  return shape;
}

CoatShape body(const Mesh& mesh) {
  CoatShape shape;
  shape.type = CoatShape::Type::kMesh;
  shape.name = "body";
  shape.mesh = mesh;
  return shape;
}

}  // namespace

struct Coat::Impl {
  const Skeleton skeleton;
  int first_particle, first_part;
  std::unique_ptr<RigidCoat> rigid;
  std::unique_ptr<Skin> skin;

  Impl(const Model& model, const FrameTracker& tracker, int ragdoll)
      : skeleton(model.skeletonOf(model.ragdolls[ragdoll])),
        first_particle(tracker.firstParticle(ragdoll)),
        first_part(tracker.firstPart(ragdoll)) {}
};

CoatKind coatKind(const std::string& name) {
  if (name == "none") return CoatKind::kNone;
  if (name == "sticks") return CoatKind::kSticks;
  if (name == "boxes") return CoatKind::kBoxes;
  if (name == "capsules") return CoatKind::kCapsules;
  if (name == "skin") return CoatKind::kSkin;
  throw Error("coat", "'" + name + "' is not one of none, sticks, boxes, capsules, skin");
}

Coat::Coat(CoatKind kind, const Model& model, const FrameTracker& tracker, int ragdoll)
    : kind_(kind), impl_(std::make_unique<Impl>(model, tracker, ragdoll)) {
  const Skeleton& skeleton = impl_->skeleton;
  const FrameTree& tree = tracker.tree(ragdoll);
  if (kind == CoatKind::kNone) return;
  if (kind == CoatKind::kSticks) {
    shapes_.push_back(lines(Points::Zero(3, 2 * skeleton.sticks.size())));
    shapes_.push_back(spheres(Points::Zero(3, skeleton.named)));
  } else if (kind == CoatKind::kSkin && tree.human) {
    impl_->skin = std::make_unique<Skin>(humanSkin(skeleton, tree), skeleton, tree);
    shapes_.push_back(body(impl_->skin->rest()));
  } else {
    const auto pieces =
        kind == CoatKind::kBoxes ? boxPieces(skeleton, tree) : capsulePieces(skeleton, tree);
    impl_->rigid = std::make_unique<RigidCoat>(pieces, skeleton, tree);
    shapes_.push_back(body(impl_->rigid->rest()));
    shapes_.back().parts = impl_->rigid->partOfVertex();
  }
  update(tracker.now());
}

Coat::~Coat() = default;
Coat::Coat(Coat&&) noexcept = default;
Coat& Coat::operator=(Coat&&) noexcept = default;

void Coat::update(const Posture& posture, const FrameTracker& tracker, int ragdoll) {
  impl_->first_particle = tracker.firstParticle(ragdoll);
  impl_->first_part = tracker.firstPart(ragdoll);
  update(posture);
}

void Coat::update(const Posture& posture) {
  const Skeleton& skeleton = impl_->skeleton;
  const auto x = posture.x.middleCols(impl_->first_particle, skeleton.size());
  if (kind_ == CoatKind::kSticks) {
    for (std::size_t k = 0; k < skeleton.sticks.size(); ++k) {
      shapes_[0].points.col(2 * k) = x.col(skeleton.sticks[k].a);
      shapes_[0].points.col(2 * k + 1) = x.col(skeleton.sticks[k].b);
    }
    shapes_[1].points = x.leftCols(skeleton.named);
  } else if (impl_->rigid) {
    impl_->rigid->pose(x, posture.parts.data() + impl_->first_part, shapes_[0].mesh);
  } else if (impl_->skin) {
    impl_->skin->deform(x, posture.parts.data() + impl_->first_part, Blend::kDualQuaternion,
                        shapes_[0].mesh);
  }
}

CoatShape obstacleShape(const Obstacle& obstacle, double plane_size) {
  CoatShape shape;
  shape.color = kObstacleColor;
  switch (obstacle.type) {
    case ObstacleSpec::Type::kPlane:
      shape.name = "plane";
      shape.pose.position = Vec3(0, 0, -kSlab / 2);
      shape.size = Vec3(plane_size, plane_size, kSlab);
      shape.color = kFloorColor;
      break;
    case ObstacleSpec::Type::kBox:
      shape.name = "box";
      shape.size = 2 * obstacle.half;
      break;
    case ObstacleSpec::Type::kSphere:
      shape.type = CoatShape::Type::kSphere;
      shape.name = "sphere";
      shape.size = Vec3::Constant(2 * obstacle.radius);
      break;
    case ObstacleSpec::Type::kCapsule:
      shape.type = CoatShape::Type::kMesh;
      shape.name = "capsule";
      shape.mesh = roundCone(Vec3(0, 0, -obstacle.half.z()), obstacle.radius,
                             Vec3(0, 0, obstacle.half.z()), obstacle.radius, 32, 8);
      break;
  }
  return shape;
}

}  // namespace ragdoll
