#include "core/loading/skeleton.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/loading/contact_regions.h"
#include "core/loading/rest_pose.h"
#include "core/loading/rigid_groups.h"
#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll {

namespace {

constexpr std::size_t kMaxHidden = 3000;  ///< pairs in rigid groups; matrices over them are dense

int particleOr(const Skeleton& s, const std::string& name, const std::string& where) {
  const int i = s.particle(name);
  if (i < 0)
    throw Error(where, "unknown particle '" + name + "'; the model has " + joined(s.particles));
  return i;
}

void addParticles(const SkeletonSpec& spec, Skeleton& s) {
  const int n = static_cast<int>(spec.particles.size());
  if (n == 0) throw Error(spec.where, "particles: a model needs at least one particle");
  s.rest.resize(3, n);
  s.radius.resize(n);
  for (int i = 0; i < n; ++i) {
    const ParticleSpec& p = spec.particles[i];
    if (p.name.empty() || p.name.find('/') != std::string::npos)
      throw Error(p.where, "name '" + p.name + "' must be a word without '/'");
    if (s.particle(p.name) >= 0)
      throw Error(p.where, "name '" + p.name + "' is another particle's; each needs its own");
    checkPosition(p.where + ".position", p.position);
    if (!(std::isfinite(p.mass) && p.mass >= 0))
      throw Error(p.where + ".mass",
                  "mass of '" + p.name + "' is " + numberText(p.mass) + "; it must be >= 0 [kg]");
    if (!(std::isfinite(p.radius) && p.radius >= 0))
      throw Error(p.where + ".radius", "radius of '" + p.name + "' is " + numberText(p.radius) +
                                           "; it must be >= 0 [m]");
    checkLength(p.where + ".radius", p.radius);
    s.particles.push_back(p.name);
    s.rest.col(i) = p.position;
    s.radius[i] = p.radius;
  }
}

void addSticks(const SkeletonSpec& spec, Skeleton& s) {
  std::set<std::pair<int, int>> seen;
  for (const StickSpec& k : spec.sticks) {
    Stick stick;
    stick.a = particleOr(s, k.a, k.where);
    stick.b = particleOr(s, k.b, k.where);
    const std::string name = stickName(s, stick.a, stick.b);
    if (stick.a == stick.b) throw Error(k.where, "stick " + name + " joins a particle to itself");
    if (!seen.insert(std::minmax(stick.a, stick.b)).second)
      throw Error(k.where, "stick " + name + " is there twice; once is right");
    stick.length = k.length ? *k.length : (s.rest.col(stick.a) - s.rest.col(stick.b)).norm();
    if (!(std::isfinite(stick.length) && stick.length > kMinLength))
      throw Error(k.where, "stick " + name + " has length " + numberText(stick.length) +
                               "; it must be > 0 [m]");
    checkLength(k.where, stick.length);
    s.sticks.push_back(stick);
  }
}

void addSegments(const SkeletonSpec& spec, Skeleton& s) {
  for (const SegmentSpec& g : spec.segments) {
    if (s.segment(g.name) >= 0)
      throw Error(g.where, "name '" + g.name + "' is another segment's; each needs its own");
    Segment segment;
    segment.name = g.name;
    segment.group = g.group;
    for (const std::string& p : g.particles) {
      const int i = particleOr(s, p, g.where);
      if (std::count(segment.particles.begin(), segment.particles.end(), i))
        throw Error(g.where, "segment '" + g.name + "' names particle '" + p + "' twice");
      segment.particles.push_back(i);
    }
    if (segment.particles.size() < 2 || (!g.group && segment.particles.size() != 2))
      throw Error(g.where, "segment '" + g.name +
                               "' needs two particles (from, to), or a group of three or more");
    if (!(std::isfinite(g.mass) && g.mass >= 0))
      throw Error(g.where + ".mass", "mass of segment '" + g.name + "' is " + numberText(g.mass) +
                                         "; it must be >= 0 [kg]");
    segment.contact = complianceOf(g.contact, g.where + ".contact");
    s.segments.push_back(std::move(segment));
  }
}

void addJoints(const SkeletonSpec& spec, Skeleton& s) {
  for (const JointSpec& j : spec.joints) {
    if (s.joint(j.name) >= 0)
      throw Error(j.where, "name '" + j.name + "' is another joint's; each needs its own");
    Joint joint;
    joint.name = j.name;
    joint.type = j.type;
    joint.parent = s.segment(j.parent);
    joint.child = s.segment(j.child);
    std::vector<std::string> names;
    for (const Segment& g : s.segments) names.push_back(g.name);
    for (const auto& [key, name] : {std::pair("parent", j.parent), std::pair("child", j.child)})
      if (s.segment(name) < 0)
        throw Error(j.where + "." + key, "joint '" + j.name + "': unknown segment '" + name +
                                             "'; the model has " + joined(names));
    if (joint.parent == joint.child)
      throw Error(j.where, "joint '" + j.name + "' joins segment '" + j.parent + "' to itself");
    if (!(j.axis.allFinite() && j.axis.norm() > kMinLength))
      throw Error(j.where + ".axis", "joint '" + j.name + "': axis must be a direction, not zero");
    joint.axis = j.axis.normalized();
    joint.range = j.range;
    joint.half_angle = j.half_angle;
    joint.planes = j.planes;
    joint.stiffness = j.stiffness;
    joint.damping = j.damping;
    s.joints.push_back(joint);
  }
}

/// Relaxation order: as the file has it, but neighbours in the list share no particle where that
/// can be had; independent sticks overlap in the processor, convergence is the same.
void orderSticks(Skeleton& s) {
  std::vector<Stick> left = s.sticks, ordered;
  std::vector<int> place;
  std::vector<int> index(left.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = static_cast<int>(i);
  const auto shares = [](const Stick& p, const Stick& q) {
    return p.a == q.a || p.a == q.b || p.b == q.a || p.b == q.b;
  };
  while (!left.empty()) {
    std::size_t pick = 0;
    for (std::size_t depth = 3; depth > 0; --depth) {  // free of the last 3, else 2, else 1
      const std::size_t from = ordered.size() > depth ? ordered.size() - depth : 0;
      const auto fits = [&](const Stick& k) {
        return std::none_of(ordered.begin() + from, ordered.end(),
                            [&](const Stick& o) { return shares(k, o); });
      };
      const auto it = std::find_if(left.begin(), left.end(), fits);
      if (it == left.end()) continue;
      pick = static_cast<std::size_t>(it - left.begin());
      break;
    }
    ordered.push_back(left[pick]);
    place.push_back(index[pick]);
    left.erase(left.begin() + pick);
    index.erase(index.begin() + pick);
  }
  s.sticks = std::move(ordered);
  s.stick_order = std::move(place);
}

/// A group with mass is rigid whether or not the file joins all its particles.
void completeGroups(const SkeletonSpec& spec, Skeleton& s) {
  std::set<std::pair<int, int>> seen;
  for (const Stick& k : s.sticks) seen.insert(std::minmax(k.a, k.b));
  for (std::size_t g = 0; g < spec.segments.size(); ++g) {
    if (!spec.segments[g].group || !(spec.segments[g].mass > 0)) continue;
    const std::vector<int>& p = s.segments[g].particles;
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t j = i + 1; j < p.size(); ++j)
        if (seen.insert(std::minmax(p[i], p[j])).second)
          s.hidden_sticks.push_back({p[i], p[j], (s.rest.col(p[i]) - s.rest.col(p[j])).norm()});
    if (s.hidden_sticks.size() > kMaxHidden)
      throw Error(spec.segments[g].where,
                  "the particles of rigid groups up to '" + spec.segments[g].name + "' make " +
                      std::to_string(s.hidden_sticks.size()) + " pairs; at most " +
                      std::to_string(kMaxHidden) + " are possible");
  }
}

/// A flat group's points cannot carry inertia across their plane: one more particle, off the plane
/// at the group's radius of gyration, does. It is nobody's by name and touches nothing.
void carryFlatInertia(const SkeletonSpec& spec, Skeleton& s) {
  for (std::size_t g = 0; g < spec.segments.size(); ++g) {
    const SegmentSpec& segment = spec.segments[g];
    const std::vector<int>& members = s.segments[g].particles;
    if (!segment.group || !(segment.mass > 0)) continue;
    Points x(3, members.size());
    for (std::size_t k = 0; k < members.size(); ++k) x.col(k) = s.rest.col(members[k]);
    const int rank = affineRank(x);
    if (rank == 3) continue;
    if (rank < 2)
      throw Error(segment.where, "the particles of group '" + segment.name +
                                     "' lie on a line; use a bone (from, to) instead");
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(x.colwise() - x.rowwise().mean(),
                                                Eigen::ComputeThinU);
    const Vec3 normal = svd.matrixU().col(2);
    const double J = 0.5 * segment.inertia.trace() - normal.dot(segment.inertia * normal);
    const double size = svd.singularValues()[0];
    const double off = std::max(std::sqrt(std::max(J, 0.0) / segment.mass), 0.1 * size);
    const int added = s.size();
    s.particles.push_back(segment.name + ".inertia");
    s.rest.conservativeResize(3, added + 1);
    s.rest.col(added) = x.rowwise().mean() + off * normal;
    s.radius.conservativeResize(added + 1);
    s.radius[added] = 0;
    for (const int i : members)
      s.hidden_sticks.push_back({i, added, (s.rest.col(i) - s.rest.col(added)).norm()});
    s.segments[g].carrier = added;
  }
}

/// Flat groups become exactly flat; sticks inside a group must agree with its shape.
void checkGroups(const SkeletonSpec& spec, Skeleton& s) {
  const Points before = s.rest;
  flattenGroups(s);
  const std::string moves = movesText(s, before, s.rest);
  if (!moves.empty())
    s.warnings.push_back(spec.where + ": a nearly flat rigid group was made flat; moved: " + moves);
  for (std::size_t i = 0; i < s.sticks.size(); ++i) {
    Stick& k = s.sticks[i];
    const double length = (s.rest.col(k.a) - s.rest.col(k.b)).norm();
    const bool given = spec.sticks[i].length.has_value();
    if (!given) {
      k.length = length;
      continue;
    }
    for (const RigidGroup& g : s.groups)
      if (std::count(g.particles.begin(), g.particles.end(), k.a) &&
          std::count(g.particles.begin(), g.particles.end(), k.b) &&
          std::abs(length - k.length) > 1e-6 * k.length)
        throw Error(spec.sticks[i].where,
                    "stick " + stickName(s, k.a, k.b) + " of length " + numberText(k.length) +
                        " is inside a rigid group whose particles are " + numberText(length) +
                        " m apart; leave its length out");
  }
}

/// A bone names two particles; what holds them at their distance is a stick or a rigid group.
void checkBones(const SkeletonSpec& spec, Skeleton& s) {
  for (std::size_t i = 0; i < s.segments.size(); ++i) {
    if (s.segments[i].group) continue;
    const int a = s.segments[i].particles[0], b = s.segments[i].particles[1];
    const bool joined = std::any_of(s.sticks.begin(), s.sticks.end(), [&](const Stick& k) {
      return std::minmax({k.a, k.b}) == std::minmax({a, b});
    });
    const bool grouped = std::any_of(s.groups.begin(), s.groups.end(), [&](const RigidGroup& g) {
      return std::count(g.particles.begin(), g.particles.end(), a) != 0 &&
             std::count(g.particles.begin(), g.particles.end(), b) != 0;
    });
    if (!joined && !grouped)
      s.warnings.push_back(spec.segments[i].where + ": no stick joins '" + s.particles[a] +
                           "' and '" + s.particles[b] +
                           "', so the bone has no fixed length; add [" + s.particles[a] + ", " +
                           s.particles[b] + "] to the sticks");
  }
}

}  // namespace

Skeleton buildSkeleton(const SkeletonSpec& spec) {
  Skeleton s;
  s.name = spec.name;
  addParticles(spec, s);
  s.named = s.size();
  addSticks(spec, s);
  fitRestPose(spec, s);
  addSegments(spec, s);
  addJoints(spec, s);
  completeGroups(spec, s);
  carryFlatInertia(spec, s);
  s.M = massMatrix(spec, s);
  s.groups = findRigidGroups(spec, s);
  checkGroups(spec, s);
  checkBones(spec, s);
  addLimits(spec, s);
  orderSticks(s);
  addContactRegions(s);
  s.lumped = s.M.isDiagonal(0.0);
  return s;
}

}  // namespace ragdoll
