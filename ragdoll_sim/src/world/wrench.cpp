#include "ragdoll_sim/world/wrench.h"

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/world/text.h"

namespace ragdoll {
namespace {

BodyRef bodyOf(int ragdoll, int first, const std::vector<int>& particles) {
  BodyRef body;
  body.ragdoll = ragdoll;
  for (const int p : particles) {
    body.particles.push_back(first + p);
    body.weight.push_back(1.0 / static_cast<double>(particles.size()));
  }
  return body;
}

/// Adds two opposite forces with no sum and the moment `torque` [N m].
void addCouple(const BodyRef& body, const Vec3& torque, const State& state, Points& forces) {
  Poke poke;
  poke.body = body;
  const Vec3 arm = torque.unitOrthogonal();  // 1 m
  for (const double side : {1.0, -1.0}) {
    poke.point = side * arm;
    poke.force = side * 0.5 * torque.cross(arm);
    addForce(poke, state, forces);
  }
}

/// One poke for each particle of the ragdoll that feels a force.
void appendPokes(const Model& model, int r, const Points& forces, std::vector<Poke>& pokes) {
  const Ragdoll& ragdoll = model.ragdolls[r];
  const std::vector<std::string>& names = model.skeletonOf(ragdoll).particles;
  for (int i = 0; i < static_cast<int>(names.size()); ++i) {
    if (forces.col(ragdoll.first + i).isZero(0)) continue;
    Poke poke;
    poke.body = bodyOf(r, ragdoll.first, {i});
    poke.body_name = ragdoll.name + "/" + names[i];
    poke.force = forces.col(ragdoll.first + i);
    pokes.push_back(poke);
  }
}

}  // namespace

std::vector<Poke> wrenchPokes(const World& world, const std::string& frame, const Vec3& force,
                              const Vec3& torque) {
  const FrameTracker& tracker = world.tracker();
  const std::optional<Pose> pose = world.frame(frame);
  if (!pose) {
    throw Error("frame_id", "'" + frame + "' is not a ragdoll's frame; there are " +
                                listed(world.frameNames()));
  }
  Points forces = Points::Zero(3, world.model()->size());
  std::vector<Poke> pokes;
  for (int r = 0; r < tracker.ragdolls(); ++r) {
    const FrameTree& tree = tracker.tree(r);
    const int first = tracker.firstParticle(r);
    for (std::size_t f = 0; f < tree.frames.size(); ++f) {
      if (tracker.name(tracker.firstFrame(r) + static_cast<int>(f)) != frame) continue;
      const FrameSpec& spec = tree.frames[f];
      Poke push;
      push.body = bodyOf(r, first, spec.particles);
      push.force = pose->orientation * force;
      addForce(push, world.state(), forces);
      if (!torque.isZero() && spec.part >= 0)
        addCouple(bodyOf(r, first, tree.parts[spec.part].particles), pose->orientation * torque,
                  world.state(), forces);
      appendPokes(*world.model(), r, forces, pokes);
    }
  }
  return pokes;
}

}  // namespace ragdoll
