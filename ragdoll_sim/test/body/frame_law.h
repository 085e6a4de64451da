// The law of continuous frames, for motions made by hand and by the simulator: no frame turns by
// more between two updates than the angular motion of the particles explains.
//
// Angular motion is what particles show, measured here without the product's code: of a group, the
// rotation that takes its points from one update to the next (Kabsch 1976, by singular values); of
// a bone, the angle between its directions. A group has no freedom beyond that. A bone's twist is
// nothing that its own two particles show: its frame is carried along by its parent's and by the
// smallest rotation of its direction (parallel transport), and may turn beyond that by kPull times
// what the bone and the one beyond it are seen to move then (docs/body.md). A flip turns a frame
// while next to nothing moves. Step by step that follows from how frames are made, whatever the
// motion; many add up to less than kTurned (0.48 to 0.66 in ten minutes of tumbling).
#pragma once

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <utility>
#include <vector>

#include "ragdoll_sim/body/frames.h"

namespace ragdoll::test {

constexpr double kPull = 1.5;  ///< [rad/rad] in one update
constexpr double kTurned = 1;  ///< [rad/rad] of the bones' turns to the motion around, in a run

/// [rad] exact for small angles
inline double angle(const Quat& a, const Quat& b) {
  const Quat q = a.conjugate() * b;
  return 2 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

inline double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The motion of one ragdoll's particles between the last two updates.
class AngularMotion {
 public:
  AngularMotion(const FrameTracker& tracker, int ragdoll)
      : tracker_(tracker),
        tree_(tracker.tree(ragdoll)),
        ragdoll_(ragdoll),
        first_(tracker.firstParticle(ragdoll)) {
    for (int p = 0; p < static_cast<int>(tree_.parts.size()); ++p)
      own_.push_back(tree_.parts[p].group ? ofGroup(p) : ofBone(p));
  }

  /// [rad] of the part alone
  double own(int part) const { return own_[part]; }
  /// [rad] turn of the bone's frame beyond parallel transport, and what was seen to move then.
  std::pair<double, double> beyondTransport(int part) const {
    const Part& bone = tree_.parts[part];
    const Posture &before = tracker_.previous(), &now = tracker_.now();
    const Quat& frame = before.parts[tracker_.firstPart(ragdoll_) + part];
    const Quat parent_before = orientation(before, bone.parent);
    const Quat parent = orientation(now, bone.parent);
    const Vec3 from = parent_before.conjugate() * direction(before, part);
    const Vec3 to = parent.conjugate() * direction(now, part);
    const Quat transport = parent * Quat::FromTwoVectors(from, to) * parent_before.conjugate();
    double seen = angle(from, to);
    if (bone.bends >= 0)
      seen += angle(transport * direction(before, bone.bends), direction(now, bone.bends));
    return {angle(transport * frame, now.parts[tracker_.firstPart(ragdoll_) + part]), seen};
  }
  /// [rad] of the part, all that it hangs on, and the bone beyond it
  double around(int part) const {
    double sum = tree_.parts[part].bends >= 0 ? own_[tree_.parts[part].bends] : 0;
    for (int p = part; p >= 0; p = tree_.parts[p].parent) sum += own_[p];
    return sum;
  }
  /// [-] by how much a group was deformed, of its size
  double deformation(int part) const { return deformation_[part]; }
  Vec3 direction(const Posture& posture, int part) const {
    const std::vector<int>& ends = tree_.parts[part].particles;
    return (posture.x.col(first_ + ends[1]) - posture.x.col(first_ + ends[0])).normalized();
  }

 private:
  Quat orientation(const Posture& posture, int part) const {
    return part < 0 ? Quat::Identity() : posture.parts[tracker_.firstPart(ragdoll_) + part];
  }
  Points points(const Posture& posture, int part) const {
    const std::vector<int>& members = tree_.parts[part].particles;
    Points x(3, members.size());
    for (std::size_t k = 0; k < members.size(); ++k) x.col(k) = posture.x.col(first_ + members[k]);
    return x.colwise() - x.rowwise().mean();
  }
  double ofBone(int part) {
    deformation_.push_back(0);
    return angle(direction(tracker_.previous(), part), direction(tracker_.now(), part));
  }
  double ofGroup(int part) {
    const Points before = points(tracker_.previous(), part), now = points(tracker_.now(), part);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(now * before.transpose(),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double side = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    const Eigen::Matrix3d turn =
        svd.matrixU() * Vec3(1, 1, side).asDiagonal() * svd.matrixV().transpose();
    deformation_.push_back((now - turn * before).norm() / before.norm());
    return angle(Quat::Identity(), Quat(turn));
  }

  const FrameTracker& tracker_;
  const FrameTree& tree_;
  int ragdoll_, first_;
  std::vector<double> own_, deformation_;
};

/// What the frames did.
struct FrameRecord {
  double step = 0;               ///< [rad] largest turn of a part from one update to the next
  double turned = 0, moved = 0;  ///< [rad] the bones' frames, and the motion around them, added up
  double share() const { return turned / moved; }
};

/// Expects the law of the ragdoll's last update; that no quaternion has changed its sign, and that
/// bones point where their particles are.
inline void expectContinuous(const FrameTracker& tracker, int ragdoll, FrameRecord& record) {
  constexpr double kRounding = 1e-9;
  const FrameTree& tree = tracker.tree(ragdoll);
  const AngularMotion motion(tracker, ragdoll);
  const Quat* q0 = &tracker.previous().parts[tracker.firstPart(ragdoll)];
  const Quat* q1 = &tracker.now().parts[tracker.firstPart(ragdoll)];
  const double when = tracker.now().time;
  for (int p = 0; p < static_cast<int>(tree.parts.size()); ++p) {
    const Part& part = tree.parts[p];
    const double step = angle(q0[p], q1[p]);
    record.step = std::max(record.step, step);
    EXPECT_GT(q0[p].dot(q1[p]), 0) << part.name << " changed its sign at " << when;
    if (part.group) {
      // Exactly as its points; where the solver lets them give way, as far as that leaves open.
      EXPECT_NEAR(step, motion.own(p), 1e-7 + 3 * motion.deformation(p))
          << part.name << " at " << when;
      continue;
    }
    EXPECT_LT(angle(Vec3(q1[p] * part.rest_direction), motion.direction(tracker.now(), p)),
              kRounding)
        << part.name << " at " << when;
    const auto beyond = motion.beyondTransport(p);
    EXPECT_LE(beyond.first, kPull * beyond.second + 1e-7) << part.name << " at " << when;
    record.turned += step;
    record.moved += motion.around(p);
  }
}

}  // namespace ragdoll::test
