#include "ragdoll_sim/body/frames.h"

#include <algorithm>
#include <numeric>

#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll {
namespace {

/// Orientations of one ragdoll's parts, from those before and the particles before and now.
struct Follower {
  const FrameTree& tree;
  const Points& rest;
  Eigen::Ref<const Points> x;
  const Quat* before;
  Quat* now;
  bool free;  ///< a start: only the direction of things counts, not what was before

  Vec3 directionBefore(int p) const { return before[p] * tree.parts[p].rest_direction; }
  Vec3 directionNow(int p) const { return boneDirection(tree.parts[p], x, directionBefore(p)); }

  void follow(int p) const {
    const Part& part = tree.parts[p];
    if (part.group) {
      now[p] = groupOrientation(part, rest, x, before[p]);
      return;
    }
    BoneMotion m;
    m.parent_before = part.parent < 0 ? Quat::Identity() : before[part.parent];
    m.parent_now = part.parent < 0 ? Quat::Identity() : now[part.parent];
    m.before = before[p];
    m.direction = directionNow(p);
    m.bends = part.bends >= 0;
    if (m.bends) {
      m.beyond_before = directionBefore(part.bends);
      m.beyond_now = directionNow(part.bends);
    }
    now[p] = followBone(part, m, free);
  }

  void follow(const std::vector<int>& parts) const {
    for (const int p : parts) follow(p);
  }
};

/// Marks a part and all whose orientations its own is computed from.
void mark(const FrameTree& tree, int part, std::vector<char>& marked) {
  if (part < 0 || marked[part]) return;
  marked[part] = 1;
  mark(tree, tree.parts[part].parent, marked);
  mark(tree, tree.parts[part].bends, marked);
}

}  // namespace

FrameTracker::FrameTracker(const Model& model, const std::string& prefix) {
  std::vector<std::shared_ptr<const FrameTree>> trees;
  std::vector<std::shared_ptr<const Points>> rests;
  for (const Skeleton& skeleton : model.skeletons) {
    trees.push_back(std::make_shared<FrameTree>(buildFrameTree(skeleton)));
    rests.push_back(std::make_shared<Points>(skeleton.rest));
  }
  int part = 0, frame = 0;
  for (const Ragdoll& ragdoll : model.ragdolls) {
    const auto& tree = trees[ragdoll.skeleton];
    std::vector<int> all(tree->parts.size());
    std::iota(all.begin(), all.end(), 0);
    bodies_.push_back({tree, rests[ragdoll.skeleton], ragdoll.first, part, frame, std::move(all)});
    for (const FrameSpec& spec : tree->frames) {
      names_.push_back(prefix + ragdoll.name + "/" + spec.name);
      parents_.push_back(spec.parent < 0 ? -1 : frame + spec.parent);
    }
    part += static_cast<int>(tree->parts.size());
    frame += static_cast<int>(tree->frames.size());
  }
  now_.x = model.start_position;
  now_.parts.assign(part, Quat::Identity());
  now_.frames.resize(frame);
  place(now_);
  previous_ = now_;
}

void FrameTracker::followOnly(const std::vector<int>& parts) {
  for (Body& body : bodies_) {
    std::vector<char> marked(body.tree->parts.size(), 0);
    for (const int part : parts)
      if (part >= body.first_part && part < body.first_part + static_cast<int>(marked.size()))
        mark(*body.tree, part - body.first_part, marked);
    const auto idle = [&marked](int p) { return !marked[p]; };
    body.followed.erase(std::remove_if(body.followed.begin(), body.followed.end(), idle),
                        body.followed.end());
  }
  frames_ = false;
}

void FrameTracker::reset(const State& state) {
  std::fill(now_.parts.begin(), now_.parts.end(), Quat::Identity());
  previous_ = now_;
  now_.time = state.time;
  now_.x = state.x;
  for (const Body& body : bodies_) {
    const auto x = state.x.middleCols(body.first_particle, body.rest->cols());
    const Quat* before = previous_.parts.data() + body.first_part;
    Quat* now = now_.parts.data() + body.first_part;
    Follower{*body.tree, *body.rest, x, before, now, true}.follow(body.followed);
  }
  place(now_);
  previous_ = now_;
}

void FrameTracker::update(const State& state) {
  std::swap(now_, previous_);
  now_.time = state.time;
  now_.x = state.x;
  for (const Body& body : bodies_) {
    const auto x = state.x.middleCols(body.first_particle, body.rest->cols());
    const Quat* before = previous_.parts.data() + body.first_part;
    Quat* now = now_.parts.data() + body.first_part;
    if (x == previous_.x.middleCols(body.first_particle, body.rest->cols()))  // it sleeps
      std::copy_n(before, body.tree->parts.size(), now);
    else
      Follower{*body.tree, *body.rest, x, before, now, false}.follow(body.followed);
  }
  place(now_);
}

void FrameTracker::interpolate(double alpha, Posture& out) const {
  out.time = previous_.time + alpha * (now_.time - previous_.time);
  out.x = previous_.x + alpha * (now_.x - previous_.x);
  out.parts.resize(now_.parts.size());
  out.frames.resize(now_.frames.size());
  for (std::size_t p = 0; p < out.parts.size(); ++p)
    out.parts[p] = previous_.parts[p].slerp(alpha, now_.parts[p]);
  place(out);
}

Pose FrameTracker::local(const Posture& posture, int frame) const {
  const Pose& child = posture.frames[frame];
  if (parents_[frame] < 0) return child;
  const Pose& parent = posture.frames[parents_[frame]];
  const Quat back = parent.orientation.conjugate();
  return {back * (child.position - parent.position), back * child.orientation};
}

void FrameTracker::place(Posture& posture) const {
  if (!frames_) return;
  for (const Body& body : bodies_) {
    for (std::size_t f = 0; f < body.tree->frames.size(); ++f) {
      const FrameSpec& spec = body.tree->frames[f];
      Pose& pose = posture.frames[body.first_frame + f];
      pose.position.setZero();
      for (const int i : spec.particles) pose.position += posture.x.col(body.first_particle + i);
      pose.position /= static_cast<double>(spec.particles.size());
      if (spec.part >= 0) pose.orientation = posture.parts[body.first_part + spec.part];
    }
  }
}

}  // namespace ragdoll
