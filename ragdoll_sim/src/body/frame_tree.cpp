#include "ragdoll_sim/body/frame_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ragdoll {
namespace {

using Names = std::vector<std::string>;

std::vector<int> sorted(std::vector<int> v) {
  std::sort(v.begin(), v.end());
  return v;
}

/// All points on one line (or in one place): such a group has no orientation of its own.
bool isLine(const Skeleton& s, const std::vector<int>& particles) {
  const Vec3 origin = s.rest.col(particles[0]);
  Vec3 longest = Vec3::Zero();
  for (const int i : particles)
    if ((s.rest.col(i) - origin).norm() > longest.norm()) longest = s.rest.col(i) - origin;
  for (const int i : particles)
    if ((s.rest.col(i) - origin).cross(longest).norm() > 1e-6 * longest.squaredNorm()) return false;
  return true;
}

class Builder {
 public:
  explicit Builder(const Skeleton& skeleton)
      : s_(skeleton), frame_of_(skeleton.size(), -1), reached_by_(skeleton.size(), -1) {}

  FrameTree build() {
    if (isHuman())
      buildHuman();
    else
      buildRoot();
    grow();
    for (const Joint& joint : s_.joints) readJoint(joint);
    for (Part& part : tree_.parts) completePart(part);
    return std::move(tree_);
  }

 private:
  // --- human
  bool isHuman() const {
    static const std::array<const char*, 16> names = {
        "head",      "neck",       "left_shoulder", "right_shoulder", "left_elbow", "right_elbow",
        "left_hand", "right_hand", "left_hip",      "right_hip",      "left_leg",   "right_leg",
        "left_knee", "right_knee", "left_foot",     "right_foot"};
    return std::all_of(names.begin(), names.end(),
                       [&](const char* name) { return s_.particle(name) >= 0; });
  }

  void buildHuman() {
    tree_.human = true;
    const int pelvis =
        addPart("pelvis", indices({"left_hip", "right_hip", "left_leg", "right_leg"}), -1);
    const int torso = addPart(
        "torso", indices({"neck", "left_shoulder", "right_shoulder", "left_hip", "right_hip"}), -1);
    const int head = addPart("head", indices({"neck", "head"}), torso);
    const int root = addFrame("pelvis", {"left_hip", "right_hip"}, -1, pelvis);
    const int neck = addFrame("neck", {"neck"}, root, torso);
    addFrame("head", {"head"}, neck, head);
    for (const std::string side : {"left_", "right_"}) {
      addFrame(side + "hip", {side + "hip"}, root, pelvis);
      addLimb(side, {"shoulder", "elbow", "hand"}, {"upper_arm", "forearm"}, neck, torso);
      addLimb(side, {"leg", "knee", "foot"}, {"thigh", "shank"}, root, pelvis);
    }
    for (Part& part : tree_.parts) setHumanRange(part);
  }

  void addLimb(const std::string& side, const Names& joints, const Names& bones, int frame,
               int part) {
    const int upper = addPart(side + bones[0], indices({side + joints[0], side + joints[1]}), part);
    const int lower =
        addPart(side + bones[1], indices({side + joints[1], side + joints[2]}), upper);
    frame = addFrame(side + joints[0], {side + joints[0]}, frame, upper);
    frame = addFrame(side + joints[1], {side + joints[1]}, frame, lower);
    addFrame(side + joints[2], {side + joints[2]}, frame, lower);
    const double forward = joints[0] == "leg" ? 1 : -1;  // knees turn about +y, elbows about -y
    setHinge(upper, lower, Vec3(0, forward, 0));
  }

  /// Where shoulders and hips mostly point: forward and down, arms outward, too.
  void setHumanRange(Part& part) {
    const int from = part.particles[0];
    const double side = s_.rest(1, from) < 0 ? -1 : 1;
    if (s_.particles[from].find("_shoulder") != std::string::npos)
      part.centre_direction = Vec3(0.6, 0.6 * side, -0.5).normalized();
    if (s_.particles[from].find("_leg") != std::string::npos && !part.group)
      part.centre_direction = Vec3(0.6, 0, -0.8).normalized();
  }

  // --- any skeleton
  void buildRoot() {
    const Segment* root = nullptr;
    for (const Segment& segment : s_.segments)
      if (segment.particles.size() > 2 && !isLine(s_, segment.particles) &&
          (!root || segment.particles.size() > root->particles.size()))
        root = &segment;
    for (const Segment& segment : s_.segments)
      if (segment.particles.size() > 2 && !isLine(s_, segment.particles))
        addPart(segment.name, segment.particles, -1);
    if (root) {
      const int part = tree_.partOf(*root);
      const std::string name = root->name + (s_.particle(root->name) >= 0 ? "_base" : "");
      tree_.frames.push_back({name, -1, root->particles, part});
      for (const int i : sorted(root->particles)) addParticle(i, 0, part);
    }
  }

  /// Breadth first along sticks and bones from the frames that are there; then the next loose
  /// piece.
  void grow() {
    const auto neighbours = adjacency();
    std::vector<int> queue;
    for (int i = 0; i < s_.size(); ++i)
      if (frame_of_[i] >= 0) queue.push_back(i);
    for (int root = 0;;) {
      for (std::size_t k = 0; k < queue.size(); ++k)
        for (const int next : neighbours[queue[k]]) visit(queue[k], next, queue);
      while (root < s_.named && frame_of_[root] >= 0) ++root;
      if (root == s_.named) break;
      addParticle(root, -1, groupOf(root));
      queue.assign(1, root);
    }
    for (const Stick& stick : s_.sticks) addBone(stick.a, stick.b);  // those that close a loop
  }

