#include "core/mechanics/energy_removal.h"

#include <algorithm>
#include <cmath>

#include "core/linear/stick_solver.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

/// Bodies as one system of particles.
class Group {
 public:
  Group(const Model& model, const std::vector<int>& bodies, Points& x, Points& v,
        RemovalScratch& scratch)
      : model_(model), bodies_(bodies), x_(x), v_(v), scratch_(scratch) {
    makeRoom(model, scratch_);
  }

  double kineticEnergy() {
    double energy = 0;
    for (const int i : bodies_)
      energy += ragdoll::kineticEnergy(rows(i), v(i), scratch_.energy[ragdoll(i).skeleton]);
    return energy;
  }

  double takeOut(double gain, bool held) {
    for (const int i : bodies_) at(scratch_.before, i) = v(i);  // others move at the same time
    const double before = kineticEnergy();
    for (const int i : bodies_) dampInnerMotion(mass(i), pins(i), 0, x(i), v(i));
    const double rest = kineticEnergy(), inner = before - rest;
    if (inner > gain) {
      const double keep = std::sqrt(1 - gain / inner);
      for (const int i : bodies_) v(i) += keep * (at(scratch_.before, i) - v(i));
      return 0;
    }
    if (!held) return takeOutOfRelative(commonMotion(), gain - inner);
    return takeOutOfRelative(RigidMotion(), gain - inner);
  }

 private:
  const Ragdoll& ragdoll(int i) const { return model_.ragdolls[i]; }
  const StickRows& rows(int i) const { return *model_.systemOf(ragdoll(i)).direct.rows; }
  const std::vector<int>& pins(int i) const { return model_.systemOf(ragdoll(i)).pins; }
  MassMatrix mass(int i) const { return {rows(i), scratch_.energy[ragdoll(i).skeleton]}; }
  Eigen::Ref<Points> at(Points& all, int i) const {
    return all.middleCols(ragdoll(i).first, rows(i).n);
  }
  Eigen::Ref<Points> x(int i) const { return at(x_, i); }
  Eigen::Ref<Points> v(int i) const { return at(v_, i); }

  /// The rigid motion with the momentum and angular momentum of all bodies.
  RigidMotion commonMotion() const {
    if (bodies_.size() == 1) return rigidMotion(mass(bodies_[0]), {}, x(bodies_[0]), v(bodies_[0]));
    double total = 0;
    RigidMotion common;
    for (const int i : bodies_) {
      total += rows(i).mass.sum();
      common.centre += x(i).lazyProduct(rows(i).mass);
      common.drift += v(i).lazyProduct(rows(i).mass);
    }
    common.centre /= total;
    common.drift /= total;
    Rotation all;
    for (const int i : bodies_) {
      const Rotation own = rotationOf(mass(i), x(i), v(i), common);
      all.inertia += own.inertia;
      all.angular += own.angular;
    }
    common.spin = spinOf(all.inertia, all.angular);
    return common;
  }

  /// Takes it out of the motion against a rigid one; returns what is left of it.
  double takeOutOfRelative(const RigidMotion& common, double gain) {
    for (const int i : bodies_) shift(i, common, -1);
    const double relative = kineticEnergy();
    const double keep = relative > 0 ? std::sqrt(std::max(0.0, 1 - gain / relative)) : 0;
    for (const int i : bodies_) {
      v(i) *= keep;
      shift(i, common, 1);
    }
    return std::max(0.0, gain - relative);
  }

  /// Adds so many times the rigid motion.
  void shift(int i, const RigidMotion& motion, double times) {
    auto own = v(i);
    const auto points = x(i);
    for (Eigen::Index p = 0; p < own.cols(); ++p)
      own.col(p) += times * motion.velocityAt(points.col(p));
  }

  const Model& model_;
  const std::vector<int>& bodies_;
  Points &x_, &v_;
  RemovalScratch& scratch_;
};

}  // namespace

void makeRoom(const Model& model, RemovalScratch& s) {
  for (Points* of : {&s.before, &s.x, &s.v}) of->resize(3, model.size());
  if (s.energy.size() == model.skeletons.size()) return;
  s.energy.resize(model.skeletons.size());
  for (const Ragdoll& r : model.ragdolls)
    makeRoom(*model.systemOf(r).direct.rows, s.energy[r.skeleton]);
}

double takeEnergyOut(const Model& model, const std::vector<int>& bodies, bool held, double gain,
                     Points& x, Points& v, RemovalScratch& scratch) {
  return Group(model, bodies, x, v, scratch).takeOut(gain, held);
}

}  // namespace ragdoll