  std::vector<std::vector<int>> adjacency() const {
    std::vector<std::vector<int>> neighbours(s_.size());
    const auto link = [&](int a, int b) {
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    };
    for (const Stick& stick : s_.sticks) link(stick.a, stick.b);
    for (const Segment& segment : s_.segments)
      for (std::size_t k = 1; k < segment.particles.size(); ++k)
        link(segment.particles[k - 1], segment.particles[k]);
    for (auto& list : neighbours) list = sorted(list);
    return neighbours;
  }

  void visit(int from, int to, std::vector<int>& queue) {
    const int part = addBone(from, to);
    if (frame_of_[to] >= 0) return;
    addParticle(to, frame_of_[from], part);
    queue.push_back(to);
    // The first bone that begins at a particle turns its frame.
    FrameSpec& frame = tree_.frames[frame_of_[from]];
    const bool begins = !tree_.parts[part].group && frame.part == reached_by_[from];
    if (!tree_.human && begins) frame.part = part;
  }

  /// The part that holds both particles; made if there is none.
  int addBone(int from, int to) {
    for (std::size_t p = 0; p < tree_.parts.size(); ++p) {
      const auto& in = tree_.parts[p].particles;
      if (std::count(in.begin(), in.end(), from) && std::count(in.begin(), in.end(), to))
        return static_cast<int>(p);
    }
    const int parent = groupOf(from) >= 0 ? groupOf(from) : reached_by_[from];
    return addPart(s_.particles[from] + "_" + s_.particles[to], std::vector<int>{from, to}, parent);
  }

  int groupOf(int particle) const {
    for (std::size_t p = 0; p < tree_.parts.size(); ++p) {
      const Part& part = tree_.parts[p];
      if (part.group && std::count(part.particles.begin(), part.particles.end(), particle))
        return static_cast<int>(p);
    }
    return -1;
  }

  // --- both
  int addPart(const std::string& name, const std::vector<int>& particles, int parent) {
    Part part;
    part.name = name;
    for (const Segment& segment : s_.segments)
      if (sorted(segment.particles) == sorted(particles)) part.name = segment.name;
    part.particles = particles;
    part.group = particles.size() > 2;
    part.parent = parent;
    tree_.parts.push_back(part);
    return static_cast<int>(tree_.parts.size()) - 1;
  }

  int addFrame(const std::string& name, const Names& particles, int parent, int part) {
    const int frame = static_cast<int>(tree_.frames.size());
    tree_.frames.push_back({name, parent, indices(particles), part});
    if (particles.size() == 1) {
      frame_of_[indices(particles)[0]] = frame;
      reached_by_[indices(particles)[0]] = part;
    }
    return frame;
  }

  void addParticle(int particle, int parent_frame, int part) {
    frame_of_[particle] = static_cast<int>(tree_.frames.size());
    reached_by_[particle] = part;
    tree_.frames.push_back({s_.particles[particle], parent_frame, {particle}, part});
  }

  std::vector<int> indices(const Names& names) const {
    std::vector<int> result;
    for (const std::string& name : names) result.push_back(s_.particle(name));
    return result;
  }

  void setHinge(int upper, int lower, const Vec3& axis) {
    Part& parent = tree_.parts[upper];
    Part& child = tree_.parts[lower];
    child.hinged = true;
    child.hinge_axis = axis.normalized();
    child.straight = parent.group ? direction(child) : direction(parent);
    if (parent.group) return;
    parent.bends = lower;
    parent.bend_axis = axis.normalized();
  }

  Vec3 direction(const Part& part) const {
    const Vec3 d = s_.rest.col(part.particles[1]) - s_.rest.col(part.particles[0]);
    return d.norm() > kMinLength ? Vec3(d.normalized()) : Vec3::UnitZ();
  }

  void readJoint(const Joint& joint) {
    const int parent = tree_.partOf(s_.segments[joint.parent]);
    const int child = tree_.partOf(s_.segments[joint.child]);
    if (child < 0 || tree_.parts[child].group || tree_.parts[child].parent != parent) return;
    if (joint.type == JointSpec::Type::kCone) tree_.parts[child].centre_direction = joint.axis;
    if (joint.type == JointSpec::Type::kHinge && parent >= 0) setHinge(parent, child, joint.axis);
  }

  void completePart(Part& part) {
    if (part.group) return;
    part.rest_direction = direction(part);
    Vec3& centre = part.centre_direction;
    centre = centre.norm() > 0.5 ? Vec3(centre.normalized()) : part.rest_direction;
    if (centre.dot(part.rest_direction) < -0.9) centre = part.rest_direction;
  }

  const Skeleton& s_;
  FrameTree tree_;
  std::vector<int> frame_of_;    ///< per particle
  std::vector<int> reached_by_;  ///< per particle: part by which the tree came to it
};

template <class List>
int indexOf(const List& list, const std::string& name) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace

int FrameTree::frame(const std::string& name) const { return indexOf(frames, name); }
int FrameTree::part(const std::string& name) const { return indexOf(parts, name); }

int FrameTree::partOf(const Segment& segment) const {
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (sorted(parts[p].particles) == sorted(segment.particles)) return static_cast<int>(p);
  return -1;
}

FrameTree buildFrameTree(const Skeleton& skeleton) { return Builder(skeleton).build(); }

}  // namespace ragdoll
